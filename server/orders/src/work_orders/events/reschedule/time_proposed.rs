//! Proposal of another time by the operator to the firm that has the order.
//!
//! Invariant: the agreed time stands until the firm accepts.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Proposal of another time by the operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeProposed(pub Exchange);

impl Event for RetimeProposed {
    fn apply(&self, state: &mut OrderState) {
        state.offers.propose_retime(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::RETIME_PROPOSED)
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::OFFERED,
            "another time is proposed to you",
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
