//! Events that change what a dashboard shows.
//!
//! Invariants: an event is stored in the transaction that makes it true, and reaches the
//! dashboards of this process directly once it is committed, and those of other processes on
//! the same PostgreSQL through LISTEN and NOTIFY.

mod announcer;
mod kind;
mod live;
mod places;
mod store;

pub use announcer::{Announcer, announce_all};
pub use kind::Kind;
pub use live::Live;
pub use places::{Place, Places, STREAMS_OF_USER};
pub(crate) use store::{CHANNEL, all_since, since};
pub use store::{NewEvent, insert, insert_event, insert_of, prune};

use crate::db::DomainEvent;
use crate::ids::{EventId, FirmId, OperatorId, VesselId};
use crate::tenants::Tenant;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Event, with the tenants that may receive it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, sqlx::FromRow)]
pub struct Event {
    /// Id, from which a dashboard resumes.
    pub id: EventId,
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// Firm that receives the event; none if the operator does.
    pub firm_id: Option<FirmId>,
    /// Id of what the event is about, if that is a single thing of the vessel.
    #[serde(rename = "order_id")]
    #[sqlx(rename = "order_id")]
    pub about: Option<Uuid>,
    /// The vessel concerned.
    pub vessel_id: VesselId,
    /// Kind of event.
    #[sqlx(try_from = "String")]
    pub kind: Kind,
}

/// A live event was stored, in the transaction that makes it true.
pub struct EventStored {
    /// The event.
    pub event: Event,
    /// Time of the event.
    pub at: Time,
}

impl DomainEvent for EventStored {}

impl Event {
    /// Returns true if a dashboard learns the same from the other event.
    pub(crate) fn is_about_the_same(&self, other: &Event) -> bool {
        let other = Event {
            id: self.id,
            ..other.clone()
        };
        *self == other
    }

    /// Checks whether a tenant receives the event.
    pub(crate) fn is_for(&self, tenant: Tenant) -> bool {
        match tenant {
            Tenant::Operator(operator) => self.operator_id == operator && self.firm_id.is_none(),
            Tenant::Firm(firm) => self.firm_id == Some(firm),
        }
    }
}
