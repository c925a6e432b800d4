//! Events in the database, kept for a day.

use super::live::CHANNEL;
use super::{Event, Kind};
use crate::db::{Db, Result, Tx, execute, row, rows};
use crate::error;
use crate::ids::{EventId, OperatorId, VesselId};
use crate::time::Time;
use binnacle_magnetics::time::Timestamp;

const KEPT_FOR_S: f64 = 86_400.0;
/// Ids are ordered by the clock of the process that made them, and a transaction
/// may be seen late: how far to look back before the last event seen.
const OVERLAP_S: f64 = 10.0;
/// As many as a dashboard is told after a pause; with more it should read anew.
const MOST_MISSED: i64 = 1000;

/// Stores an event, to be made known with the transaction's commit.
pub async fn insert(
    tx: &mut Tx,
    vessel_id: VesselId,
    kind: Kind,
    now: Time,
) -> error::Result<Event> {
    let (operator_id,) = row!(
        in &mut *tx,
        (OperatorId,),
        "SELECT operator_id FROM vessels WHERE id = $1 ORDER BY id",
        vessel_id
    )?
    .ok_or_else(|| anyhow::anyhow!("vessel {vessel_id} is missing"))?;
    let event = Event {
        id: EventId::new(),
        operator_id,
        vessel_id,
        kind,
    };
    execute!(
        &mut *tx,
        "INSERT INTO events (id, operator_id, vessel_id, kind, created_at)
         VALUES ($1, $2, $3, $4, $5)",
        event.id,
        operator_id,
        vessel_id,
        kind,
        now
    )?;
    if let Tx::Postgres(tx) = tx {
        sqlx::query("SELECT pg_notify($1, $2)")
            .bind(CHANNEL)
            .bind(serde_json::to_string(&event)?)
            .execute(&mut **tx)
            .await?;
    }
    Ok(event)
}

/// What happened since an event was seen.
pub(super) async fn since(db: &Db, operator: OperatorId, last: EventId) -> Result<Vec<Event>> {
    let Some((seconds, _)) = last.0.get_timestamp().map(|time| time.to_unix()) else {
        return Ok(Vec::new());
    };
    let from = Timestamp::from_micros(seconds.saturating_mul(1_000_000) as i64)
        .map_or(0, |time| time.plus_seconds(-OVERLAP_S).micros());
    rows!(
        db,
        Event,
        "SELECT id, operator_id, vessel_id, kind FROM events
         WHERE operator_id = $1 AND created_at >= $2 AND id <> $3
         ORDER BY id
         LIMIT $4",
        operator,
        from,
        last,
        MOST_MISSED
    )
}

/// Forgets what nobody will ask for any more.
pub async fn prune(db: &Db, now: Time) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM events WHERE created_at < $1",
        Time(now.0.plus_seconds(-KEPT_FOR_S))
    )?;
    tx.commit().await
}
