//! Sealed batches to the shore, models and settings back: one after another,
//! again and again, never giving up.
//!
//! What always holds:
//!
//! - A batch counts as sent when the shore's answer has been read and kept, not
//!   before. Until then it is sent again, byte for byte.
//! - No failure loses data or stops the agent; each is on the page in words.
//! - Evidence of an alert goes before everything else, and cuts a pause short.
//! - Nothing is sent that the day's budget does not allow ([`plan`]); it is paid for,
//!   and that is kept, before it is sent.
//! - A report for the logbook goes before the other batches: it is short, and changes
//!   how they are read. One that the shore does not take keeps nothing else back.
//! - A model or settings that arrive are kept first and then in effect at once.

mod backoff;
mod plan;
mod shore;
mod start;

pub(crate) use plan::{Account, Plan, Profile, REQUEST_OCTETS};
pub(crate) use shore::{Shore, Trouble};
pub(crate) use start::{Told, prepare};

use backoff::Backoff;
use plan::{Budget, Class, Now};
use shore::Have;

use crate::spool::{Identity, SealedBatch, Spool, StoredReport};
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, Downlink, ModelDownlink, Settings};
use rand::rngs::StdRng;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Notify, watch};
use tokio::time::{Instant, timeout};
use tokio_util::sync::CancellationToken;

/// How often a pause or idleness is interrupted to see whether the agent was enrolled anew.
const LOOK_FOR_ENROLMENT: Duration = Duration::from_secs(5);

/// How the link is, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LinkStatus {
    /// In one word.
    pub(crate) state: LinkState,
    /// What is wrong, in words.
    pub(crate) problem: Option<String>,
    /// When the shore last answered, by its clock.
    pub(crate) last_contact: Option<Timestamp>,
}

/// How the link is, in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LinkState {
    /// There is no token: see `enrol`.
    #[default]
    NotEnrolled,
    /// The first try is under way.
    Connecting,
    /// The last request was answered.
    Up,
    /// The last request was not answered.
    Down,
    /// The shore does not know the token or the stream.
    Refused,
}

