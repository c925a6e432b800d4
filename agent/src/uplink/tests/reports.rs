//! Officers' reports.

use super::*;
use crate::spool::ReportState;

impl Rig {
    /// Writes a report as the page does.
    pub(super) async fn report(&self, number: u128) {
        let report = serde_json::from_value(json!({
            "kind": "lightning", "from": "2026-11-21T06:00:00Z",
        }));
        let (id, reporter) = (Uuid::from_u128(number), "Li".to_owned());
        self.spool
            .save_report(id, report.unwrap(), reporter, false, time())
            .await
            .unwrap();
        self.sealed.notify_one();
    }

    /// Waits until no report is waiting.
    async fn reports_settled(&self) {
        let settled = async {
            while self.spool.next_report().await.unwrap().is_some() {
                tokio::task::yield_now().await;
            }
        };
        let patience = timeout(Duration::from_secs(20), settled);
        patience.await.expect("the reports are sent");
    }

    async fn states(&self) -> Vec<ReportState> {
        let reports = self.spool.reports().await.unwrap();
        reports.iter().map(|report| report.state).collect()
    }
}

#[tokio::test]
async fn a_report_is_sent_until_the_server_responds() {
    let lost = || StatusCode::BAD_GATEWAY.into_response();
    let busy = problem(StatusCode::SERVICE_UNAVAILABLE, "busy");
    let fake = Fake {
        report_responses: VecDeque::from([lost(), busy]),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    rig.report(1).await;
    rig.reports_settled().await;
    rig.all_sent().await;
    assert_eq!(rig.states().await, [ReportState::Ashore]);
    let sent = &rig.fake.lock().unwrap().reports;
    assert_eq!(sent.len(), 3);
    assert!(sent.iter().all(|report| *report == sent[0]), "{sent:?}");
}

#[tokio::test]
async fn a_report_that_is_refused_is_kept_with_the_reason_and_the_next_one_goes() {
    let refused = problem(StatusCode::UNPROCESSABLE_ENTITY, "invalid");
    let fake = Fake {
        report_responses: VecDeque::from([refused]),
        ..Fake::default()
    };
    let rig = rig(0, fake).await;
    rig.report(1).await;
    rig.reports_settled().await;
    rig.report(2).await;
    rig.reports_settled().await;
    let (ashore, refused) = (ReportState::Ashore, ReportState::Refused);
    assert_eq!(rig.states().await, [ashore, refused]);
    let reports = rig.spool.reports().await.unwrap();
    assert_eq!(reports[1].problem.as_deref(), Some("422 invalid: why"));
}

#[tokio::test]
async fn a_server_that_knows_no_reports_gets_its_batches_all_the_same() {
    let unknown = problem(StatusCode::NOT_FOUND, "not-found");
    let fake = Fake {
        report_responses: VecDeque::from([unknown]),
        ..Fake::default()
    };
    let mut rig = rig(0, fake).await;
    rig.report(1).await;
    seal(&rig.spool, 0).await;
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
    assert_eq!(rig.states().await, [ReportState::Waiting]);
}
