//! Completion of the adjustment, signed by the adjuster.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::signed_record::Completion;
use crate::work_orders::state::State;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;

impl Event for Completion {
    fn apply(&self, state: &mut OrderState) {
        state.completion = Some(self.clone());
        state.state = State::Adjusted;
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::COMPLETED)
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::COMPLETED,
            "adjusted and signed",
        ))
    }
}
