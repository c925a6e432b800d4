//! Events of a work order: one file for each, with its state change, words and audience.
//!
//! Invariant: the stored names of events never change, because the log is kept as text.

mod berth;
mod cancelled;
mod closed;
mod completion;
mod event;
mod offers;
mod opened;
mod remark;
mod reschedule;
mod signature;
mod verification;

pub(crate) use berth::{CorrectorMove, RecordedStep, RevisedStrength};
pub(crate) use cancelled::Cancelled;
pub(crate) use closed::Closed;
pub(crate) use event::{Audience, Circumstances, Event, Headline};
pub(crate) use offers::{
    Accepted, Boarding, CallMoved, Declined, Lapsed, MessageSent, OfferRound, OfferSent,
    OfferedFirm, ProposalAccepted, ProposalDeclined, Proposed,
};
pub(crate) use opened::Opened;
pub(crate) use remark::Remark;
pub(crate) use reschedule::{RetimeAccepted, RetimeDeclined, RetimeLapsed, RetimeProposed};

use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::as_found::AsFound;
use crate::work_orders::payload::chosen_plan::ChosenPlan;
use crate::work_orders::payload::photograph::Photo;
use crate::work_orders::payload::recorded_reading::RecordedReading;
use crate::work_orders::payload::recorded_second_reading::RecordedSecondReading;
use crate::work_orders::payload::sea_verification::SeaVerification;
use crate::work_orders::payload::signed_record::{Completion, RecordedSignature};
use serde::{Deserialize, Serialize};

/// Event of a work order.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(tag = "kind", content = "content", rename_all = "snake_case")]
pub(crate) enum OrderEvent {
    /// The order was created.
    Opened(Box<Opened>),
    /// Firms were chosen to be offered the order.
    #[serde(rename = "offered")]
    OfferRound(OfferRound),
    /// An offer was sent to a firm.
    #[serde(rename = "asked")]
    OfferSent(OfferSent),
    /// A firm accepted its offer.
    Accepted(Accepted),
    /// A firm declined its offer, or gave the order back.
    Declined(Declined),
    /// A firm proposed other terms.
    Proposed(Proposed),
    /// The operator accepted a firm's terms.
    ProposalAccepted(ProposalAccepted),
    /// The operator declined a firm's terms.
    ProposalDeclined(ProposalDeclined),
    /// An offer or a proposal lapsed without an answer.
    Lapsed(Lapsed),
    /// The operator proposed another time to the firm that has the order.
    RetimeProposed(RetimeProposed),
    /// The firm agreed to another time.
    RetimeAccepted(RetimeAccepted),
    /// The firm declined another time, or the operator withdrew the proposal.
    RetimeDeclined(RetimeDeclined),
    /// The firm did not answer in time: the agreed time stands.
    RetimeLapsed(RetimeLapsed),
    /// The order's port call moved, or was withdrawn.
    CallMoved(Box<CallMoved>),
    /// A message passed between the operator and a firm.
    Message(MessageSent),
    /// The adjuster went on board.
    OnBoard(Boarding),
    /// The correctors were reported as found.
    AsFound(Box<AsFound>),
    /// The magnetometer was read at the berth.
    BerthReading(Box<RecordedReading>),
    /// A plan was chosen.
    Plan(Box<ChosenPlan>),
    /// A step was done, and the compass read.
    Step(Box<RecordedStep>),
    /// The magnetometer was read again, after the steps.
    SecondReading(Box<RecordedSecondReading>),
    /// The settings of the correctors were reported.
    CorrectorSettings(Box<CorrectorMove>),
    /// A photograph was added.
    Photo(Photo),
    /// A remark was made.
    Remark(Remark),
    /// The adjuster completed and signed the adjustment.
    Completion(Box<Completion>),
    /// A firm's key signed the record.
    Signature(RecordedSignature),
    /// Headings at sea were compared with the prediction.
    Verification(Box<SeaVerification>),
    /// The order was closed.
    Closed(Closed),
    /// The order was cancelled.
    Cancelled(Cancelled),
}

