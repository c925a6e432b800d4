//! Second reading of the magnetometer, after the steps.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::recorded_second_reading::{
    PARTS_WITH_VERTICAL, RecordedSecondReading,
};
use binnacle_adjustment::adjust::{CompletedStep, Corrector};

impl Event for RecordedSecondReading {
    fn apply(&self, state: &mut OrderState) {
        state.restore_first_reading();
        let before = state.clone();
        if let (Some(reading), Some(first)) = (&self.reading_to_plan_from, before.reading.clone())
            && state.accept_reading(reading)
        {
            if self.result.parts.len() < PARTS_WITH_VERTICAL {
                let heels = |done: &&CompletedStep| done.step.corrector == Corrector::Heeling;
                let unconfirmed = before.steps.iter().filter(heels).cloned();
                state.unconfirmed_heeling_steps.extend(unconfirmed);
            } else {
                state.unconfirmed_heeling_steps.clear();
            }
            // No corrector was moved since the last compass reading.
            state.compass_deg = reading.given.compass_deg.or(before.compass_deg);
            state.first_reading.get_or_insert_with(|| Box::new(first));
            state.before_second_reading = Some(Box::new(before));
        }
        state.second_reading = Some(Box::new(self.clone()));
        state.inspected_since_reading = false;
    }
}
