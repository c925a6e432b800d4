//! Refusal of a firm's terms by the operator.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Refusal of a firm's terms by the operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct ProposalDeclined(pub Exchange);

impl Event for ProposalDeclined {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Declined);
        state.follow_offers();
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::ANSWERED)
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::ANSWERED,
            "your terms are declined",
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
