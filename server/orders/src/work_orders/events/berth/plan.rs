//! Choice of a plan.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::chosen_plan::ChosenPlan;

impl Event for ChosenPlan {
    fn apply(&self, state: &mut OrderState) {
        state.follow_plan(self.clone());
    }
}
