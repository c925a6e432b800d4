//! Settings of the correctors, as someone found or set them.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::{InferredStrength, OrderState};
use crate::work_orders::payload::step_result::{StepResult, StepVerdict};
use crate::work_orders::state::State;
use binnacle_adjustment::adjust::Step;
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};

/// Report of the correctors' settings.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CorrectorMove {
    /// Setting before.
    pub before: Setting,
    /// Setting after.
    pub after: Setting,
    /// Compass reading with the new setting, degrees.
    pub compass_deg: Option<f64>,
    /// Reason.
    pub note: Option<String>,
    /// True if the new setting explains a second reading that did not fit the old one.
    #[serde(default)]
    pub explains_reading: bool,
    /// Correction of a strength that was inferred from an assumed setting.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        rename = "learnt_anew"
    )]
    pub revised_strength: Option<Box<RevisedStrength>>,
    /// Time of the report.
    pub at: Time,
}

/// Correction of a strength that was inferred before.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RevisedStrength {
    /// Step that it was inferred from, with the actual position of its corrector.
    pub step: Step,
    /// Binnacle with the corrected strength.
    pub binnacle: Binnacle,
}

impl Event for CorrectorMove {
    fn apply(&self, state: &mut OrderState) {
        let is_unchanged = state.setting() == Some(&self.after);
        // A reading before the move does not hold after it.
        let unmoved_deg = state.compass_deg.filter(|_| is_unchanged);
        if !is_unchanged {
            // The second reading was judged by the assumed setting.
            let reading = state.second_reading.take();
            let reading = reading.filter(|_| !self.explains_reading);
            state.restore_first_reading();
            state.second_reading = reading.filter(|reading| reading.is_contradiction());
        }
        if let Some(revised) = &self.revised_strength
            && let Some(index) = self.disputed_index(state)
        {
            state.inferred_strengths.truncate(index + 1);
            state.inferred_strengths[index].step = revised.step.clone();
            state.binnacle = Some(revised.binnacle.clone());
            // The step's result and the plan rested on the disputed strength.
            (state.last_step, state.plan) = (None, None);
        }
        state.compass_deg = self.compass_deg.or(unmoved_deg);
        // The report covers every corrector.
        state.has_unexplained_step = false;
        state.inspected_steps = state.steps.len();
        state.inspected_since_reading = state.second_reading.is_some();
        state.moved_to = Some(self.after.clone());
        match &state.plan {
            Some(plan) if plan.plan.setting == self.after => {
                state.steps_done = plan.plan.steps.len();
            }
            // A setting other than the plan's needs another plan.
            _ => {
                state.plan = None;
                state.state = State::Measured;
            }
        }
    }
}

impl CorrectorMove {
    /// Strength that this report disputes: its corrector stands elsewhere than assumed, or
    /// the compass was read once more after its step.
    pub(crate) fn disputed_strength<'a>(
        &self,
        state: &'a OrderState,
    ) -> Option<&'a InferredStrength> {
        let index = self.disputed_index(state)?;
        state.inferred_strengths.get(index)
    }

    fn disputed_index(&self, state: &OrderState) -> Option<usize> {
        let assumed = state.setting()?;
        let mut strengths = state.inferred_strengths.iter();
        let elsewhere =
            strengths.position(|strength| strength.step.is_contradicted(assumed, &self.after));
        let is_last = |result: &StepResult| {
            matches!(
                result.verdict,
                StepVerdict::OtherStrength | StepVerdict::FoundOtherwise
            )
        };
        let is_read_again = *assumed == self.after
            && self.compass_deg.is_some()
            && state.last_step.as_ref().is_some_and(is_last);
        elsewhere.or_else(|| {
            let last = state.inferred_strengths.len().checked_sub(1);
            last.filter(|_| is_read_again)
        })
    }
}
