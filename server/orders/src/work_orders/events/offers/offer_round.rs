//! Choice of the firms that are offered an order.

use crate::work_orders::events::event::{Audience, Event};
use crate::work_orders::offers::{Offer, OfferState};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::NamedFirm;
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// The firms that an order is offered to, in the order in which they are asked.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct OfferRound {
    /// The firms.
    pub firms: Vec<OfferedFirm>,
    /// So long they have for an answer.
    pub answer_within_hours: u32,
    /// Whether all are asked at once.
    pub at_once: bool,
    /// What is said to them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// A firm that is to be asked, and for how much.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct OfferedFirm {
    /// The firm.
    #[serde(flatten)]
    pub firm: NamedFirm,
    /// The fee that it is offered, euros; none where nobody has said on what terms it works.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fee_eur: Option<f64>,
}

impl Event for OfferRound {
    fn apply(&self, state: &mut OrderState) {
        let offers = &mut state.offers;
        offers.answer_within_hours = self.answer_within_hours;
        offers.at_once = self.at_once;
        // Firms of an earlier round stay known: they see that it is over.
        let is_offered_again = |offer: &Offer| {
            let mut firms = self.firms.iter();
            firms.any(|one| one.firm.firm_id == offer.firm_id)
        };
        offers.all.retain(|offer| !is_offered_again(offer));
        let waiting = self.firms.iter().map(|one| Offer {
            firm_id: one.firm.firm_id,
            firm_name: one.firm.firm_name.clone(),
            state: OfferState::Waiting,
            answer_by: None,
            fee_eur: one.fee_eur,
            terms: None,
            new_terms: None,
            text: self.text.clone(),
        });
        offers.all.extend(waiting);
        state.follow_offers();
    }

    fn audience(&self) -> Audience {
        Audience::Operator
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        None
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
