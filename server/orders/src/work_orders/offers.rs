//! Offers of an order to firms, as they follow from the log's entries.
//!
//! Invariants: at most one firm has accepted. Each open offer or proposal has a deadline; later
//! answers do not count.

use crate::work_orders::payload::exchange::{Exchange, NamedFirm, Terms};
use crate::work_orders::state::State;
use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// State of an offer to a firm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub(crate) enum OfferState {
    /// Not sent yet.
    Waiting,
    /// Sent, without an answer.
    Open,
    /// Answered by a proposal, which awaits the operator's answer.
    Proposed,
    /// Accepted: the firm has the order.
    Accepted,
    /// Declined by the firm, or its terms by the operator.
    Declined,
    /// Without an answer in time, or too late to be sent.
    Lapsed,
    /// Withdrawn: another firm has the order, or it is cancelled.
    Withdrawn,
}

/// Offer to a firm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = WorkOrderOffer)]
pub(crate) struct Offer {
    /// The firm.
    pub firm_id: FirmId,
    /// Its name at the time of the offer.
    pub firm_name: String,
    /// Present state.
    pub state: OfferState,
    /// Deadline for an answer.
    #[schema(required)]
    pub answer_by: Option<Time>,
    /// Offered fee, euros, without travel; `null` if the firm has no terms.
    #[schema(required)]
    pub fee_eur: Option<f64>,
    /// Team of the firm that is to come; `null` if its teams have no names.
    #[schema(required)]
    pub team: Option<String>,
    /// Proposed or agreed terms.
    #[schema(required)]
    pub terms: Option<Terms>,
    /// Another time that the operator proposes to the firm that has the order: the agreed time
    /// stands until the firm accepts.
    #[schema(required)]
    pub new_terms: Option<Terms>,
    /// Last text.
    #[schema(required)]
    pub text: Option<String>,
}

/// All offers of an order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Offers {
    pub all: Vec<Offer>,
    pub answer_within_hours: u32,
    pub at_once: bool,
}

impl Offers {
    fn to_firm_mut(&mut self, firm: FirmId) -> Option<&mut Offer> {
        let mut offers = self.all.iter_mut();
        offers.find(|offer| offer.firm_id == firm)
    }

    /// Records a proposal of another time to the firm that has the order.
    pub(crate) fn propose_retime(&mut self, exchange: &Exchange) {
        if let Some(offer) = self.to_firm_mut(exchange.firm.firm_id) {
            offer.answer_by = exchange.answer_by;
            offer.new_terms.clone_from(&exchange.terms);
            offer.text.clone_from(&exchange.text);
        }
    }

    /// Drops a proposal of another time.
    pub(crate) fn drop_retime(&mut self) {
        for offer in self
            .all
            .iter_mut()
            .filter(|offer| offer.new_terms.is_some())
        {
            (offer.new_terms, offer.answer_by) = (None, None);
        }
    }

    /// Records an answer to the offer to a firm.
    pub(crate) fn set(&mut self, exchange: &Exchange, state: OfferState) {
        let Some(offer) = self.to_firm_mut(exchange.firm.firm_id) else {
            return;
        };
        offer.state = state;
        offer.new_terms = None;
        offer.answer_by = exchange.answer_by;
        offer.team = exchange.team.clone().or(offer.team.take());
        offer.terms = exchange.terms.clone().or(offer.terms.take());
        offer.text = exchange.text.clone().or(offer.text.take());
    }

    /// Ends a proposal of another time: the agreed terms stand.
    pub(crate) fn keep_agreed_terms(&mut self, exchange: &Exchange) {
        let agreed = Exchange {
            terms: None,
            ..exchange.clone()
        };
        self.set(&agreed, OfferState::Accepted);
    }

    /// Withdraws offers that nobody has accepted, unless `stays`.
    pub(crate) fn withdraw_unless(&mut self, stays: impl Fn(OfferState) -> bool) {
        for offer in &mut self.all {
            let open = matches!(
                offer.state,
                OfferState::Waiting | OfferState::Open | OfferState::Proposed
            );
            if open && !stays(offer.state) {
                offer.state = OfferState::Withdrawn;
                offer.answer_by = None;
            }
        }
    }

    /// State of an order with these offers.
    pub(crate) fn state(&self) -> State {
        let any = |state| self.all.iter().any(|offer| offer.state == state);
        if any(OfferState::Accepted) {
            State::Accepted
        } else if any(OfferState::Proposed) {
            State::Proposed
        } else if any(OfferState::Open) {
            State::Offered
        } else {
            State::Declined
        }
    }

    /// Returns the offer to a firm.
    pub(crate) fn to_firm(&self, firm: FirmId) -> Option<&Offer> {
        self.all.iter().find(|offer| offer.firm_id == firm)
    }

    /// Returns the accepted offer.
    pub(crate) fn holder(&self) -> Option<&Offer> {
        let mut offers = self.all.iter();
        offers.find(|offer| offer.state == OfferState::Accepted)
    }

    /// Returns the offers to send next; none while another is open.
    pub(crate) fn next(&self) -> impl Iterator<Item = &Offer> {
        let idle = self.state() == State::Declined;
        let most = if self.at_once { usize::MAX } else { 1 };
        let waiting = move |offer: &&Offer| idle && offer.state == OfferState::Waiting;
        self.all.iter().filter(waiting).take(most)
    }

    /// Returns the first running deadline.
    pub(crate) fn answer_by(&self) -> Option<Time> {
        self.all.iter().filter_map(|offer| offer.answer_by).min()
    }
}

impl OfferState {
    /// Returns whether the firm has not been sent the offer yet.
    pub(crate) fn is_waiting(self) -> bool {
        self == OfferState::Waiting
    }

    /// Returns whether the firm of such an offer sees the order.
    pub(crate) fn is_seen(self) -> bool {
        matches!(
            self,
            OfferState::Open | OfferState::Proposed | OfferState::Accepted
        )
    }

    /// Reason for which a firm can no longer answer.
    pub(crate) fn reason_closed(self) -> &'static str {
        match self {
            OfferState::Waiting => "it is not offered to your firm yet",
            OfferState::Open => "it is offered to your firm",
            OfferState::Proposed => "the operator has not answered your firm's proposal",
            OfferState::Accepted => "your firm has it already",
            OfferState::Declined => "the offer to your firm was declined",
            OfferState::Lapsed => "the offer to your firm has lapsed",
            OfferState::Withdrawn => "the offer to your firm was withdrawn, or another has it",
        }
    }
}

impl Offer {
    /// Firm, as entries name it.
    pub(crate) fn firm(&self) -> NamedFirm {
        NamedFirm {
            firm_id: self.firm_id,
            firm_name: self.firm_name.clone(),
        }
    }

    /// Fee by the present terms; the offered fee if they name none.
    pub(crate) fn fee(&self) -> Option<f64> {
        let exchange = self.terms.as_ref().and_then(|terms| terms.fee_eur);
        exchange.or(self.fee_eur)
    }
}
