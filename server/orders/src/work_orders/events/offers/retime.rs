//! Proposal of another time to the firm that has the order, and its answer.
//!
//! Invariant: the agreed time stands until the firm accepts.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::summary::Summary;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Proposal of another time by the operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeProposed(pub Exchange);

/// Acceptance of another time by the firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeAccepted(pub Exchange);

/// Refusal of another time by the firm, or withdrawal by the operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeDeclined(pub Exchange);

/// Lapse of the proposal of another time without an answer.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeLapsed(pub Exchange);

impl Event for RetimeProposed {
    fn apply(&self, state: &mut OrderState) {
        state.offers.propose_retime(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::RETIME_PROPOSED)
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::OFFERED,
            "another time is proposed to you",
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}

impl Event for RetimeAccepted {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Accepted);
        if let Some(terms) = &self.0.terms {
            state.agree_time(terms.planned_at);
        }
    }

    fn update_summary(&self, summary: &mut Summary) {
        summary.apply_terms(&self.0);
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
            format!("{firm} agrees to another time"),
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}

impl Event for RetimeDeclined {
    fn apply(&self, state: &mut OrderState) {
        state.offers.keep_agreed_terms(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::ANSWERED)
    }

    fn operator_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let words = format!("{} does not agree to another time", self.0.firm.firm_name);
        circumstances
            .by_firm
            .then(|| Headline::new(notice_kinds::ANSWERED, words))
    }

    fn firm_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let words = "the proposal of another time is withdrawn";
        (!circumstances.by_firm).then(|| Headline::new(notice_kinds::ANSWERED, words))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}

impl Event for RetimeLapsed {
    fn apply(&self, state: &mut OrderState) {
        state.offers.keep_agreed_terms(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::LAPSED)
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        let firm = &self.0.firm.firm_name;
        let words = format!("no answer in time from {firm} to another time");
        Some(Headline::new(notice_kinds::ANSWER_LATE, words))
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        let words = "you have not answered in time to another time";
        Some(Headline::new(notice_kinds::ANSWER_LATE, words))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
