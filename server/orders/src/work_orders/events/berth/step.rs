//! Step at the binnacle, with the compass's reading after it.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::{InferredStrength, OrderState};
use crate::work_orders::payload::chosen_plan::ChosenPlan;
use crate::work_orders::payload::step_result::{StepResult, StepVerdict};
use crate::work_orders::refusal::Refusal;
use crate::work_orders::state::State;
use binnacle_adjustment::adjust::{CompletedStep, Step};
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_compass::angle::wrap_180;
use serde::{Deserialize, Serialize};

/// Step with its result and its consequences.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedStep {
    /// Result.
    #[serde(flatten)]
    pub result: StepResult,
    /// The step.
    pub step: Step,
    /// Setting of the correctors afterwards; `None` if nothing changed.
    pub setting: Option<Setting>,
    /// Binnacle, if a corrector was found to have another strength, or to have stood otherwise than
    /// recorded.
    pub binnacle: Option<Binnacle>,
    /// New plan from there.
    pub replanned: Option<Box<ChosenPlan>>,
    /// Reasons for which there is no new plan.
    pub refusals: Vec<Refusal>,
}

impl Event for RecordedStep {
    fn apply(&self, state: &mut OrderState) {
        state.before_second_reading = None;
        state.drop_confirmation();
        // An unexplained reading is repeated from the last known one.
        state.has_unexplained_step = self.result.verdict == StepVerdict::Unexplained;
        if !state.has_unexplained_step {
            state.compass_deg = Some(self.result.after_deg);
        }
        state.last_step = Some(self.result.clone());
        if let Some(binnacle) = &self.binnacle {
            let before = state.binnacle.replace(binnacle.clone());
            let inferred = before.map(|binnacle| InferredStrength {
                verdict: self.result.verdict,
                step: self.step.clone(),
                before_deg: self.result.before_deg,
                binnacle,
            });
            state.inferred_strengths.extend(inferred);
        }
        if let Some(setting) = &self.setting {
            state.moved_to = Some(setting.clone());
        }
        if self.result.is_confirmed() {
            state.steps_done += 1;
            let turned_deg = wrap_180(self.result.after_deg - self.result.before_deg);
            state.steps.push(CompletedStep {
                step: self.step.clone(),
                turned_deg: Some(turned_deg),
            });
        } else if self.setting.is_some() {
            state.plan = None;
            state.state = State::Measured;
        }
        if let Some(plan) = &self.replanned {
            state.follow_plan(plan.as_ref().clone());
        }
    }
}