/// What the shore decides, as it is now.
#[derive(Debug)]
pub(crate) struct Tell {
    /// The model to steer by.
    pub(crate) model: watch::Sender<Option<ModelDownlink>>,
    /// Why that model holds no more.
    pub(crate) withdrawn: watch::Sender<Option<CardWithdrawn>>,
    /// How to sample and send.
    pub(crate) settings: watch::Sender<Settings>,
    /// How the link is.
    pub(crate) link: watch::Sender<LinkStatus>,
}

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
        if let Err(error) = self.spool.keep_account(&self.budget.account()).await {
            tracing::error!(%error, "the budget cannot be kept");
        }
        let mut answered = None;
        loop {
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
            && !self.spool.note_try(batch).await?
        {
            return Ok(Next::GoOn);
        }
        let cost = self.spend(octets).await?;
        let result = match &batch {
            Some(batch) => self.shore.put_batch(&identity, batch, have).await,
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
        self.spool.keep_account(&self.budget.account()).await?;
        Ok(cost)
    }

    /// Pays for the answer, or takes back what no connection cost.
    async fn settle(&mut self, cost: f64, trouble: Option<&Trouble>) -> sqlx::Result<()> {
        if let Some(Trouble::NoConnection(_)) = trouble {
            self.budget.take_back(cost);
        }
        self.budget.answered(self.shore.take_octets());
        self.spool.keep_account(&self.budget.account()).await
    }

    async fn next_report(&self) -> sqlx::Result<Option<StoredReport>> {
        if self
            .no_reports_before
            .is_some_and(|time| Instant::now() < time)
        {
            return Ok(None);
        }
        self.spool.next_report().await
    }

    async fn send_report(
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
                if self.spool.identity().await?.as_ref() == Some(identity) {
                    self.spool.report_answered(report, &answer).await?;
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
                self.spool.report_refused(report, &problem).await?;
                Ok(Next::GoOn)
            }
            // A token that is not known any more shows itself in what is sent next.
            Err(Trouble::Unknown(problem)) => {
                tracing::warn!(problem, "the shore does not take reports for now");
                self.no_reports_before = Some(Instant::now() + self.poll);
                Ok(Next::GoOn)
            }
            Err(trouble) => self.fail(identity, None, trouble).await,
        }
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

    async fn succeed(
        &mut self,
        identity: &Identity,
        batch: Option<&SealedBatch>,
        downlink: Downlink,
    ) -> sqlx::Result<Next> {
        if self.spool.identity().await?.as_ref() != Some(identity) {
            // Enrolled anew meanwhile: this answer is for another stream.
            return Ok(Next::GoOn);
        }
        let downlink = self.without_unread(downlink);
        match batch {
            Some(batch) => {
                self.spool
                    .acknowledge(identity.stream, batch, &downlink)
                    .await?;
                tracing::info!(
                    seq = batch.seq,
                    bytes = batch.bytes.len(),
                    "a batch is ashore"
                );
            }
            None => self.spool.keep_downlink(&downlink).await?,
        }
        self.backoff.reset();
        let contiguous = downlink.contiguous_seq;
        self.take_effect(downlink);
        // Only the answer to a batch is sure to come from where batches are kept.
        if batch.is_some() && self.spool.has_unfillable_gap(contiguous).await? {
            tracing::warn!(
                contiguous,
                "the shore lacks batches that are no longer here"
            );
            return self.open_stream(identity).await;
        }
        Ok(Next::GoOn)
    }

    /// Makes the best of a model that this version cannot read: the one on board goes
    /// on, unless that other one is of a ship altered since.
    fn without_unread(&self, mut downlink: Downlink) -> Downlink {
        let Some(unread) = downlink.unread.take() else {
            return downlink;
        };
        tracing::error!(
            version = unread.version,
            "the shore sent a model that this agent cannot read: update it"
        );
        let model = self.tell.model.borrow();
        let known = model.as_ref().and_then(|model| model.replaces.as_ref());
        if unread.replaces.as_ref() != known {
            downlink.card_withdrawn = downlink.card_withdrawn.or(unread.replaces);
        }
        downlink
    }

    fn take_effect(&self, downlink: Downlink) {
        if let Some(model) = downlink.model {
            tracing::info!(version = model.version, "a new model is in effect");
            let mut before = self.tell.model.borrow().clone();
            let before = before.take().and_then(|model| model.replaces);
            if let Some(replaces) = model.replaces.as_ref().filter(|_| before != model.replaces) {
                tracing::warn!("{}", replaces.of_older_cards());
            }
            self.tell.model.send_replace(Some(model));
        }
        // Only now: the model before must not hold again for a moment.
        let withdrawn = downlink.card_withdrawn;
        if let Some(withdrawn) = withdrawn
            .as_ref()
            .filter(|_| *self.tell.withdrawn.borrow() != withdrawn)
        {
            tracing::warn!("{}: {}", withdrawn.in_words(), CardWithdrawn::ADVICE);
        }
        self.tell.withdrawn.send_replace(withdrawn);
        if let Some(settings) = downlink.settings {
            tracing::info!(version = settings.version, "new settings are in effect");
            self.tell.settings.send_replace(settings);
        }
        self.tell.link.send_replace(LinkStatus {
            state: LinkState::Up,
            problem: None,
            last_contact: Some(downlink.server_time),
        });
    }

    async fn fail(
        &mut self,
        identity: &Identity,
        batch: Option<&SealedBatch>,
        trouble: Trouble,
    ) -> sqlx::Result<Next> {
        let problem = trouble.to_string();
        let (state, pause) = match (trouble, batch) {
            (Trouble::Forked, _) => {
                tracing::warn!("the stream has forked: opening another");
                return self.open_stream(identity).await;
            }
            (Trouble::Refused(_), Some(batch)) => {
                tracing::error!(
                    seq = batch.seq,
                    problem,
                    "the shore refuses a batch: kept aside"
                );
                self.spool.park(batch.seq, &problem).await?;
                (LinkState::Up, self.backoff.next(&mut self.rng))
            }
            (Trouble::Unknown(_), _) if self.spool.swap_tokens(&identity.token).await? => {
                tracing::warn!(problem, "trying the agent's other token");
                (LinkState::Refused, self.backoff.next(&mut self.rng))
            }
            (Trouble::Unknown(_) | Trouble::Refused(_), _) => {
                tracing::error!(problem, "the shore refuses the agent: enrol it again");
                (LinkState::Refused, self.backoff.most())
            }
            (Trouble::Busy { retry_after, .. }, _) => {
                let pause = self.backoff.next(&mut self.rng);
                (
                    LinkState::Down,
                    retry_after.map_or(pause, |asked| asked.max(pause)),
                )
            }
            (Trouble::Link(_) | Trouble::NoConnection(_), _) => {
                (LinkState::Down, self.backoff.next(&mut self.rng))
            }
        };
        tracing::warn!(problem, pause_s = pause.as_secs_f64(), "not sent");
        self.tell.link.send_modify(|link| {
            link.state = state;
            link.problem = Some(problem);
        });
        Ok(Next::Pause(pause))
    }

    async fn open_stream(&mut self, identity: &Identity) -> sqlx::Result<Next> {
        match self.shore.open_stream(identity).await {
            Ok(stream) => {
                self.spool.move_to_stream(stream).await?;
                Ok(Next::GoOn)
            }
            Err(trouble) => {
                let pause = self.backoff.next(&mut self.rng);
                tracing::warn!(%trouble, pause_s = pause.as_secs_f64(), "no new stream");
                self.tell.link.send_modify(|link| {
                    link.state = LinkState::Down;
                    link.problem = Some(trouble.to_string());
                });
                Ok(Next::Pause(pause))
            }
        }
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
