//! Proposal of other terms by a firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Proposal of other terms by a firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Proposed(pub Exchange);

impl Event for Proposed {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Proposed);
        state.follow_offers();
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::ANSWERED)
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        let firm = &self.0.firm.firm_name;
        Some(Headline::new(
            notice_kinds::ANSWERED,
            format!("{firm} proposes other terms"),
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
