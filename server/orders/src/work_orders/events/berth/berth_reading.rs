//! Reading of the magnetometer at the berth.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::recorded_reading::RecordedReading;

impl Event for RecordedReading {
    fn apply(&self, state: &mut OrderState) {
        if state.accept_reading(self) {
            (
                state.first_reading,
                state.before_adjustment,
                state.before_second_reading,
            ) = (None, None, None);
            state.unconfirmed_heeling_steps.clear();
        }
    }
}
