//! State of an order: the fold of the events in its log.
//!
//! Invariant: it is a function of the log alone, so that the state in the database can be derived
//! again.

use crate::work_orders::offers::Offers;
use crate::work_orders::payload::as_found::AsFound;
use crate::work_orders::payload::chosen_plan::ChosenPlan;
use crate::work_orders::payload::hours::Hours;
use crate::work_orders::payload::photograph::Photo;
use crate::work_orders::payload::port_call::CallChange;
use crate::work_orders::payload::recorded_reading::RecordedReading;
use crate::work_orders::payload::recorded_second_reading::{
    PARTS_WITH_VERTICAL, RecordedSecondReading,
};
use crate::work_orders::payload::sea_verification::SeaVerification;
use crate::work_orders::payload::signed_record::{Completion, RecordedSignature};
use crate::work_orders::payload::step_result::{StepResult, StepVerdict};
use crate::work_orders::state::State;
use binnacle_adjustment::adjust::{
    CompletedStep, Corrector, Limits, PredictedTable, Step, UpdatedPrediction,
};
use binnacle_adjustment::binnacle::{Binnacle, Setting};

/// State of an order.
#[derive(Clone, Debug, Default)]
pub(crate) struct OrderState {
    /// State as the API names it.
    pub state: State,
    /// Offers to firms.
    pub offers: Offers,
    /// Hours of the job, as ordered or agreed.
    pub hours: Option<Hours>,
    /// Change of the port call since the time was agreed.
    pub call_change: Option<CallChange>,
    /// Port of the job, if its call has ever moved.
    pub port: Option<String>,
    /// Limits on plans.
    pub limits: Limits,
    /// Correctors and compass as found.
    pub as_found: Option<AsFound>,
    /// Last reading at the berth that was accepted.
    pub reading: Option<RecordedReading>,
    /// Binnacle with the strengths found so far, its correctors set as at the reading.
    pub binnacle: Option<Binnacle>,
    /// Strengths and wrong ends inferred from steps, in order.
    pub inferred_strengths: Vec<InferredStrength>,
    /// Setting of the correctors, if they were moved since the reading.
    pub moved_to: Option<Setting>,
    /// Plan being followed.
    pub plan: Option<ChosenPlan>,
    /// Number of its steps done.
    pub steps_done: usize,
    /// Result of the last step.
    pub last_step: Option<StepResult>,
    /// True if nothing explained the compass after the last step, and nobody has reported the
    /// correctors since: they may stand anywhere.
    pub has_unexplained_step: bool,
    /// Steps done since the last reading, with the turns of the compass.
    pub steps: Vec<CompletedStep>,
    /// Heeling magnets moved before a second reading without a vertical part, which became
    /// the reading to plan from. No reading confirms these steps.
    pub unconfirmed_heeling_steps: Vec<CompletedStep>,
    /// Number of steps inspected since, when the settings were reported.
    pub inspected_steps: usize,
    /// Second reading of the present settings.
    pub second_reading: Option<Box<RecordedSecondReading>>,
    /// True if the settings were reported since the second reading.
    pub inspected_since_reading: bool,
    /// First reading of an order that was replanned from a second one.
    pub first_reading: Option<Box<RecordedReading>>,
    /// Predictions before any corrector was moved, by the last plan from the first reading.
    pub before_adjustment: Option<Box<CompassBefore>>,
    /// State before a second reading became the one to plan from. Until the next event of
    /// the session the field may be read once more.
    pub before_second_reading: Option<Box<OrderState>>,
    /// Last reading of the compass at the berth, degrees.
    pub compass_deg: Option<f64>,
    /// Completion of the adjustment.
    pub completion: Option<Completion>,
    /// Last verdict of headings at sea.
    pub verification: Option<SeaVerification>,
    /// Photographs, in order.
    pub photos: Vec<Photo>,
    /// Signatures by firms' keys, in order.
    pub signatures: Vec<RecordedSignature>,
}

/// Strength of a corrector, or a wrong end in the record, inferred from the turn of the compass at a
/// step.
#[derive(Clone, Debug)]
pub(crate) struct InferredStrength {
    /// Verdict on the step.
    pub verdict: StepVerdict,
    /// The step, with the assumed position of its corrector.
    pub step: Step,
    /// Reading of the compass before it, degrees.
    pub before_deg: f64,
    /// Binnacle as known before it.
    pub binnacle: Binnacle,
}

/// Predictions for a compass before its correctors were moved.
#[derive(Clone, Debug)]
pub(crate) struct CompassBefore {
    /// Deviations at the berth and in the waters.
    pub deviations: Vec<PredictedTable>,
    /// Heeling error on north, degrees per degree of heel.
    pub heeling_deg_per_deg: Option<f64>,
}

impl OrderState {
    /// Takes over the state of the offers.
    pub(crate) fn follow_offers(&mut self) {
        self.state = self.offers.state();
    }

    /// Takes over other agreed hours, with the port call as it is now.
    pub(crate) fn agree_time(&mut self, hours: Hours) {
        (self.hours, self.call_change) = (Some(hours), None);
    }

    /// Takes over a reading to plan from; returns whether it was accepted.
    pub(crate) fn accept_reading(&mut self, read: &RecordedReading) -> bool {
        let Some(basis) = &read.basis else {
            return false;
        };
        if read.refusal.is_some() {
            return false;
        }
        self.binnacle = Some(basis.binnacle.clone());
        self.inferred_strengths.clear();
        self.moved_to = None;
        self.plan = None;
        self.steps_done = 0;
        self.last_step = None;
        self.has_unexplained_step = false;
        self.steps.clear();
        self.inspected_steps = 0;
        self.second_reading = None;
        self.compass_deg = read.given.compass_deg;
        self.reading = Some(read.clone());
        self.state = State::Measured;
        true
    }

