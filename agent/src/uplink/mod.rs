//! Sealed batches to the shore, models and settings back: one after another,
//! again and again, never giving up.
//!
//! What always holds:
//!
//! - A batch counts as sent when the shore's answer has been read and kept, not
//!   before. Until then it is sent again, byte for byte.
//! - No failure loses data or stops the agent; each is on the page in words.
//! - Evidence of an alert goes before everything else, and cuts a pause short.
//! - Nothing is sent that the day's budget does not allow ([`budget`]); it is paid for,
//!   and that is kept, before it is sent.
//! - A report for the logbook goes before the other batches: it is short, and changes
//!   how they are read. One that the shore does not take keeps nothing else back.
//! - A model or settings that arrive are kept first and then in effect at once.

mod backoff;
mod budget;
mod client;
mod reports;
mod request;
mod request_error;
mod response;
mod start;
mod status;

pub(crate) use client::ServerClient;
pub(crate) use request_error::RequestError;
pub(crate) use start::{UplinkHandle, prepare};
pub(crate) use status::{LinkState, LinkStatus, Publisher};

use backoff::Backoff;
use budget::{Budget, ClockReading, Priority};
use client::KnownVersions;
use request::BatchContext;

use crate::spool::{Identity, Spool};
use binnacle_magnetics::time::Timestamp;
use rand::rngs::StdRng;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Notify, watch};
use tokio::time::{Instant, timeout};
use tokio_util::sync::CancellationToken;

/// How often a pause or idleness is interrupted to see whether the agent was enrolled anew.
const ENROLMENT_POLL_INTERVAL: Duration = Duration::from_secs(5);
/// What the shore refused is offered again so often: it may be another version by then.
const RETRY_PARKED_INTERVAL: Duration = Duration::from_hours(24);

/// Everything the uplink works with.
#[derive(Debug)]
pub(crate) struct Uplink {
    pub(crate) spool: Spool,
    pub(crate) client: ServerClient,
    pub(crate) backoff: Backoff,
    /// Asks for news when nothing was sent for so long.
    pub(crate) poll: Duration,
    pub(crate) budget: Budget,
    pub(crate) ship_time: watch::Receiver<Option<Timestamp>>,
    pub(crate) publisher: Publisher,
    /// Whether the connection stays open when all is said.
    pub(crate) keeps_connection: bool,
    /// Whether something was sent since all was said.
    pub(crate) exchange_open: bool,
    /// The token that the model and settings in effect came with.
    pub(crate) token: Option<String>,
    /// The token that the shore did not know when it last answered.
    pub(crate) refused_token: Option<String>,
    /// A shore that knows no reports is not asked again before this.
    pub(crate) reports_paused_until: Option<Instant>,
    /// Rings when a batch has been sealed or a report was written.
    pub(crate) sealed: Arc<Notify>,
    /// Rings when evidence of an alert has been sealed.
    pub(crate) urgent: Arc<Notify>,
    pub(crate) rng: StdRng,
}

/// What to do next.
enum NextStep {
    /// Look for work at once.
    Continue,
    /// Wait for a sealed batch, or for so long.
    Idle(Duration),
    /// Wait for so long, work or no work.
    Pause(Duration),
}

impl Uplink {
    /// Runs until `shutdown`.
    pub(crate) async fn run(mut self, shutdown: CancellationToken) {
        if let Err(error) = self.spool.unpark().await {
            tracing::error!(%error, "cannot look at the parked batches");
        }
        let mut retry_parked_at = Instant::now() + RETRY_PARKED_INTERVAL;
        if let Err(error) = self.spool.save_account(&self.budget.account()).await {
            tracing::error!(%error, "the budget cannot be kept");
        }
        let mut last_response = None;
        loop {
            if retry_parked_at <= Instant::now() {
                retry_parked_at = Instant::now() + RETRY_PARKED_INTERVAL;
                if let Err(error) = self.spool.unpark_first().await {
                    tracing::error!(%error, "cannot look at the parked batches");
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

    /// One request at most; `last_response` is when the shore last answered.
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
        if let Some(wait) = self.budget.delay_for(priority, bytes, self.now()) {
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
        self.settle_cost(cost, result.as_ref().err()).await?;
        match result {
            Ok(downlink) => {
                *last_response = Some(Instant::now());
                self.handle_success(&identity, batch.as_ref(), downlink)
                    .await
            }
            Err(error) => self.handle_failure(&identity, batch.as_ref(), error).await,
        }
    }

    /// Whether another stream has taken the place of this one meanwhile: an answer for
    /// it changes nothing any more. Another token changes nothing about what was said.
    async fn has_changed_stream(&self, identity: &Identity) -> sqlx::Result<bool> {
        let now = self.spool.identity().await?;
        Ok(now.is_none_or(|now| now.stream != identity.stream))
    }

    /// All is said for now.
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

    /// Pays for a request, and keeps that: an agent that dies of it again and again
    /// does not spend more.
    async fn charge(&mut self, bytes: usize) -> sqlx::Result<f64> {
        self.exchange_open = true;
        let cost = self.budget.charge(bytes, self.now());
        self.spool.save_account(&self.budget.account()).await?;
        Ok(cost)
    }

    /// Pays for the answer, or takes back what no connection cost.
    async fn settle_cost(&mut self, cost: f64, error: Option<&RequestError>) -> sqlx::Result<()> {
        if let Some(RequestError::NoConnection(_)) = error {
            self.budget.refund(cost);
        }
        self.budget
            .charge_response(self.client.take_received_bytes());
        self.spool.save_account(&self.budget.account()).await
    }

    /// What the spool has is in effect: nothing of another compass, if it is one.
    async fn load_enrolment(&mut self, identity: &Identity) -> sqlx::Result<()> {
        self.publisher.model.send_replace(self.spool.model().await?);
        self.publisher
            .withdrawn
            .send_replace(self.spool.card_withdrawn().await?);
        self.publisher
            .settings
            .send_replace(self.spool.settings().await?);
        self.token = Some(identity.token.clone());
        self.reports_paused_until = None;
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
                // A batch that was sealed meanwhile has left its ring behind.
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

    /// Waits, but not longer than until the agent is enrolled anew.
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
