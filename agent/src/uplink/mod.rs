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
mod response;
mod start;
mod status;

pub(crate) use budget::{Account, EXCHANGE, Plan, Profile, REQUEST_OCTETS};
pub(crate) use client::{Line, Shore, Trouble};
pub(crate) use start::{Told, prepare};
pub(crate) use status::{LinkState, LinkStatus, Tell};

use backoff::Backoff;
use budget::{Budget, Class, Now};
use client::Have;
use request::Aboard;

use crate::spool::{Identity, Spool};
use binnacle_magnetics::time::Timestamp;
use rand::rngs::StdRng;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Notify, watch};
use tokio::time::{Instant, timeout};
use tokio_util::sync::CancellationToken;

/// How often a pause or idleness is interrupted to see whether the agent was enrolled anew.
const LOOK_FOR_ENROLMENT: Duration = Duration::from_secs(5);
/// What the shore refused is offered again so often: it may be another version by then.
const OFFER_AGAIN: Duration = Duration::from_hours(24);

/// Everything the uplink works with.
#[derive(Debug)]
pub(crate) struct Uplink {
    pub(crate) spool: Spool,
    pub(crate) shore: Shore,
    pub(crate) backoff: Backoff,
    /// Asks for news when nothing was sent for so long.
    pub(crate) poll: Duration,
    pub(crate) budget: Budget,
    pub(crate) ship_time: watch::Receiver<Option<Timestamp>>,
    pub(crate) tell: Tell,
    /// Whether the connection stays open when all is said.
    pub(crate) keeps_line: bool,
    /// Whether something was sent since all was said.
    pub(crate) in_touch: bool,
    /// The token that the model and settings in effect came with.
    pub(crate) token: Option<String>,
    /// The token that the shore did not know when it last answered.
    pub(crate) refused: Option<String>,
    /// A shore that knows no reports is not asked again before this.
    pub(crate) no_reports_before: Option<Instant>,
    /// Rings when a batch has been sealed or a report was written.
    pub(crate) sealed: Arc<Notify>,
    /// Rings when evidence of an alert has been sealed.
    pub(crate) urgent: Arc<Notify>,
    pub(crate) rng: StdRng,
}

