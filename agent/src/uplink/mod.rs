//! Uplink: sealed batches to the server, models and settings back, one after another, with retries
//! that never end.
//!
//! Invariants:
//!
//! - A batch counts as sent only when the server's response has been read and stored. Until then it
//!   is sent again, byte for byte.
//! - No failure loses data or stops the agent; each is shown on the page in words.
//! - Evidence of an alert goes before everything else, and ends a pause.
//! - Nothing is sent that the daily budget does not allow ([`budget`]). The expected cost of a request
//!   is charged, and the charge stored, before it is sent; afterwards what it cost at the socket.
//! - A report for the logbook goes before the other batches: it is short, and changes how they are
//!   interpreted. A refused report blocks nothing.
//! - A new model or new settings are stored first and then take effect at once.

mod backoff;
mod budget;
mod client;
mod meter;
mod reports;
mod request;
mod request_error;
mod response;
mod start;
mod status;
mod transport;

pub(crate) use client::ServerClient;
pub(crate) use request_error::RequestError;
pub(crate) use start::{UplinkHandle, prepare};
pub(crate) use status::{LinkState, LinkStatus, Publisher};
pub(crate) use transport::ensure_encrypted;

use backoff::Backoff;
use budget::{Budget, ClockReading, Connection, Priority};
use client::KnownVersions;
use reports::ReportPauses;
use request::BatchContext;

use crate::spool::{Identity, Spool};
use binnacle_compass::time::Timestamp;
use rand::rngs::StdRng;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Notify, watch};
use tokio::time::{Instant, timeout};
use tokio_util::sync::CancellationToken;

/// Interval at which a pause or idleness checks whether the agent was enrolled anew.
const ENROLMENT_POLL_INTERVAL: Duration = Duration::from_secs(5);
/// Interval at which a refused batch is sent again: the server may have another version by then.
const RETRY_PARKED_INTERVAL: Duration = Duration::from_hours(24);

/// State of the uplink.
#[derive(Debug)]
pub(crate) struct Uplink {
    pub(crate) spool: Spool,
    pub(crate) client: ServerClient,
    pub(crate) backoff: Backoff,
    /// Interval of polls when nothing was sent.
    pub(crate) poll: Duration,
    pub(crate) budget: Budget,
    pub(crate) ship_time: watch::Receiver<Option<Timestamp>>,
    pub(crate) publisher: Publisher,
    /// Set if the connection stays open after an exchange.
    pub(crate) keeps_connection: bool,
    /// Set once something was sent since the last exchange ended.
    pub(crate) exchange_open: bool,
    /// Token of the current model and settings.
    pub(crate) token: Option<String>,
    /// Last token that the server did not know.
    pub(crate) refused_token: Option<String>,
    /// Pauses for a server that does not know all reports.
    pub(crate) report_pauses: ReportPauses,
    /// Notified when a batch has been sealed or a report was written.
    pub(crate) sealed: Arc<Notify>,
    /// Notified when evidence of an alert has been sealed.
    pub(crate) urgent: Arc<Notify>,
    pub(crate) rng: StdRng,
}

/// Next step of the uplink.
enum NextStep {
    /// Continue at once.
    Continue,
    /// Wait for a sealed batch, at most for this duration.
    Idle(Duration),
    /// Wait for this duration, whatever is sealed.
    Pause(Duration),
}

impl Uplink {
    /// Runs until `shutdown`.
    pub(crate) async fn run(mut self, shutdown: CancellationToken) {
        if let Err(error) = self.spool.unpark().await {
            tracing::error!(%error, "the parked batches cannot be queued again");
        }
        let mut retry_parked_at = Instant::now() + RETRY_PARKED_INTERVAL;
        if let Err(error) = self.spool.save_account(&self.budget.account()).await {
            tracing::error!(%error, "the budget cannot be stored");
        }
        let mut last_response = None;
        loop {
            if retry_parked_at <= Instant::now() {
                retry_parked_at = Instant::now() + RETRY_PARKED_INTERVAL;
                if let Err(error) = self.spool.unpark_first().await {
                    tracing::error!(%error, "the parked batches cannot be queued again");
                }
            }
            let work = self.step(&mut last_response);
            let Some(next) = shutdown.run_until_cancelled(work).await else {
                return;
            };
            let wait = self.wait(next);
            if shutdown.run_until_cancelled(wait).await.is_none() {
                return;
            }
        }
    }

    /// Sends at most one request; `last_response` is the time of the server's last response.
    async fn step(&mut self, last_response: &mut Option<Instant>) -> NextStep {
        match self.try_step(last_response).await {
            Ok(next) => next,
            Err(error) => {
                tracing::error!(%error, "the spool cannot be used");
                NextStep::Pause(self.backoff.next(&mut self.rng))
            }
        }
    }

