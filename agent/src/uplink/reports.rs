//! Delivery of officers' reports and azimuths: each by itself, before the batches.

use super::budget::Priority;
use super::request_error::RequestError;
use super::{LinkState, NextStep, Uplink};
use crate::spool::{Identity, SpooledAzimuth, StoredReport};
use std::fmt;
use tokio::time::Instant;

/// Report that waits to be sent.
pub(super) enum Report {
    /// For the logbook.
    Logbook(StoredReport),
    /// Azimuth.
    Azimuth(SpooledAzimuth),
}

/// Ends of the pauses for a server that does not know reports of a kind.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ReportPauses {
    logbook: Option<Instant>,
    azimuths: Option<Instant>,
}

impl Report {
    fn bytes(&self) -> usize {
        let text = match self {
            Report::Logbook(report) => serde_json::to_vec(&report.sent),
            Report::Azimuth(azimuth) => serde_json::to_vec(&azimuth.sent),
        };
        text.map_or(0, |text| text.len())
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Report::Logbook(report) => write!(f, "report {}", report.id),
            Report::Azimuth(azimuth) => write!(f, "azimuth {}", azimuth.id),
        }
    }
}

impl Uplink {
    pub(super) async fn next_report(&self) -> sqlx::Result<Option<Report>> {
        let is_paused = |until: Option<Instant>| until.is_some_and(|time| Instant::now() < time);
        if !is_paused(self.report_pauses.logbook)
            && let Some(report) = self.spool.next_report().await?
        {
            return Ok(Some(Report::Logbook(report)));
        }
        if is_paused(self.report_pauses.azimuths) {
            return Ok(None);
        }
        Ok(self.spool.next_azimuth().await?.map(Report::Azimuth))
    }

    pub(super) async fn send_report(
        &mut self,
        identity: &Identity,
        report: &Report,
    ) -> sqlx::Result<NextStep> {
        let bytes = report.bytes();
        if let Some(wait) = self.delay_for(Priority::Report, bytes) {
            return Ok(NextStep::Idle(wait));
        }
        let cost = self.charge(bytes).await?;
        let result = self.put_report(identity, report).await?;
        self.settle(cost).await?;
        match result {
            Ok(()) => {
                self.backoff.reset();
                self.publisher.link.send_modify(|link| {
                    link.state = LinkState::Up;
                    link.problem = None;
                });
                Ok(NextStep::Continue)
            }
            Err(RequestError::Refused(problem)) => {
                tracing::error!(%report, problem, "the server refused a report");
                self.mark_refused(report, &problem).await?;
                Ok(NextStep::Continue)
            }
            // An unknown token will also fail the next request.
            Err(RequestError::Unauthorized(problem) | RequestError::NotFound(problem)) => {
                tracing::warn!(%report, problem, "the server does not accept it for now");
                let until = Some(Instant::now() + self.poll);
                match report {
                    Report::Logbook(_) => self.report_pauses.logbook = until,
                    Report::Azimuth(_) => self.report_pauses.azimuths = until,
                }
                Ok(NextStep::Continue)
            }
            Err(error) => self.handle_failure(identity, None, error).await,
        }
    }

    /// Sends a report and, if it was accepted, marks it as delivered.
    async fn put_report(
        &self,
        identity: &Identity,
        report: &Report,
    ) -> sqlx::Result<Result<(), RequestError>> {
        match report {
            Report::Logbook(report) => match self.client.put_report(identity, report).await {
                Ok(response) if !self.has_changed_stream(identity).await? => {
                    self.spool.mark_report_delivered(report, &response).await?;
                    tracing::info!(id = %report.id, "a report was delivered");
                }
                Ok(_) => {}
                Err(error) => return Ok(Err(error)),
            },
            Report::Azimuth(azimuth) => match self.client.put_azimuth(identity, azimuth).await {
                Ok(response) if !self.has_changed_stream(identity).await? => {
                    self.spool
                        .mark_azimuth_delivered(azimuth, &response)
                        .await?;
                    tracing::info!(id = %azimuth.id, "an azimuth was delivered");
                }
                Ok(_) => {}
                Err(error) => return Ok(Err(error)),
            },
        }
        Ok(Ok(()))
    }

    async fn mark_refused(&self, report: &Report, problem: &str) -> sqlx::Result<()> {
        match report {
            Report::Logbook(report) => self.spool.mark_report_refused(report, problem).await,
            Report::Azimuth(azimuth) => self.spool.mark_azimuth_refused(azimuth, problem).await,
        }
    }
}
