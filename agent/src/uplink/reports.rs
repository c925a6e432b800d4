//! Reports for the logbook on their way: each by itself, before the batches.

use super::budget::Class;
use super::client::Trouble;
use super::{LinkState, Next, Uplink};
use crate::spool::{Identity, StoredReport};
use tokio::time::Instant;

impl Uplink {
    pub(super) async fn next_report(&self) -> sqlx::Result<Option<StoredReport>> {
        if self
            .no_reports_before
            .is_some_and(|time| Instant::now() < time)
        {
            return Ok(None);
        }
        self.spool.next_report().await
    }

    pub(super) async fn send_report(
        &mut self,
        identity: &Identity,
        report: &StoredReport,
    ) -> sqlx::Result<Next> {
        let octets = serde_json::to_vec(&report.sent).map_or(0, |text| text.len());
        if let Some(wait) = self.budget.wait(Class::Report, octets, self.now()) {
            return Ok(Next::Idle(wait));
        }
        let cost = self.spend(octets).await?;
        let result = self.shore.put_report(identity, report).await;
        self.settle(cost, result.as_ref().err()).await?;
        match result {
            Ok(answer) => {
                if !self.has_left(identity).await? {
                    self.spool.mark_report_delivered(report, &answer).await?;
                    tracing::info!(id = %report.id, "a report is ashore");
                }
                self.backoff.reset();
                self.tell.link.send_modify(|link| {
                    link.state = LinkState::Up;
                    link.problem = None;
                });
                Ok(Next::GoOn)
            }
            Err(Trouble::Refused(problem)) => {
                tracing::error!(id = %report.id, problem, "the shore refuses a report");
                self.spool.mark_report_refused(report, &problem).await?;
                Ok(Next::GoOn)
            }
            // A token that is not known any more shows itself in what is sent next.
            Err(Trouble::Unknown(problem) | Trouble::NotFound(problem)) => {
                tracing::warn!(problem, "the shore does not take reports for now");
                self.no_reports_before = Some(Instant::now() + self.poll);
                Ok(Next::GoOn)
            }
            Err(trouble) => self.fail(identity, None, trouble).await,
        }
    }
}
