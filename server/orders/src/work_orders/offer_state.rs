//! Offers of an order to firms, and what these answered: how they stand follows from the
//! log's entries.
//!
//! What always holds: at most one firm has accepted. Whoever is asked has a deadline, and
//! so has the operator whom a firm asks for other terms; nothing said after it counts.

use crate::work_orders::log_entry::OrderEvent;
use crate::work_orders::order::State;
use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The firms that an order is offered to, in the order in which they are asked.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OfferRound {
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
pub struct OfferedFirm {
    /// The firm.
    #[serde(flatten)]
    pub firm: NamedFirm,
    /// The fee that it is offered, euros; none where nobody has said on what terms it works.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fee_eur: Option<f64>,
}

/// A firm, by its name then.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedFirm {
    /// Its id.
    pub firm_id: FirmId,
    /// Its name.
    pub firm_name: String,
}

/// What is said between the operator and one firm: nobody else's business.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Exchange {
    /// The firm, whoever of the two speaks.
    #[serde(flatten)]
    pub firm: NamedFirm,
    /// Until when an answer is waited for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer_by: Option<Time>,
    /// The fee that is offered, or at which it is taken as it was offered, euros.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fee_eur: Option<f64>,
    /// What is proposed, or agreed on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terms: Option<Terms>,
    /// Who will come.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjuster_name: Option<String>,
    /// The number of their licence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjuster_licence: Option<String>,
    /// In words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Other terms than were offered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = WorkOrderTerms, example = json!({
    "planned_at": "2026-11-22T13:00:00Z", "berth": "A7", "fee_eur": 900.0
}))]
pub struct Terms {
    /// When it is to be done.
    pub planned_at: Time,
    /// The berth, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// The fee, euros.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Option<f64>,
}

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
    /// Goes on by an entry.
    pub(crate) fn take(&mut self, content: &OrderEvent) {
        match content {
            OrderEvent::OfferRound(offered) => self.begin(offered),
            OrderEvent::OfferSent(said) => self.set(said, OfferState::Open),
            OrderEvent::Accepted(said) | OrderEvent::ProposalAccepted(said) => {
                self.set(said, OfferState::Accepted);
                self.withdraw_unless(|state| state == OfferState::Waiting);
            }
            OrderEvent::Declined(said) | OrderEvent::ProposalDeclined(said) => {
                self.set(said, OfferState::Declined);
            }
            OrderEvent::Proposed(said) => self.set(said, OfferState::Proposed),
            OrderEvent::Lapsed(said) => self.set(said, OfferState::Lapsed),
            OrderEvent::RetimeProposed(said) => self.propose_retime_to(said),
            OrderEvent::RetimeAccepted(said) => self.set(said, OfferState::Accepted),
            OrderEvent::RetimeDeclined(said) | OrderEvent::RetimeLapsed(said) => {
                // What was agreed stands.
                let agreed = Exchange {
                    terms: None,
                    ..said.clone()
                };
                self.set(&agreed, OfferState::Accepted);
            }
            OrderEvent::OnBoard(_) => self.drop_retime(),
            OrderEvent::Cancelled(_) => {
                self.drop_retime();
                self.withdraw_unless(|_| false);
            }
            _ => {}
        }
    }

    fn begin(&mut self, offered: &OfferRound) {
        self.answer_within_hours = offered.answer_within_hours;
        self.at_once = offered.at_once;
        // Firms of an earlier round stay known: they see that it is over.
        let asked = |offer: &Offer| {
            let mut firms = offered.firms.iter();
            firms.any(|one| one.firm.firm_id == offer.firm_id)
        };
        self.all.retain(|offer| !asked(offer));
        let waiting = offered.firms.iter().map(|one| Offer {
            firm_id: one.firm.firm_id,
            firm_name: one.firm.firm_name.clone(),
            state: OfferState::Waiting,
            answer_by: None,
            fee_eur: one.fee_eur,
            terms: None,
            new_terms: None,
            text: offered.text.clone(),
        });
        self.all.extend(waiting);
    }

    fn to(&mut self, firm: FirmId) -> Option<&mut Offer> {
        let mut offers = self.all.iter_mut();
        offers.find(|offer| offer.firm_id == firm)
    }

    /// Asks the firm that has the order for another time.
    fn propose_retime_to(&mut self, said: &Exchange) {
        if let Some(offer) = self.to(said.firm.firm_id) {
            offer.answer_by = said.answer_by;
            offer.new_terms.clone_from(&said.terms);
            offer.text.clone_from(&said.text);
        }
    }

    /// Another time is not waited for any more.
    fn drop_retime(&mut self) {
        for offer in self
            .all
            .iter_mut()
            .filter(|offer| offer.new_terms.is_some())
        {
            (offer.new_terms, offer.answer_by) = (None, None);
        }
    }

    fn set(&mut self, said: &Exchange, state: OfferState) {
        let Some(offer) = self.to(said.firm.firm_id) else {
            return;
        };
        offer.state = state;
        offer.new_terms = None;
        offer.answer_by = said.answer_by;
        offer.terms = said.terms.clone().or(offer.terms.take());
        offer.text = said.text.clone().or(offer.text.take());
    }

    /// Takes back what nobody has accepted.
    fn withdraw_unless(&mut self, stays: impl Fn(OfferState) -> bool) {
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

impl Exchange {
    /// Nothing said yet.
    pub(crate) fn with(firm: NamedFirm) -> Exchange {
        Exchange {
            firm,
            answer_by: None,
            fee_eur: None,
            terms: None,
            adjuster_name: None,
            adjuster_licence: None,
            text: None,
        }
    }
}
