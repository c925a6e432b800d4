//! How an order stands: what follows from the entries of its log, one after the other.
//!
//! What always holds: it is a function of the log alone, so that the state in the
//! database can be derived again.

use crate::berth_session::berth_reading::RecordedReading;
use crate::berth_session::photos::Photo;
use crate::berth_session::plan::ChosenPlan;
use crate::berth_session::second_reading::PARTS_WITH_VERTICAL;
use crate::berth_session::second_reading_api::RecordedSecondReading;
use crate::berth_session::steps::{CorrectorMove, StepResult, StepVerdict};
use crate::completion::complete::{Completion, RecordedSignature};
use crate::dispatch::port_call_changes::CallChange;
use crate::verification::SeaVerification;
use crate::work_orders::log_entry::OrderEvent;
use crate::work_orders::offer_state::Offers;
use crate::work_orders::order::State;
use binnacle_adjustment::adjust::{
    CompletedStep, Corrector, Limits, PredictedTable, Step, UpdatedPrediction, Verification,
};
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_compass::angle::wrap_180;
use binnacle_platform::time::Time;

/// How an order stands.
#[derive(Clone, Debug)]
pub(crate) struct OrderState {
    /// How far it has come.
    pub state: State,
    /// What became of its offers to firms.
    pub offers: Offers,
    /// For when it is, as it was written or agreed.
    planned_at: Option<Time>,
    /// What became of its port call since its time was agreed.
    pub call: Option<CallChange>,
    /// The port that it is for, where its call has ever moved.
    pub port: Option<String>,
    /// What a plan must keep to.
    pub limits: Limits,
    /// The last reading that was taken.
    pub read: Option<RecordedReading>,
    /// The binnacle, its correctors as strong as they were found to be, standing as they
    /// stood when the magnetometer was read.
    pub binnacle: Option<Binnacle>,
    /// What of that was learnt from steps, in order.
    strengths: Vec<InferredStrength>,
    /// How they stand now, where they were moved since.
    pub moved_to: Option<Setting>,
    /// The plan that is followed.
    pub plan: Option<ChosenPlan>,
    /// How many of its steps are done.
    pub steps_done: usize,
    /// What became of the last step.
    pub last_step: Option<StepResult>,
    /// All steps that were done since the last reading, with what the compass showed.
    pub steps: Vec<CompletedStep>,
    /// Heeling magnets moved before a second reading without its vertical part that became
    /// the one to plan from: nothing has shown these steps.
    unshown: Vec<CompletedStep>,
    /// At how many of them someone has looked since, to say how the correctors stand.
    pub looked_at: usize,
    /// What the magnetometer said after them, the correctors standing as they stand.
    pub again: Option<Box<RecordedSecondReading>>,
    /// Someone has said since that reading how the correctors stand.
    pub looked_since: bool,
    /// The first reading of an order that was planned anew from a second one.
    pub first: Option<Box<RecordedReading>>,
    /// How the compass was before, by the last plan from the first reading.
    pub before: Option<Box<Before>>,
    /// How it stood before a second reading became the one to plan from: until something
    /// else is done it may be read once more.
    undone: Option<Box<OrderState>>,
    /// What the compass read last at the berth, degrees.
    pub compass_deg: Option<f64>,
    /// How it was completed.
    pub completed: Option<Completion>,
    /// What the headings at sea say.
    pub verified: Option<SeaVerification>,
    /// Photographs, in order.
    pub photos: Vec<Photo>,
    /// Signatures by firms' keys, in order.
    pub signatures: Vec<RecordedSignature>,
}

/// A strength that was learnt from what the compass showed of a step.
#[derive(Clone, Debug)]
pub(crate) struct InferredStrength {
    /// The step, its corrector where it is taken to stand.
    pub step: Step,
    /// What the compass read before it, degrees.
    pub before_deg: f64,
    /// The binnacle as it was known before it.
    pub binnacle: Binnacle,
}

/// How a compass was before its correctors were moved.
#[derive(Clone, Debug)]
pub(crate) struct Before {
    /// Deviations at the berth and in the waters.
    pub deviations: Vec<PredictedTable>,
    /// Heeling error on north, degrees for each degree of heel.
    pub heeling_deg_per_deg: Option<f64>,
}

