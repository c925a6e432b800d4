//! Evidence of alerts.

use super::*;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};

/// Seals a sample with an alert that compass and gyro disagree.
pub(super) async fn seal_evidence(spool: &Spool, number: i64) {
    let at = time().plus_seconds(number as f64 * 600.0);
    let alert = ShipAlert {
        id: Uuid::from_u128(0xa1),
        revision: u32::try_from(number).unwrap() + 1,
        state: ShipAlertState::Open,
        since: time(),
        at,
        gyro_departure_deg: Some(28.4),
        satellite_departure_deg: None,
        limit_deg: 3.9,
        model_version: 1,
    };
    let sealed = spool
        .store_evidence(&[], &BTreeMap::new(), &[alert], None)
        .await;
    assert_eq!(sealed.unwrap().1, 1);
}

/// A server that asks for a pause of an hour, and an agent that obeys.
async fn waiting_rig(batches: i64) -> Rig {
    let busy = (
        StatusCode::TOO_MANY_REQUESTS,
        [("retry-after", "3600")],
        "slow down",
    );
    let fake = Fake {
        responses: [busy.into_response()].into(),
        ..Fake::default()
    };
    let mut rig = rig(batches, fake).await;
    let down = rig.link.wait_for(|link| link.state == LinkState::Down);
    down.await.unwrap();
    rig
}

#[tokio::test]
async fn evidence_goes_before_the_backlog_and_the_reports_and_once() {
    let mut rig = waiting_rig(3).await;
    rig.report(1).await;
    seal_evidence(&rig.spool, 1).await;
    seal(&rig.spool, 7).await;
    seal_evidence(&rig.spool, 2).await;
    rig.urgent.notify_one();
    rig.all_sent().await;
    let order = rig.fake.lock().unwrap().order.clone();
    assert_eq!(order[..2], [6, 4], "the newest alert first");
    assert_eq!(
        order[2..],
        [0, 1, 2, 3, 5],
        "a report, then the oldest first"
    );
    let status = rig.spool.status().await.unwrap();
    assert_eq!((status.acknowledged_batches, status.contiguous_seq), (6, 6));
}

#[tokio::test]
async fn an_alert_cuts_a_long_pause_short() {
    let mut rig = waiting_rig(1).await;
    seal_evidence(&rig.spool, 1).await;
    rig.urgent.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2]);
}