/// What to do next.
enum Next {
    /// Look for work at once.
    GoOn,
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
        let mut offer_again = Instant::now() + OFFER_AGAIN;
        if let Err(error) = self.spool.save_account(&self.budget.account()).await {
            tracing::error!(%error, "the budget cannot be kept");
        }
        let mut answered = None;
        loop {
            if offer_again <= Instant::now() {
                offer_again = Instant::now() + OFFER_AGAIN;
                if let Err(error) = self.spool.unpark_first().await {
                    tracing::error!(%error, "cannot look at the parked batches");
                }
            }
            let work = self.step(&mut answered);
            let Some(next) = shutdown.run_until_cancelled(work).await else {
                return;
            };
            let wait = self.wait(next);
            if shutdown.run_until_cancelled(wait).await.is_none() {
                return;
            }
        }
    }

    /// One request at most; `answered` is when the shore last answered.
    async fn step(&mut self, answered: &mut Option<Instant>) -> Next {
        match self.try_step(answered).await {
            Ok(next) => next,
            Err(error) => {
                tracing::error!(%error, "the spool cannot be used");
                Next::Pause(self.backoff.next(&mut self.rng))
            }
        }
    }

    async fn try_step(&mut self, answered: &mut Option<Instant>) -> sqlx::Result<Next> {
        let Some(identity) = self.spool.identity().await? else {
            self.tell.link.send_replace(LinkStatus::default());
            return Ok(Next::Idle(LOOK_FOR_ENROLMENT));
        };
        if self.token.as_ref() != Some(&identity.token) {
            self.enrolled_anew(&identity).await?;
            *answered = None;
        }
        if answered.is_none() {
            self.connecting();
        }
        let batch = self.spool.next_batch().await?;
        let has_evidence = batch.as_ref().is_some_and(|batch| batch.urgent);
        if !has_evidence && let Some(report) = self.next_report().await? {
            return self.send_report(&identity, &report).await;
        }
        let have = Have {
            model: self.tell.model.borrow().as_ref().map(|model| model.id),
            settings: self.tell.settings.borrow().version,
        };
        let (class, octets) = match &batch {
            Some(batch) if batch.urgent => (Class::Alert, batch.bytes.len()),
            Some(batch) if batch.samples > 0 => (Class::Samples, batch.bytes.len()),
            Some(batch) => (Class::Rest, batch.bytes.len()),
            None => (Class::Rest, 0),
        };
        if batch.is_none() {
            let idle = answered.map(|at| at.elapsed());
            if let Some(left) = idle.and_then(|idle| self.poll.checked_sub(idle)) {
                self.end_exchange();
                return Ok(Next::Idle(left));
            }
        }
        if let Some(wait) = self.budget.wait(class, octets, self.now()) {
            return Ok(Next::Idle(wait));
        }
        if let Some(batch) = &batch
            && !self.spool.mark_tried(batch).await?
        {
            return Ok(Next::GoOn);
        }
        let cost = self.spend(octets).await?;
        let result = match &batch {
            Some(batch) => {
                let aboard = Aboard {
                    waits: self.spool.count_other_waiting(batch.seq).await?,
                    budget: self.budget.short_percent(),
                };
                let sent = self.shore.put_batch(&identity, batch, have, aboard);
                sent.await
            }
            None => self.shore.downlink(&identity, have).await,
        };
        self.settle(cost, result.as_ref().err()).await?;
        match result {
            Ok(downlink) => {
                *answered = Some(Instant::now());
                self.succeed(&identity, batch.as_ref(), downlink).await
            }
            Err(trouble) => self.fail(&identity, batch.as_ref(), trouble).await,
        }
    }

    /// Whether another stream has taken the place of this one meanwhile: an answer for
    /// it changes nothing any more. Another token changes nothing about what was said.
    async fn has_left(&self, identity: &Identity) -> sqlx::Result<bool> {
        let now = self.spool.identity().await?;
        Ok(now.is_none_or(|now| now.stream != identity.stream))
    }

    /// All is said for now.
    fn end_exchange(&mut self) {
        if self.in_touch && !self.keeps_line {
            self.shore.hang_up();
        }
        self.in_touch = false;
    }

    fn now(&self) -> Now {
        Now {
            monotonic: Instant::now(),
            ship: *self.ship_time.borrow(),
        }
    }

    /// Pays for a request, and keeps that: an agent that dies of it again and again
    /// does not spend more.
    async fn spend(&mut self, octets: usize) -> sqlx::Result<f64> {
        self.in_touch = true;
        let cost = self.budget.spend(octets, self.now());
        self.spool.save_account(&self.budget.account()).await?;
        Ok(cost)
    }

    /// Pays for the answer, or takes back what no connection cost.
    async fn settle(&mut self, cost: f64, trouble: Option<&Trouble>) -> sqlx::Result<()> {
        if let Some(Trouble::NoConnection(_)) = trouble {
            self.budget.take_back(cost);
        }
        self.budget.answered(self.shore.take_octets());
        self.spool.save_account(&self.budget.account()).await
    }

    /// What the spool has is in effect: nothing of another compass, if it is one.
    async fn enrolled_anew(&mut self, identity: &Identity) -> sqlx::Result<()> {
        self.tell.model.send_replace(self.spool.model().await?);
        self.tell
            .withdrawn
            .send_replace(self.spool.card_withdrawn().await?);
        self.tell
            .settings
            .send_replace(self.spool.settings().await?);
        self.token = Some(identity.token.clone());
        self.no_reports_before = None;
        Ok(())
    }

    fn connecting(&self) {
        self.tell.link.send_if_modified(|link| {
            let first = link.state == LinkState::NotEnrolled;
            if first {
                link.state = LinkState::Connecting;
            }
            first
        });
    }

    async fn wait(&mut self, next: Next) {
        match next {
            Next::GoOn => {}
            Next::Idle(longest) => {
                // A batch that was sealed meanwhile has left its ring behind.
                let longest = longest.min(LOOK_FOR_ENROLMENT);
                timeout(longest, self.sealed.notified()).await.ok();
            }
            Next::Pause(pause) => {
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
            tokio::time::sleep_until(until.min(Instant::now() + LOOK_FOR_ENROLMENT)).await;
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
