//! Signature over the record by a firm's key.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::signed_record::RecordedSignature;

impl Event for RecordedSignature {
    fn apply(&self, state: &mut OrderState) {
        state.signatures.push(self.clone());
    }
}
