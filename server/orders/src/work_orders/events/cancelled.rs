//! Cancellation of an order.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::state::State;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Cancellation of an order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Cancelled {
    /// Reason.
    pub text: String,
}

impl Event for Cancelled {
    fn apply(&self, state: &mut OrderState) {
        state.offers.drop_retime();
        state.offers.withdraw_unless(|_| false);
        state.state = State::Cancelled;
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::CANCELLED)
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::WITHDRAWN,
            "the job is cancelled",
        ))
    }

    fn quote(&self, _port: &str) -> Option<String> {
        Some(self.text.clone())
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