impl OrderState {
    /// How an order stands whose log says this.
    pub(crate) fn of<'a>(log: impl Iterator<Item = &'a OrderEvent>) -> OrderState {
        let mut standing = OrderState {
            state: State::Planned,
            offers: Offers::default(),
            planned_at: None,
            call: None,
            port: None,
            limits: Limits::default(),
            read: None,
            binnacle: None,
            strengths: Vec::new(),
            moved_to: None,
            plan: None,
            steps_done: 0,
            last_step: None,
            steps: Vec::new(),
            unshown: Vec::new(),
            looked_at: 0,
            again: None,
            looked_since: false,
            first: None,
            before: None,
            undone: None,
            compass_deg: None,
            completed: None,
            verified: None,
            photos: Vec::new(),
            signatures: Vec::new(),
        };
        for content in log {
            standing.take(content);
        }
        standing
    }

    /// Goes on by an entry.
    pub(crate) fn take(&mut self, content: &OrderEvent) {
        self.offers.take(content);
        if let OrderEvent::ProposalAccepted(said) | OrderEvent::RetimeAccepted(said) = content
            && let Some(terms) = &said.terms
        {
            let at = Some(terms.planned_at);
            // Another time was agreed, as the call is now; a fee alone says nothing of it.
            if self.planned_at != at || matches!(content, OrderEvent::RetimeAccepted(_)) {
                (self.planned_at, self.call) = (at, None);
            }
        }
        match content {
            OrderEvent::OfferRound(_)
            | OrderEvent::OfferSent(_)
            | OrderEvent::Accepted(_)
            | OrderEvent::Declined(_)
            | OrderEvent::Proposed(_)
            | OrderEvent::ProposalAccepted(_)
            | OrderEvent::ProposalDeclined(_)
            | OrderEvent::Lapsed(_) => self.state = self.offers.state(),
            OrderEvent::CallMoved(moved) => {
                self.port.get_or_insert_with(|| moved.call.was.port.clone());
                self.call = Some(moved.call.clone());
            }
            OrderEvent::OnBoard(_) => self.state = State::OnBoard,
            OrderEvent::Photo(photo) => self.photos.push(photo.clone()),
            OrderEvent::Signature(signature) => self.signatures.push(signature.clone()),
            OrderEvent::Opened(opened) => {
                self.limits = opened.order.limits.unwrap_or_default();
                self.planned_at = Some(opened.order.planned_at);
            }
            OrderEvent::RetimeProposed(_)
            | OrderEvent::RetimeAccepted(_)
            | OrderEvent::RetimeDeclined(_)
            | OrderEvent::RetimeLapsed(_)
            | OrderEvent::Remark(_)
            | OrderEvent::Message(_) => {}
            OrderEvent::BerthReading(read) => {
                if self.take_reading(read) {
                    (self.first, self.before, self.undone) = (None, None, None);
                    self.unshown.clear();
                }
            }
            OrderEvent::SecondReading(read) => self.take_second_reading(read),
            OrderEvent::Plan(planned) => self.follow(planned.as_ref().clone()),
            OrderEvent::Step(done) => {
                self.undone = None;
                self.drop_confirmation();
                // What nothing explains is read again, from where it was.
                if done.said.verdict != StepVerdict::Unexplained {
                    self.compass_deg = Some(done.said.after_deg);
                }
                self.last_step = Some(done.said.clone());
                if let Some(binnacle) = &done.binnacle {
                    let before = self.binnacle.replace(binnacle.clone());
                    self.strengths
                        .extend(before.map(|binnacle| InferredStrength {
                            step: done.step.clone(),
                            before_deg: done.said.before_deg,
                            binnacle,
                        }));
                }
                if let Some(setting) = &done.setting {
                    self.moved_to = Some(setting.clone());
                }
                if done.said.is_confirmed() {
                    self.steps_done += 1;
                    let turned_deg = wrap_180(done.said.after_deg - done.said.before_deg);
                    self.steps.push(CompletedStep {
                        step: done.step.clone(),
                        turned_deg: Some(turned_deg),
                    });
                } else if done.setting.is_some() {
                    self.plan = None;
                    self.state = State::Measured;
                }
                if let Some(plan) = &done.replanned {
                    self.follow(plan.as_ref().clone());
                }
            }
            OrderEvent::CorrectorSettings(moved) => self.take_settings(moved),
            OrderEvent::Completion(completed) => {
                self.completed = Some(completed.as_ref().clone());
                self.state = State::Adjusted;
            }
            OrderEvent::Verification(verified) => {
                self.state = match verified.verification {
                    Verification::Passed { .. } => State::Verified,
                    Verification::MoreNeeded { .. } => State::Adjusted,
                    Verification::Alarm { .. } => State::Failed,
                };
                self.verified = Some(verified.as_ref().clone());
            }
            OrderEvent::Closed(_) => {
                self.state = match self.state {
                    State::Adjusted => State::ClosedUnverified,
                    _ => State::Closed,
                };
            }
            OrderEvent::Cancelled(_) => self.state = State::Cancelled,
        }
    }

    /// Whether it was taken.
    fn take_reading(&mut self, read: &RecordedReading) -> bool {
        let Some(basis) = &read.basis else {
            return false;
        };
        if read.refusal.is_some() {
            return false;
        }
        self.binnacle = Some(basis.binnacle.clone());
        self.strengths.clear();
        self.moved_to = None;
        self.plan = None;
        self.steps_done = 0;
        self.last_step = None;
        self.steps.clear();
        self.looked_at = 0;
        self.again = None;
        self.compass_deg = read.given.compass_deg;
        self.read = Some(read.clone());
        self.state = State::Measured;
        true
    }

    fn take_settings(&mut self, moved: &CorrectorMove) {
        let stands = self.setting() == Some(&moved.after);
        // What it read before they were moved says nothing of how it reads now.
        let still = self.compass_deg.filter(|_| stands);
        if !stands {
            // What was learnt of them held for how they were taken to stand.
            let again = self.again.take().filter(|_| !moved.explains_reading);
            self.restore_first_reading();
            self.again = again.filter(|again| again.is_disproof());
        }
        if let Some(anew) = &moved.learnt_anew
            && let Some(index) = self.disputed(moved)
        {
            self.strengths.truncate(index + 1);
            self.strengths[index].step = anew.step.clone();
            self.binnacle = Some(anew.binnacle.clone());
            // What was said of it, and planned by it, holds no longer.
            (self.last_step, self.plan) = (None, None);
        }
        self.compass_deg = moved.compass_deg.or(still);
        // Someone has looked at every one of them.
        self.looked_at = self.steps.len();
        self.looked_since = self.again.is_some();
        self.moved_to = Some(moved.after.clone());
        match &self.plan {
            Some(plan) if plan.plan.setting == moved.after => {
                self.steps_done = plan.plan.steps.len();
            }
            // Another way than the plan's: there has to be another plan.
            _ => {
                self.plan = None;
                self.state = State::Measured;
            }
        }
    }

    /// The strength that this word disputes: its corrector stands elsewhere than it was
    /// taken to, or the compass was read once more after its step.
    pub(crate) fn disputed_by(&self, moved: &CorrectorMove) -> Option<&InferredStrength> {
        let index = self.disputed(moved)?;
        self.strengths.get(index)
    }

    fn disputed(&self, moved: &CorrectorMove) -> Option<usize> {
        let taken = self.setting()?;
        let mut strengths = self.strengths.iter();
        let elsewhere =
            strengths.position(|strength| strength.step.is_contradicted(taken, &moved.after));
        let is_last = |said: &StepResult| said.verdict == StepVerdict::OtherStrength;
        let is_read_again = *taken == moved.after
            && moved.compass_deg.is_some()
            && self.last_step.as_ref().is_some_and(is_last);
        elsewhere.or_else(|| {
            let last = self.strengths.len().checked_sub(1);
            last.filter(|_| is_read_again)
        })
    }

    fn take_second_reading(&mut self, read: &RecordedSecondReading) {
        self.restore_first_reading();
        let before = self.clone();
        if let (Some(anew), Some(first)) = (&read.anew, before.read.clone())
            && self.take_reading(anew)
        {
            if read.said.parts.len() < PARTS_WITH_VERTICAL {
                let heels = |done: &&CompletedStep| done.step.corrector == Corrector::Heeling;
                self.unshown
                    .extend(before.steps.iter().filter(heels).cloned());
            } else {
                self.unshown.clear();
            }
            // Nothing was moved since it was read last.
            self.compass_deg = anew.given.compass_deg.or(before.compass_deg);
            self.first.get_or_insert_with(|| Box::new(first));
            self.undone = Some(Box::new(before));
        }
        self.again = Some(Box::new(read.clone()));
        self.looked_since = false;
    }

    /// As it stood before the last second reading became the one to plan from, where
    /// nothing was done about it since.
    pub(crate) fn restore_first_reading(&mut self) {
        let Some(before) = self.undone.take() else {
            return;
        };
        let before = *before;
        self.state = before.state;
        self.read = before.read;
        self.binnacle = before.binnacle;
        self.strengths = before.strengths;
        self.moved_to = before.moved_to;
        self.plan = before.plan;
        self.steps_done = before.steps_done;
        self.last_step = before.last_step;
        self.steps = before.steps;
        self.unshown = before.unshown;
        self.looked_at = before.looked_at;
        self.again = before.again;
        self.looked_since = before.looked_since;
        self.first = before.first;
        self.compass_deg = before.compass_deg;
    }

    fn follow(&mut self, planned: ChosenPlan) {
        // Only a plan from a second reading knows what that has shown.
        if self.plans_from_second_reading() {
            self.again = None;
        }
        self.drop_confirmation();
        self.undone = None;
        if self.first.is_none() {
            self.before = Some(Box::new(Before {
                deviations: planned.plan.before.clone(),
                heeling_deg_per_deg: planned.plan.heeling.before_deg_per_deg,
            }));
        }
        self.plan = Some(planned);
        self.steps_done = 0;
        self.state = State::Adjusting;
    }

    /// Whether the second reading is the one to plan from.
    fn plans_from_second_reading(&self) -> bool {
        let anew = self.again.as_ref().and_then(|again| again.anew.as_ref());
        anew.is_some_and(|anew| anew.refusal.is_none())
    }

    /// What confirmed the correctors as they stood says nothing of how they stand now; what
    /// did not is not undone by moving more of them.
    fn drop_confirmation(&mut self) {
        self.again = self.again.take().filter(|again| again.is_disproof());
    }

    /// The step to do now.
    pub(crate) fn next_step(&self) -> Option<&Step> {
        if self.state != State::Adjusting {
            return None;
        }
        self.plan.as_ref()?.plan.steps.get(self.steps_done)
    }

    /// How the correctors stand now.
    pub(crate) fn setting(&self) -> Option<&Setting> {
        let as_read = self.binnacle.as_ref().map(|binnacle| &binnacle.setting);
        self.moved_to.as_ref().or(as_read)
    }

    /// Whether a corrector was moved.
    pub(crate) fn was_moved(&self) -> bool {
        if self.first.is_some() {
            return true;
        }
        let as_read = self.binnacle.as_ref().map(|binnacle| &binnacle.setting);
        self.moved_to.is_some() && self.moved_to.as_ref() != as_read
    }

    /// What the magnetometer said after the steps, where it confirmed them.
    pub(crate) fn learnt(&self) -> Option<&UpdatedPrediction> {
        let again = self.again.as_ref()?;
        again.learnt.as_ref().filter(|_| !again.is_disproof())
    }

    /// What the magnetometer said after the steps, where it did not confirm them.
    pub(crate) fn disproof(&self) -> Option<&RecordedSecondReading> {
        self.again.as_deref().filter(|again| again.is_disproof())
    }

    /// Steps that neither the compass on this heading nor the magnetometer has shown.
    pub(crate) fn hidden_steps(&self) -> Vec<&str> {
        let confirmed = self.learnt().and(self.again.as_ref());
        let shows = |corrector: Corrector| {
            let is_whole =
                |again: &RecordedSecondReading| again.said.parts.len() == PARTS_WITH_VERTICAL;
            confirmed.is_some_and(|again| corrector != Corrector::Heeling || is_whole(again))
        };
        let hidden = self.unshown.iter().chain(&self.steps);
        let hidden = hidden.filter(|done| !done.step.seen && !shows(done.step.corrector));
        hidden.map(|done| done.step.words.as_str()).collect()
    }

    /// Whether the sea has confirmed it.
    pub(crate) fn is_verified(&self) -> bool {
        self.verified
            .as_ref()
            .is_some_and(|verified| matches!(verified.verification, Verification::Passed { .. }))
    }
}
