//! Addition of a photograph.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::photograph::Photo;

impl Event for Photo {
    fn apply(&self, state: &mut OrderState) {
        state.photos.push(self.clone());
    }
}
