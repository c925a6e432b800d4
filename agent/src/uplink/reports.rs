//! Delivery of reports for the logbook: each by itself, before the batches.

use super::budget::Priority;
use super::request_error::RequestError;
use super::{LinkState, NextStep, Uplink};
use crate::spool::{Identity, StoredReport};
use tokio::time::Instant;

impl Uplink {
    pub(super) async fn next_report(&self) -> sqlx::Result<Option<StoredReport>> {
        if self
            .reports_paused_until
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
    ) -> sqlx::Result<NextStep> {
        let bytes = serde_json::to_vec(&report.sent).map_or(0, |text| text.len());
        if let Some(wait) = self.budget.delay_for(Priority::Report, bytes, self.now()) {
            return Ok(NextStep::Idle(wait));
        }
        let cost = self.charge(bytes).await?;
        let result = self.client.put_report(identity, report).await;
        self.settle_cost(cost, result.as_ref().err()).await?;
        match result {
            Ok(response) => {
                if !self.has_changed_stream(identity).await? {
                    self.spool.mark_report_delivered(report, &response).await?;
                    tracing::info!(id = %report.id, "a report was delivered");
                }
                self.backoff.reset();
                self.publisher.link.send_modify(|link| {
                    link.state = LinkState::Up;
                    link.problem = None;
                });
                Ok(NextStep::Continue)
            }
            Err(RequestError::Refused(problem)) => {
                tracing::error!(id = %report.id, problem, "the server refused a report");
                self.spool.mark_report_refused(report, &problem).await?;
                Ok(NextStep::Continue)
            }
            // An unknown token will also fail the next request.
            Err(RequestError::Unauthorized(problem) | RequestError::NotFound(problem)) => {
                tracing::warn!(problem, "the server does not accept reports for now");
                self.reports_paused_until = Some(Instant::now() + self.poll);
                Ok(NextStep::Continue)
            }
            Err(error) => self.handle_failure(identity, None, error).await,
        }
    }
}