    /// Drops the reading to plan from, which was judged by correctors that do not stand so, with
    /// everything that followed it.
    pub(crate) fn drop_reading(&mut self) {
        let is_of_firm = self.offers.holder().is_some();
        *self = OrderState {
            state: if is_of_firm {
                State::OnBoard
            } else {
                State::Planned
            },
            offers: std::mem::take(&mut self.offers),
            hours: self.hours.take(),
            call_change: self.call_change.take(),
            port: self.port.take(),
            limits: self.limits,
            as_found: self.as_found.take(),
            photos: std::mem::take(&mut self.photos),
            ..OrderState::default()
        };
    }

    /// Restores the state before the second reading became the one to plan from, if nothing
    /// followed it.
    pub(crate) fn restore_first_reading(&mut self) {
        let Some(before) = self.before_second_reading.take() else {
            return;
        };
        let before = *before;
        self.state = before.state;
        self.reading = before.reading;
        self.binnacle = before.binnacle;
        self.inferred_strengths = before.inferred_strengths;
        self.moved_to = before.moved_to;
        self.plan = before.plan;
        self.steps_done = before.steps_done;
        self.last_step = before.last_step;
        self.steps = before.steps;
        self.unconfirmed_heeling_steps = before.unconfirmed_heeling_steps;
        self.inspected_steps = before.inspected_steps;
        self.second_reading = before.second_reading;
        self.inspected_since_reading = before.inspected_since_reading;
        self.first_reading = before.first_reading;
        self.compass_deg = before.compass_deg;
    }

    /// Takes over a plan to follow.
    pub(crate) fn follow_plan(&mut self, planned: ChosenPlan) {
        // A plan from a second reading already includes it.
        if self.plans_from_second_reading() {
            self.second_reading = None;
        }
        self.drop_confirmation();
        self.before_second_reading = None;
        if self.first_reading.is_none() {
            self.before_adjustment = Some(Box::new(CompassBefore {
                deviations: planned.plan.before.clone(),
                heeling_deg_per_deg: planned.plan.heeling.before_deg_per_deg,
            }));
        }
        self.plan = Some(planned);
        self.steps_done = 0;
        self.state = State::Adjusting;
    }

    /// Returns whether the second reading is the one to plan from.
    fn plans_from_second_reading(&self) -> bool {
        let reading = self
            .second_reading
            .as_ref()
            .and_then(|second| second.reading_to_plan_from.as_ref());
        reading.is_some_and(|reading| reading.refusal.is_none())
    }

    /// Drops a second reading that confirmed settings which no longer hold. One that
    /// contradicted them stays: moving more correctors does not answer it.
    pub(crate) fn drop_confirmation(&mut self) {
        self.second_reading = self
            .second_reading
            .take()
            .filter(|second| second.is_contradiction());
    }

    /// Next step of the plan.
    pub(crate) fn next_step(&self) -> Option<&Step> {
        if self.state != State::Adjusting {
            return None;
        }
        self.plan.as_ref()?.plan.steps.get(self.steps_done)
    }

    /// Present setting of the correctors.
    pub(crate) fn setting(&self) -> Option<&Setting> {
        let as_read = self.binnacle.as_ref().map(|binnacle| &binnacle.setting);
        self.moved_to.as_ref().or(as_read)
    }

    /// Returns whether a corrector was moved, or may have been.
    pub(crate) fn has_moved_correctors(&self) -> bool {
        if self.first_reading.is_some() || self.has_unexplained_step {
            return true;
        }
        let as_read = self.binnacle.as_ref().map(|binnacle| &binnacle.setting);
        self.moved_to.is_some() && self.moved_to.as_ref() != as_read
    }

    /// Prediction updated by a second reading that confirmed the steps.
    pub(crate) fn confirmed_prediction(&self) -> Option<&UpdatedPrediction> {
        let second = self.second_reading.as_ref()?;
        second
            .prediction
            .as_ref()
            .filter(|_| !second.is_contradiction())
    }

    /// Second reading that did not confirm the steps.
    pub(crate) fn contradicting_reading(&self) -> Option<&RecordedSecondReading> {
        self.second_reading
            .as_deref()
            .filter(|second| second.is_contradiction())
    }

    /// Steps that neither the compass on this heading nor the magnetometer confirms.
    pub(crate) fn unconfirmed_steps(&self) -> Vec<&str> {
        let confirmed = self
            .confirmed_prediction()
            .and(self.second_reading.as_ref());
        let shows = |corrector: Corrector| {
            let is_whole =
                |second: &RecordedSecondReading| second.result.parts.len() == PARTS_WITH_VERTICAL;
            confirmed.is_some_and(|second| corrector != Corrector::Heeling || is_whole(second))
        };
        let hidden = self.unconfirmed_heeling_steps.iter().chain(&self.steps);
        let hidden = hidden.filter(|done| !done.step.seen && !shows(done.step.corrector));
        hidden.map(|done| done.step.words.as_str()).collect()
    }

    /// Returns whether headings at sea confirmed the adjustment.
    pub(crate) fn is_verified(&self) -> bool {
        let verification = self.verification.as_ref();
        verification.is_some_and(SeaVerification::has_passed)
    }
}
