//! Ids: UUIDs of version 7, a type for each thing they name.

use serde::{Deserialize, Serialize};
use std::fmt;
use utoipa::ToSchema;
use uuid::Uuid;

macro_rules! id {
    ($name:ident, $doc:literal) => {
        #[doc = $doc]
        #[derive(
            Clone,
            Copy,
            Debug,
            PartialEq,
            Eq,
            Hash,
            PartialOrd,
            Ord,
            Serialize,
            Deserialize,
            sqlx::Type,
            ToSchema,
        )]
        #[serde(transparent)]
        #[sqlx(transparent)]
        pub struct $name(pub Uuid);

        impl $name {
            /// A new one; later ones sort after earlier ones.
            pub fn new() -> Self {
                Self(Uuid::now_v7())
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self::new()
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

id!(OperatorId, "A company with a fleet.");
id!(FirmId, "A company that adjusts compasses.");
id!(UserId, "A person who signs in.");
id!(SessionId, "A time that a person is signed in for.");
id!(TokenId, "An API token.");
id!(VesselId, "A ship.");
id!(CompassId, "A magnetic element aboard.");
id!(AgentId, "An installation of the agent.");
id!(ModelId, "A version of a compass's model.");
id!(JobId, "A piece of work in the queue.");
id!(EntryId, "An entry of a vessel's logbook.");
id!(AlertId, "Something that people must know of.");
id!(WebhookId, "Where an operator's programs want to be told.");
id!(RecipientId, "Someone who gets mail.");
id!(DeliveryId, "What a receiver is told: the id of the event.");
id!(BinnacleId, "A revision of a binnacle.");
id!(OrderId, "An order to adjust a compass.");
id!(PhotoId, "A photograph in an order.");
id!(CallId, "A vessel's call at a port.");
id!(KeyId, "A public key that a firm signs with.");
id!(FeedId, "A calendar that is read by its secret address.");
id!(NotificationId, "Something that a person is told.");
id!(EventId, "Something a dashboard is told.");
