//! Offers of an order to firms, and what these answered: how they stand follows from the
//! log's entries.
//!
//! What always holds: at most one firm has accepted. Whoever is asked has a deadline, and
//! so has the operator whom a firm asks for other terms; nothing said after it counts.

use crate::work_orders::payload::exchange::{Exchange, NamedFirm, Terms};
use crate::work_orders::state::State;
use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How an offer to a firm stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub(crate) enum OfferState {
    /// Its turn has not come.
    Waiting,
    /// The firm is asked.
    Open,
    /// The firm has proposed other terms, and the operator is asked.
    Proposed,
    /// The firm has the order.
    Accepted,
    /// The firm said no, or the operator did to its terms.
    Declined,
    /// There was no answer in time, or no time left to ask.
    Lapsed,
    /// The order is another's, or is cancelled.
    Withdrawn,
}

/// An offer to a firm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = WorkOrderOffer)]
pub(crate) struct Offer {
    /// The firm.
    pub firm_id: FirmId,
    /// Its name when it was offered.
    pub firm_name: String,
    /// How it stands.
    pub state: OfferState,
    /// Until when an answer is waited for.
    #[schema(required)]
    pub answer_by: Option<Time>,
    /// The fee that it was offered, euros, without travel; none where nobody has said on
    /// what terms the firm works.
    #[schema(required)]
    pub fee_eur: Option<f64>,
    /// What the firm proposes, or what was agreed on.
    #[schema(required)]
    pub terms: Option<Terms>,
    /// Another time that the operator asks of the firm that has the order: what was agreed
    /// stands until it says yes.
    #[schema(required)]
    pub new_terms: Option<Terms>,
    /// What was said last, in words.
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
    fn to(&mut self, firm: FirmId) -> Option<&mut Offer> {
        let mut offers = self.all.iter_mut();
        offers.find(|offer| offer.firm_id == firm)
    }

    /// Asks the firm that has the order for another time.
    pub(crate) fn propose_retime(&mut self, said: &Exchange) {
        if let Some(offer) = self.to(said.firm.firm_id) {
            offer.answer_by = said.answer_by;
            offer.new_terms.clone_from(&said.terms);
            offer.text.clone_from(&said.text);
        }
    }

    /// Another time is not waited for any more.
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
    pub(crate) fn set(&mut self, said: &Exchange, state: OfferState) {
        let Some(offer) = self.to(said.firm.firm_id) else {
            return;
        };
        offer.state = state;
        offer.new_terms = None;
        offer.answer_by = said.answer_by;
        offer.terms = said.terms.clone().or(offer.terms.take());
        offer.text = said.text.clone().or(offer.text.take());
    }

    /// Ends a proposal of another time: the agreed terms stand.
    pub(crate) fn keep_agreed_terms(&mut self, said: &Exchange) {
        let agreed = Exchange {
            terms: None,
            ..said.clone()
        };
        self.set(&agreed, OfferState::Accepted);
    }

    /// Takes back what nobody has accepted.
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

    /// How far an order has come that these are the offers of.
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

    /// The offer to a firm.
    pub(crate) fn of(&self, firm: FirmId) -> Option<&Offer> {
        self.all.iter().find(|offer| offer.firm_id == firm)
    }

    /// The firm that has accepted.
    pub(crate) fn holder(&self) -> Option<&Offer> {
        let mut offers = self.all.iter();
        offers.find(|offer| offer.state == OfferState::Accepted)
    }

    /// Those whose turn has not come, if nobody else is waited for.
    pub(crate) fn next(&self) -> impl Iterator<Item = &Offer> {
        let idle = self.state() == State::Declined;
        let most = if self.at_once { usize::MAX } else { 1 };
        let waiting = move |offer: &&Offer| idle && offer.state == OfferState::Waiting;
        self.all.iter().filter(waiting).take(most)
    }

    /// The first deadline of those that run.
    pub(crate) fn answer_by(&self) -> Option<Time> {
        self.all.iter().filter_map(|offer| offer.answer_by).min()
    }
}

impl OfferState {
    /// Returns whether the firm has not been sent the offer yet.
    pub(crate) fn is_waiting(self) -> bool {
        self == OfferState::Waiting
    }

    /// Whether a firm whose offer stands so sees the order.
    pub(crate) fn is_seen(self) -> bool {
        matches!(
            self,
            OfferState::Open | OfferState::Proposed | OfferState::Accepted
        )
    }

    /// Why a firm can answer no more.
    pub(crate) fn reason_closed(self) -> &'static str {
        match self {
            OfferState::Waiting => "it is not offered to your firm yet",
            OfferState::Open => "it is offered to your firm",
            OfferState::Proposed => "the operator has not answered what your firm proposed",
            OfferState::Accepted => "your firm has it already",
            OfferState::Declined => "the offer to your firm was declined",
            OfferState::Lapsed => "the offer to your firm has lapsed",
            OfferState::Withdrawn => "the offer to your firm was withdrawn, or another has it",
        }
    }
}

impl Offer {
    /// The firm as entries name it.
    pub(crate) fn firm(&self) -> NamedFirm {
        NamedFirm {
            firm_id: self.firm_id,
            firm_name: self.firm_name.clone(),
        }
    }

    /// The fee by the terms that it stands at: what was offered holds where nothing else
    /// is said.
    pub(crate) fn fee(&self) -> Option<f64> {
        let said = self.terms.as_ref().and_then(|terms| terms.fee_eur);
        said.or(self.fee_eur)
    }
}