impl OrderEvent {
    /// Returns the event as its own file defines it.
    pub(crate) fn event(&self) -> &dyn Event {
        match self {
            OrderEvent::Opened(event) => event.as_ref(),
            OrderEvent::OfferRound(event) => event,
            OrderEvent::OfferSent(event) => event,
            OrderEvent::Accepted(event) => event,
            OrderEvent::Declined(event) => event,
            OrderEvent::Proposed(event) => event,
            OrderEvent::ProposalAccepted(event) => event,
            OrderEvent::ProposalDeclined(event) => event,
            OrderEvent::Lapsed(event) => event,
            OrderEvent::RetimeProposed(event) => event,
            OrderEvent::RetimeAccepted(event) => event,
            OrderEvent::RetimeDeclined(event) => event,
            OrderEvent::RetimeLapsed(event) => event,
            OrderEvent::CallMoved(event) => event.as_ref(),
            OrderEvent::Message(event) => event,
            OrderEvent::OnBoard(event) => event,
            OrderEvent::AsFound(event) => event.as_ref(),
            OrderEvent::BerthReading(event) => event.as_ref(),
            OrderEvent::Plan(event) => event.as_ref(),
            OrderEvent::Step(event) => event.as_ref(),
            OrderEvent::SecondReading(event) => event.as_ref(),
            OrderEvent::CorrectorSettings(event) => event.as_ref(),
            OrderEvent::Photo(event) => event,
            OrderEvent::Remark(event) => event,
            OrderEvent::Completion(event) => event.as_ref(),
            OrderEvent::Signature(event) => event,
            OrderEvent::Verification(event) => event.as_ref(),
            OrderEvent::Closed(event) => event,
            OrderEvent::Cancelled(event) => event,
        }
    }
}

/// Returns the state of an order after these events.
pub(crate) fn replay<'a>(log: impl Iterator<Item = &'a OrderEvent>) -> OrderState {
    let mut state = OrderState::default();
    for entry in log {
        entry.event().apply(&mut state);
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const FIRM: &str = "0199aa00-0000-7000-8000-000000000003";

    #[test]
    fn an_event_is_stored_as_it_was_read() {
        let exchange = json!({ "firm_id": FIRM, "firm_name": "Rosa", "fee_eur": 900.0 });
        let text = json!({ "text": "Crane alongside." });
        let kinds = [
            "asked",
            "accepted",
            "declined",
            "proposed",
            "proposal_accepted",
            "proposal_declined",
            "lapsed",
            "retime_proposed",
            "retime_accepted",
            "retime_declined",
            "retime_lapsed",
            "message",
        ];
        let exchanges = kinds.map(|kind| (kind, exchange.clone()));
        let texts = ["remark", "closed", "cancelled"].map(|kind| (kind, text.clone()));
        let round = json!({
            "firms": [exchange], "answer_within_hours": 48, "at_once": false,
        });
        for (kind, content) in exchanges
            .into_iter()
            .chain(texts)
            .chain([("offered", round)])
        {
            let stored = json!({ "kind": kind, "content": content });
            let event: OrderEvent = serde_json::from_value(stored.clone()).unwrap();
            assert_eq!(serde_json::to_value(&event).unwrap(), stored);
        }
    }

    #[test]
    fn an_exchange_is_for_the_operator_and_its_firm_alone() {
        let content = json!({ "firm_id": FIRM, "firm_name": "Rosa" });
        let accepted = json!({ "kind": "accepted", "content": content });
        let event: OrderEvent = serde_json::from_value(accepted).unwrap();
        let exchange = event.event().exchange().unwrap();
        let audience = event.event().audience();
        assert!(audience.includes(exchange.firm.firm_id));
        assert!(!audience.includes(binnacle_platform::ids::FirmId::new()));
    }
}
