//! Message of the test button.

use super::format::Words;
use super::kinds::{Audience, DeclaredKind};
use crate::error::Result;
use crate::ids::DeliveryId;
use crate::outbox::{Kind, Message};
use crate::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Kind of the message of the test button.
pub const TEST: DeclaredKind = DeclaredKind::new(
    Kind::TEST,
    Audience::Nobody,
    "A user asked for a test message.",
);

/// Message of the test button.
#[derive(Serialize, ToSchema)]
pub struct TestMessage {
    /// Id of the message: the same in each attempt.
    pub id: DeliveryId,
    /// Kind.
    pub kind: Kind,
    /// Time of the event.
    pub at: Time,
    /// The message in words.
    pub words: Words,
}

impl TestMessage {
    /// Creates a message.
    pub(super) fn new(at: Time) -> TestMessage {
        TestMessage {
            id: DeliveryId::new(),
            kind: Kind::TEST,
            at,
            words: Words {
                headline: "Test".to_owned(),
                text: "A test message of Binnacle: this webhook works.".to_owned(),
                path: "/webhooks".to_owned(),
            },
        }
    }

    /// Returns the message as it is queued.
    pub(super) fn queued(&self) -> Result<Message> {
        Ok(Message {
            id: self.id,
            kind: self.kind,
            about: None,
            body: serde_json::to_string(self)?,
        })
    }
}
