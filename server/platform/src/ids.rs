//! Ids: UUIDs of version 7, one type for each kind of thing.

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
            /// Creates a new id; later ids sort after earlier ones.
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

id!(OperatorId, "Id of an operator: a company with a fleet.");
id!(FirmId, "Id of a firm: a company that adjusts compasses.");
id!(UserId, "Id of a user: a person who signs in.");
id!(SessionId, "Id of a session.");
id!(TokenId, "Id of an API token.");
id!(VesselId, "Id of a vessel.");
id!(
    CompassId,
    "Id of a compass: one magnetic element on a vessel."
);
id!(AgentId, "Id of an agent installation.");
id!(ModelId, "Id of a version of a compass's model.");
id!(JobId, "Id of a job in the work queue.");
id!(EntryId, "Id of an entry in a vessel's logbook.");
id!(AzimuthId, "Id of an azimuth.");
id!(AlertId, "Id of an alert.");
id!(WebhookId, "Id of a webhook.");
id!(RecipientId, "Id of a mail recipient.");
id!(
    DeliveryId,
    "Id of a message, the same at each delivery attempt."
);
id!(BinnacleId, "Id of a revision of a binnacle.");
id!(OrderId, "Id of a work order.");
id!(PhotoId, "Id of a photograph of a work order.");
id!(CallId, "Id of a port call.");
id!(FleetPriorId, "Id of a publication of a fleet's prior.");
id!(KeyId, "Id of a public key with which a firm signs.");
id!(
    FeedId,
    "Id of a calendar feed, which is read at a secret address."
);
id!(NotificationId, "Id of a notification to a person.");
id!(EventId, "Id of a live event.");
