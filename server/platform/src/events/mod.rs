//! Events that change what a dashboard shows.
//!
//! Invariants: an event is stored in the transaction that makes it true, and reaches the
//! dashboards of every server process on the same database: on PostgreSQL through LISTEN
//! and NOTIFY, on SQLite (one process) directly.

mod live;
mod store;

pub use live::Live;
pub(crate) use store::{CHANNEL, all_since, since};
pub use store::{insert, insert_of_order, prune};

use crate::db::DomainEvent;
use crate::ids::{EventId, FirmId, OperatorId, OrderId, VesselId};
use crate::tenants::Tenant;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Kind of change to a vessel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = EventKind)]
pub enum Kind {
    /// A batch was received.
    Batch,
    /// A compass has a new model.
    Model,
    /// Something was reported, amended or withdrawn.
    Logbook,
    /// An alert was raised, updated, acknowledged or cleared.
    Alert,
    /// A work order has changed.
    WorkOrder,
    /// A port call was entered, amended or withdrawn.
    PortCall,
    /// The schedule of the vessel has changed.
    Schedule,
    /// A compass needs adjustment soon, or sooner than before.
    Need,
}

/// Event, with the tenants that may receive it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, sqlx::FromRow)]
pub struct Event {
    /// Id, from which a dashboard resumes.
    pub id: EventId,
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// Firm that receives the event; none if the operator does.
    pub firm_id: Option<FirmId>,
    /// Work order concerned, if any.
    pub order_id: Option<OrderId>,
    /// The vessel concerned.
    pub vessel_id: VesselId,
    /// Kind of event.
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
    /// Checks whether a tenant receives the event.
    pub(crate) fn is_for(&self, tenant: Tenant) -> bool {
        match tenant {
            Tenant::Operator(operator) => self.operator_id == operator && self.firm_id.is_none(),
            Tenant::Firm(firm) => self.firm_id == Some(firm),
        }
    }
}
