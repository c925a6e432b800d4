//! Events in the database, kept for a day.

use super::{Event, EventStored, Kind};
use crate::db::{Db, Result, Tx, execute, rows};
use crate::error;
use crate::ids::{EventId, FirmId, OperatorId, VesselId};
use crate::tenants::{OwnerOf, Tenant};
use crate::time::Time;
use uuid::Uuid;

/// Channel of PostgreSQL's NOTIFY.
pub(crate) const CHANNEL: &str = "binnacle_events";
const KEPT_FOR_S: f64 = 86_400.0;
/// Overlap before the last event seen, seconds: each process has its own clock, and a
/// transaction may become visible late.
const OVERLAP_S: f64 = 10.0;
/// Maximum number of events sent after a pause; beyond that, a dashboard should reload its data.
const MAX_MISSED: i64 = 1000;

/// Event to be stored.
pub struct NewEvent {
    /// The vessel concerned.
    pub vessel_id: VesselId,
    /// Kind of event.
    pub kind: Kind,
    /// Id of what the event is about, if that is a single thing of the vessel.
    pub about: Option<Uuid>,
    /// Firm that receives the event; none if the operator does.
    pub firm_id: Option<FirmId>,
}

/// Stores an event for the operator of a vessel, to be published once it is committed.
pub async fn insert(
    tx: &mut Tx,
    vessel_id: VesselId,
    kind: Kind,
    now: Time,
) -> error::Result<Event> {
    let new = NewEvent {
        vessel_id,
        kind,
        about: None,
        firm_id: None,
    };
    insert_event(tx, new, now).await
}

/// Stores an event, to be published once it is committed.
pub async fn insert_event(tx: &mut Tx, new: NewEvent, now: Time) -> error::Result<Event> {
    let vessel_id = new.vessel_id;
    let owner = tx.ask(&OwnerOf(vessel_id)).await?;
    let owner = owner.ok_or_else(|| anyhow::anyhow!("vessel {vessel_id} is missing"))?;
    insert_of(tx, owner.operator_id, new, now).await
}

/// Stores an event of a vessel whose operator is known, to be published once it is committed.
pub async fn insert_of(
    tx: &mut Tx,
    operator_id: OperatorId,
    new: NewEvent,
    now: Time,
) -> error::Result<Event> {
    let event = Event {
        id: EventId::new(),
        operator_id,
        firm_id: new.firm_id,
        about: new.about,
        vessel_id: new.vessel_id,
        kind: new.kind,
    };
    execute!(
        &mut *tx,
        "INSERT INTO events (id, operator_id, firm_id, order_id, vessel_id, kind, created_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7)",
        event.id,
        event.operator_id,
        event.firm_id,
        event.about,
        event.vessel_id,
        event.kind.name(),
        now
    )?;
    let stored = EventStored { event, at: now };
    tx.publish(&stored).await?;
    Ok(stored.event)
}

/// Returns the events since the given one. If that event is already deleted, returns all
/// events that are left.
pub(crate) async fn since(db: &Db, tenant: Tenant, last: EventId) -> Result<Vec<Event>> {
    rows!(
        db,
        Event,
        "SELECT id, operator_id, firm_id, order_id, vessel_id, kind FROM events
         WHERE ((operator_id = $1 AND firm_id IS NULL) OR firm_id = $2) AND id <> $3
           AND created_at >= COALESCE((SELECT l.created_at FROM events l
                                       WHERE l.id = $3
                                         AND (l.operator_id = $1 OR l.firm_id = $2)), 0) - $4
         ORDER BY id
         LIMIT $5",
        tenant.operator(),
        tenant.firm(),
        last,
        (OVERLAP_S * 1e6) as i64,
        MAX_MISSED
    )
}

/// Returns the events of all tenants since a time, with a short overlap before it.
pub(crate) async fn all_since(db: &Db, from: Time) -> Result<Vec<Event>> {
    rows!(
        db,
        Event,
        "SELECT id, operator_id, firm_id, order_id, vessel_id, kind FROM events
         WHERE created_at >= $1
         ORDER BY id
         LIMIT $2",
        Time(from.0.plus_seconds(-OVERLAP_S)),
        MAX_MISSED
    )
}

/// Deletes expired events.
pub async fn prune(db: &Db, now: Time) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM events WHERE created_at < $1",
        Time(now.0.plus_seconds(-KEPT_FOR_S))
    )?;
    tx.commit().await
}
