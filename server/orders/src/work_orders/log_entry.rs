//! The log of an order: what happened, each entry chained to the one before.
//!
//! What always holds: an entry is one line of JSON with its keys in order and no blanks,
//! and is kept as that text; its hash is the SHA-256 of the text, and the next entry
//! names it. So a log can be checked with nothing but SHA-256.

use crate::berth_session::berth_reading::RecordedReading;
use crate::berth_session::photos::Photo;
use crate::berth_session::plan::ChosenPlan;
use crate::berth_session::second_reading_api::RecordedSecondReading;
use crate::berth_session::steps::{CorrectorMove, RecordedStep};
use crate::completion::complete::{Completion, RecordedSignature};
use crate::dispatch::offer_requests::Boarding;
use crate::dispatch::port_call_changes::CallMoved;
use crate::verification::SeaVerification;
use crate::work_orders::offer_state::{Exchange, OfferRound};
use crate::work_orders::order::Opened;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{FirmId, OrderId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use uuid::Uuid;

/// An entry of an order's log.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    /// Of this form: 1.
    pub version: u32,
    /// The order.
    pub order: OrderId,
    /// Counts from 1.
    pub seq: i64,
    /// The entry's id.
    pub id: Uuid,
    /// SHA-256 of the line before; none for the first.
    pub previous_sha256: Option<String>,
    /// When it was written.
    pub at: Time,
    /// Who wrote it.
    pub author: Author,
    /// What happened.
    #[serde(flatten)]
    pub content: OrderEvent,
}

/// Who wrote an entry.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Author {
    /// Their id; none for the server itself.
    pub id: Option<Uuid>,
    /// Their name.
    pub name: String,
    /// The firm that they are of; none for the operator's people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub firm_id: Option<FirmId>,
}

impl Author {
    /// The server itself.
    pub fn server() -> Author {
        Author {
            id: None,
            name: "Binnacle".to_owned(),
            firm_id: None,
        }
    }
}

/// What happened to an order.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(tag = "kind", content = "content", rename_all = "snake_case")]
pub enum OrderEvent {
    /// The order was written.
    Opened(Box<Opened>),
    /// It is to be offered to firms.
    OfferRound(OfferRound),
    /// A firm is asked.
    OfferSent(Exchange),
    /// A firm takes it as it was offered.
    Accepted(Exchange),
    /// A firm will not have it, or gives it back.
    Declined(Exchange),
    /// A firm would have it on other terms.
    Proposed(Exchange),
    /// The operator agrees to a firm's terms.
    ProposalAccepted(Exchange),
    /// The operator does not.
    ProposalDeclined(Exchange),
    /// There was no answer in time.
    Lapsed(Exchange),
    /// The operator asks the firm that has it for another time.
    RetimeProposed(Exchange),
    /// The firm agrees.
    RetimeAccepted(Exchange),
    /// The firm does not, or the operator thinks better of it.
    RetimeDeclined(Exchange),
    /// The firm did not answer in time: what was agreed stands.
    RetimeLapsed(Exchange),
    /// The port call at which it is to be done has moved, or is withdrawn.
    CallMoved(Box<CallMoved>),
    /// A message between the operator and a firm.
    Message(Exchange),
    /// The adjuster is on board.
    OnBoard(Boarding),
    /// The magnetometer was read at the berth.
    BerthReading(Box<RecordedReading>),
    /// A plan was chosen.
    Plan(Box<ChosenPlan>),
    /// A step was done, and the compass read.
    Step(Box<RecordedStep>),
    /// The magnetometer was read once more, after the steps.
    SecondReading(Box<RecordedSecondReading>),
    /// How the correctors stand, as they were found.
    CorrectorSettings(Box<CorrectorMove>),
    /// A photograph.
    Photo(Photo),
    /// Something said.
    Remark(Said),
    /// The adjuster has finished and signed.
    Completion(Box<Completion>),
    /// The firm's key signed the record.
    Signature(RecordedSignature),
    /// Headings at sea were held against the prediction.
    Verification(Box<SeaVerification>),
    /// It is done with.
    Closed(Said),
    /// It is not to be done, or no further.
    Cancelled(Said),
}

/// Something said.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Said {
    /// In words.
    pub text: String,
}

impl OrderEvent {
    /// What is between the operator and one firm, if it is that.
    pub fn between(&self) -> Option<&Exchange> {
        match self {
            OrderEvent::OfferSent(said)
            | OrderEvent::Accepted(said)
            | OrderEvent::Declined(said)
            | OrderEvent::Proposed(said)
            | OrderEvent::ProposalAccepted(said)
            | OrderEvent::ProposalDeclined(said)
            | OrderEvent::Lapsed(said)
            | OrderEvent::RetimeProposed(said)
            | OrderEvent::RetimeAccepted(said)
            | OrderEvent::RetimeDeclined(said)
            | OrderEvent::RetimeLapsed(said)
            | OrderEvent::Message(said) => Some(said),
            OrderEvent::CallMoved(moved) => Some(&moved.said),
            _ => None,
        }
    }

    /// Whether a firm may know of it, whose order it is.
    pub fn is_seen_by(&self, firm: FirmId) -> bool {
        let others = matches!(self, OrderEvent::OfferRound(_));
        !others && self.between().is_none_or(|said| said.firm.firm_id == firm)
    }

    /// Whether offers may stand otherwise after it.
    pub fn is_about_offers(&self) -> bool {
        let said = self.between().is_some()
            && !matches!(self, OrderEvent::Message(_) | OrderEvent::CallMoved(_));
        let ends = matches!(self, OrderEvent::OnBoard(_) | OrderEvent::Cancelled(_));
        said || ends || matches!(self, OrderEvent::OfferRound(_))
    }
}

/// A value as canonical JSON: keys in order, no blanks.
///
/// # Errors
/// When it cannot be written as JSON.
pub fn canonical(value: &impl Serialize) -> Result<String> {
    // serde_json's map is sorted; a test below holds it to that.
    Ok(serde_json::to_string(&serde_json::to_value(value)?)?)
}

/// SHA-256 as hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(64);
    for byte in Sha256::digest(bytes) {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn canonical_json_has_its_keys_in_order() {
        let value = json!({ "b": 1, "a": { "d": [1.5], "c": null } });
        assert_eq!(
            canonical(&value).unwrap(),
            r#"{"a":{"c":null,"d":[1.5]},"b":1}"#
        );
    }

    #[test]
    fn a_hash_is_that_of_the_standard() {
        // FIPS 180-4, example B.1.
        assert_eq!(
            sha256_hex(b"abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