    async fn try_step(&mut self, last_response: &mut Option<Instant>) -> sqlx::Result<NextStep> {
        let Some(identity) = self.spool.identity().await? else {
            self.publisher.link.send_replace(LinkStatus::default());
            return Ok(NextStep::Idle(ENROLMENT_POLL_INTERVAL));
        };
        if self.token.as_ref() != Some(&identity.token) {
            self.load_enrolment(&identity).await?;
            *last_response = None;
        }
        if last_response.is_none() {
            self.publish_connecting();
        }
        let batch = self.spool.next_batch().await?;
        let has_evidence = batch.as_ref().is_some_and(|batch| batch.urgent);
        if !has_evidence && let Some(report) = self.next_report().await? {
            return self.send_report(&identity, &report).await;
        }
        let known = KnownVersions {
            model: self.publisher.model.borrow().as_ref().map(|model| model.id),
            settings: self.publisher.settings.borrow().version,
        };
        let (priority, bytes) = match &batch {
            Some(batch) if batch.urgent => (Priority::Alert, batch.bytes.len()),
            Some(batch) if batch.samples > 0 => (Priority::Samples, batch.bytes.len()),
            Some(batch) => (Priority::Other, batch.bytes.len()),
            None => (Priority::Other, 0),
        };
        if batch.is_none() {
            let idle = last_response.map(|at| at.elapsed());
            if let Some(left) = idle.and_then(|idle| self.poll.checked_sub(idle)) {
                self.end_exchange();
                return Ok(NextStep::Idle(left));
            }
        }
        if let Some(wait) = self.delay_for(priority, bytes) {
            return Ok(NextStep::Idle(wait));
        }
        if let Some(batch) = &batch
            && !self.spool.mark_tried(batch).await?
        {
            return Ok(NextStep::Continue);
        }
        let cost = self.charge(bytes).await?;
        let result = match &batch {
            Some(batch) => {
                let context = BatchContext {
                    waiting_batches: self.spool.count_other_waiting(batch.seq).await?,
                    budget_percent: self.budget.remaining_percent(),
                };
                let sent = self.client.put_batch(&identity, batch, known, context);
                sent.await
            }
            None => self.client.downlink(&identity, known).await,
        };
        self.settle(cost).await?;
        match result {
            Ok(downlink) => {
                *last_response = Some(Instant::now());
                self.handle_success(&identity, batch.as_ref(), downlink)
                    .await
            }
            Err(error) => self.handle_failure(&identity, batch.as_ref(), error).await,
        }
    }

    /// Returns whether the agent has changed to another stream meanwhile, so that a response for
    /// this one is void. Another token does not matter.
    async fn has_changed_stream(&self, identity: &Identity) -> sqlx::Result<bool> {
        let now = self.spool.identity().await?;
        Ok(now.is_none_or(|now| now.stream != identity.stream))
    }

    /// Ends an exchange: nothing is left to send for now.
    fn end_exchange(&mut self) {
        if self.exchange_open && !self.keeps_connection {
            self.client.close_connection();
        }
        self.exchange_open = false;
    }

    fn now(&self) -> ClockReading {
        ClockReading {
            monotonic: Instant::now(),
            ship: *self.ship_time.borrow(),
        }
    }

    /// Returns the delay before a body may be sent; `None` for none.
    fn delay_for(&mut self, priority: Priority, bytes: usize) -> Option<Duration> {
        let (connection, now) = (self.connection(), self.now());
        self.budget.delay_for(priority, bytes, connection, now)
    }

    fn connection(&self) -> Connection {
        if self.client.is_connected() {
            Connection::Open
        } else {
            Connection::New
        }
    }

    /// Charges the expected cost of a request and stores the balance: an agent that dies of it again
    /// and again spends no more.
    async fn charge(&mut self, bytes: usize) -> sqlx::Result<f64> {
        self.exchange_open = true;
        let cost = self.budget.charge(bytes, self.connection(), self.now());
        self.spool.save_account(&self.budget.account()).await?;
        Ok(cost)
    }

    /// Charges what was counted at the socket in place of the expected cost.
    async fn settle(&mut self, expected: f64) -> sqlx::Result<()> {
        self.budget.settle(expected, self.client.take_traffic());
        self.spool.save_account(&self.budget.account()).await
    }

    /// Publishes model and settings of the spool: none of another compass.
    async fn load_enrolment(&mut self, identity: &Identity) -> sqlx::Result<()> {
        self.publisher.model.send_replace(self.spool.model().await?);
        self.publisher
            .withdrawn
            .send_replace(self.spool.card_withdrawn().await?);
        self.publisher
            .settings
            .send_replace(self.spool.settings().await?);
        self.token = Some(identity.token.clone());
        self.report_pauses = ReportPauses::default();
        Ok(())
    }

    fn publish_connecting(&self) {
        self.publisher.link.send_if_modified(|link| {
            let first = link.state == LinkState::NotEnrolled;
            if first {
                link.state = LinkState::Connecting;
            }
            first
        });
    }

    async fn wait(&mut self, next: NextStep) {
        match next {
            NextStep::Continue => {}
            NextStep::Idle(longest) => {
                // A batch sealed meanwhile has left its notification.
                let longest = longest.min(ENROLMENT_POLL_INTERVAL);
                timeout(longest, self.sealed.notified()).await.ok();
            }
            NextStep::Pause(pause) => {
                let urgent = self.urgent.clone();
                tokio::select! {
                    () = self.pause(pause) => return,
                    () = urgent.notified() => {}
                }
                self.backoff.reset();
            }
        }
    }

    /// Waits for the pause, or until the agent is enrolled anew.
    async fn pause(&self, pause: Duration) {
        let until = Instant::now() + pause;
        let before = self.spool.identity().await.ok().flatten();
        while Instant::now() < until {
            tokio::time::sleep_until(until.min(Instant::now() + ENROLMENT_POLL_INTERVAL)).await;
            let Ok(identity) = self.spool.identity().await else {
                continue;
            };
            if identity != before {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
