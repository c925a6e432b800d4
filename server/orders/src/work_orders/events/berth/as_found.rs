//! Correctors and compass as found.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::as_found::AsFound;

impl Event for AsFound {
    fn apply(&self, state: &mut OrderState) {
        let as_read = state.binnacle.as_ref().map(|binnacle| &binnacle.setting);
        if as_read.is_some_and(|setting| *setting != self.setting) {
            state.drop_reading();
        }
        state.as_found = Some(self.clone());
    }
}
