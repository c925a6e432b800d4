//! Officers' azimuths.

use super::*;
use crate::spool::ReportState;

impl Rig {
    /// Saves an azimuth, or its withdrawal, as the page does.
    async fn observe(&self, number: u128, withdrawn: bool) {
        let sent = serde_json::from_value(json!({
            "time": "2026-11-21T06:50:00Z", "lat": 43.4, "lon": -3.1, "kind": "transit",
            "name": "Punta Galea", "true_bearing_deg": 131.0, "compass_bearing_deg": 130.0,
            "compass_heading_deg": 92.0, "observer": "LW", "withdrawn": withdrawn,
        }));
        let id = Uuid::from_u128(number);
        self.spool
            .save_azimuth(id, sent.unwrap(), time())
            .await
            .unwrap();
        self.sealed.notify_one();
    }

    /// Waits until no azimuth is waiting.
    async fn azimuths_settled(&self) {
        let settled = async {
            while self.spool.next_azimuth().await.unwrap().is_some() {
                tokio::task::yield_now().await;
            }
        };
        let patience = timeout(Duration::from_secs(20), settled);
        patience.await.expect("the azimuths are sent");
    }

    async fn azimuth_states(&self) -> Vec<ReportState> {
        let azimuths = self.spool.azimuths().await.unwrap();
        azimuths.iter().map(|azimuth| azimuth.state).collect()
    }
}

#[tokio::test]
async fn an_azimuth_is_sent_until_the_server_responds_and_so_is_its_withdrawal() {
    let lost = StatusCode::BAD_GATEWAY.into_response();
    let fake = Fake {
        azimuth_responses: VecDeque::from([lost]),
        ..Fake::default()
    };
    let rig = rig(0, fake).await;
    rig.observe(1, false).await;
    rig.azimuths_settled().await;
    rig.observe(1, true).await;
    rig.azimuths_settled().await;
    assert_eq!(rig.azimuth_states().await, [ReportState::Ashore]);
    let sent = &rig.fake.lock().unwrap().azimuths;
    let withdrawn: Vec<bool> = sent.iter().map(|(_, sent)| sent.withdrawn).collect();
    assert_eq!(withdrawn, [false, false, true]);
}

#[tokio::test]
async fn an_azimuth_that_is_refused_is_kept_with_the_reason() {
    let refused = problem(StatusCode::UNPROCESSABLE_ENTITY, "invalid");
    let fake = Fake {
        azimuth_responses: VecDeque::from([refused]),
        ..Fake::default()
    };
    let rig = rig(0, fake).await;
    rig.observe(1, false).await;
    rig.azimuths_settled().await;
    let azimuths = rig.spool.azimuths().await.unwrap();
    assert_eq!(azimuths[0].state, ReportState::Refused);
    assert_eq!(azimuths[0].problem.as_deref(), Some("422 invalid: why"));
}

#[tokio::test]
async fn a_server_that_knows_no_azimuths_gets_reports_and_batches_all_the_same() {
    let unknown = problem(StatusCode::NOT_FOUND, "not-found");
    let fake = Fake {
        azimuth_responses: VecDeque::from([unknown]),
        ..Fake::default()
    };
    let mut rig = rig(0, fake).await;
    rig.observe(1, false).await;
    seal(&rig.spool, 0).await;
    rig.sealed.notify_one();
    rig.all_sent().await;
    rig.report(1).await;
    let reported = async {
        while rig.spool.next_report().await.unwrap().is_some() {
            tokio::task::yield_now().await;
        }
    };
    timeout(Duration::from_secs(20), reported).await.unwrap();
    assert_eq!(rig.seqs(STREAM), [1]);
    assert_eq!(rig.azimuth_states().await, [ReportState::Waiting]);
}
