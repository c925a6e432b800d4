//! Closing of an order.

use crate::work_orders::events::event::Event;
use crate::work_orders::message_kinds;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::state::State;
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Closing of an order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Closed {
    /// Reason.
    pub text: String,
}

impl Event for Closed {
    fn apply(&self, state: &mut OrderState) {
        state.state = match state.state {
            State::Adjusted => State::ClosedUnverified,
            _ => State::Closed,
        };
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::CLOSED)
    }
}
