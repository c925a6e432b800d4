//! Offer sent to a firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Offer of the order to a firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct OfferSent(pub Exchange);

impl Event for OfferSent {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Open);
        state.follow_offers();
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::OFFERED)
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::OFFERED,
            "a job is offered to you",
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
