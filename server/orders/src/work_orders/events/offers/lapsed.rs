//! Lapse of an offer, or of a proposal, without an answer.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Lapse of an offer to a firm, or of the firm's proposal.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Lapsed(pub Exchange);

impl Event for Lapsed {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Lapsed);
        state.follow_offers();
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::LAPSED)
    }

    fn operator_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let firm = &self.0.firm.firm_name;
        let words = match circumstances.offer_before {
            Some(OfferState::Waiting) => format!("{firm} cannot be offered the job in time"),
            Some(OfferState::Proposed) => format!("no answer in time to the terms of {firm}"),
            _ => format!("no answer in time from {firm}"),
        };
        Some(Headline::new(notice_kinds::ANSWER_LATE, words))
    }

    fn firm_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let words = match circumstances.offer_before {
            Some(OfferState::Proposed) => "no answer in time to your terms",
            _ => "you have not answered in time",
        };
        Some(Headline::new(notice_kinds::ANSWER_LATE, words))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
