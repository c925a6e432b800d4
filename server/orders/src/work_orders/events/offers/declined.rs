//! Refusal of an offer, or return of the order, by a firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Refusal of an offer, or return of an accepted order, by a firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Declined(pub Exchange);

impl Event for Declined {
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

    fn operator_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        if !circumstances.by_firm {
            return None;
        }
        let firm = &self.0.firm.firm_name;
        let words = match circumstances.offer_before {
            Some(OfferState::Accepted) => format!("{firm} gives the job back"),
            _ => format!("{firm} declines the job"),
        };
        Some(Headline::new(notice_kinds::ANSWERED, words))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
