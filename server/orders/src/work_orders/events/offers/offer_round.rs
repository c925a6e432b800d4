//! Choice of the firms that are offered an order.

use crate::work_orders::events::event::{Audience, Event};
use crate::work_orders::offers::{Offer, OfferState};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::NamedFirm;
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Firms that an order is offered to, in the order of the offers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct OfferRound {
    /// The firms.
    pub firms: Vec<OfferedFirm>,
    /// Hours for an answer.
    pub answer_within_hours: u32,
    /// True if all receive the offer at once.
    pub at_once: bool,
    /// Text for the firms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Firm that is offered the order, with its fee.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct OfferedFirm {
    /// The firm.
    #[serde(flatten)]
    pub firm: NamedFirm,
    /// Offered fee, euros; `None` if the firm has no terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fee_eur: Option<f64>,
    /// Team that is to come; `None` if the firm's teams have no names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<String>,
}

impl Event for OfferRound {
    fn apply(&self, state: &mut OrderState) {
        let offers = &mut state.offers;
        offers.answer_within_hours = self.answer_within_hours;
        offers.at_once = self.at_once;
        // Firms of an earlier round stay listed: they see that it is over.
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
            team: one.team.clone(),
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
