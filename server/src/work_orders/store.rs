//! Orders and their logs in the database.

use super::entry::{Author, Content, Entry, canonical, sha256_hex};
use super::order::{Filter, NewOrder, State, Summary};
use super::standing::Standing;
use crate::db::{Db, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::{CompassId, OperatorId, OrderId, PhotoId, VesselId};
use crate::time::Time;
use uuid::Uuid;

/// An order with its log.
pub(super) struct Whole {
    pub(super) summary: Summary,
    pub(super) log: Vec<Entry>,
}

impl Whole {
    /// How it stands.
    pub(super) fn standing(&self) -> Standing {
        Standing::of(self.log.iter().map(|entry| &entry.content))
    }
}

/// The newest first, from before an id.
pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    filter: &Filter,
    before: Option<Uuid>,
    limit: i64,
) -> Result<Vec<Summary>> {
    Ok(rows!(
        db,
        Summary,
        "SELECT o.*, v.name AS vessel_name, c.name AS compass_name
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         JOIN compasses c ON c.vessel_id = o.vessel_id AND c.id = o.compass_id
         WHERE v.operator_id = $1 AND o.id < $2
           AND ($3 IS NULL OR o.vessel_id = $3)
           AND ($4 IS NULL OR o.state = $4)
         ORDER BY o.id DESC
         LIMIT $5",
        operator,
        before.unwrap_or(Uuid::max()),
        filter.vessel,
        filter.state,
        limit
    )?)
}

/// An order of the operator's, in a line.
///
/// # Errors
/// [`Error::NotFound`] when there is none.
pub(super) async fn summary(db: &Db, operator: OperatorId, id: OrderId) -> Result<Summary> {
    row!(
        db,
        Summary,
        "SELECT o.*, v.name AS vessel_name, c.name AS compass_name
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         JOIN compasses c ON c.vessel_id = o.vessel_id AND c.id = o.compass_id
         WHERE v.operator_id = $1 AND o.id = $2
         ORDER BY o.id",
        operator,
        id
    )?
    .ok_or(Error::NotFound("work order"))
}

/// The same within a transaction, of a vessel that is known: others who would change
/// it wait.
pub(super) async fn lock(tx: &mut Tx, vessel: VesselId, id: OrderId) -> Result<Whole> {
    execute!(
        &mut *tx,
        "UPDATE work_orders SET state = state WHERE vessel_id = $1 AND id = $2",
        vessel,
        id
    )?;
    let summary = row!(
        in &mut *tx,
        Summary,
        "SELECT o.*, v.name AS vessel_name, c.name AS compass_name
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         JOIN compasses c ON c.vessel_id = o.vessel_id AND c.id = o.compass_id
         WHERE o.vessel_id = $1 AND o.id = $2
         ORDER BY o.id",
        vessel,
        id
    )?
    .ok_or(Error::NotFound("work order"))?;
    let lines = rows!(
        in tx,
        (String,),
        "SELECT line FROM work_order_entries
         WHERE vessel_id = $1 AND order_id = $2
         ORDER BY seq",
        vessel,
        id
    )?;
    let log = read(lines)?;
    Ok(Whole { summary, log })
}

/// An order of the operator's with its log.
pub(super) async fn whole(db: &Db, operator: OperatorId, id: OrderId) -> Result<Whole> {
    let summary = summary(db, operator, id).await?;
    let lines = rows!(
        db,
        (String,),
        "SELECT line FROM work_order_entries
         WHERE vessel_id = $1 AND order_id = $2
         ORDER BY seq",
        summary.vessel_id,
        id
    )?;
    let log = read(lines)?;
    Ok(Whole { summary, log })
}

fn read(lines: Vec<(String,)>) -> Result<Vec<Entry>> {
    let read = |(line,): (String,)| Ok(serde_json::from_str(&line)?);
    lines.into_iter().map(read).collect()
}

/// Lines of an order's log as they were hashed, with their hashes, from after a number.
pub(super) async fn lines(
    db: &Db,
    vessel: VesselId,
    id: OrderId,
    after: Option<i64>,
    limit: i64,
) -> Result<Vec<(i64, String, String)>> {
    Ok(rows!(
        db,
        (i64, String, String),
        "SELECT seq, line, sha256 FROM work_order_entries
         WHERE vessel_id = $1 AND order_id = $2 AND seq > $3
         ORDER BY seq
         LIMIT $4",
        vessel,
        id,
        after.unwrap_or(0),
        limit
    )?)
}

/// Whether a compass has an order that is not done yet.
pub(super) async fn is_under_way(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<bool> {
    // Whoever orders the same meanwhile waits.
    execute!(
        &mut *tx,
        "UPDATE compasses SET name = name WHERE vessel_id = $1 AND id = $2",
        vessel,
        compass
    )?;
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2
           AND state IN ('planned', 'measured', 'adjusting')",
        vessel,
        compass
    )?;
    Ok(found.is_some_and(|(orders,)| orders > 0))
}

/// The compass's last order that was completed, if it stands in a state.
pub(super) async fn last_completed(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<(OrderId, State, Time)>> {
    Ok(row!(
        in tx,
        (OrderId, State, Time),
        "SELECT id, state, completed_at FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND completed_at IS NOT NULL
         ORDER BY completed_at DESC, id DESC
         LIMIT 1",
        vessel,
        compass
    )?)
}

pub(super) async fn insert(
    tx: &mut Tx,
    id: OrderId,
    order: &NewOrder,
    author: &Author,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO work_orders (vessel_id, id, compass_id, state, port, berth, planned_at,
                                  adjuster_name, adjuster_licence, firm, created_at, created_by,
                                  last_seq, last_sha256)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, 0, '')",
        order.vessel_id,
        id,
        order.compass_id,
        State::Planned,
        order.port.as_str(),
        order.berth.as_deref(),
        order.planned_at,
        order.adjuster_name.as_deref(),
        order.adjuster_licence.as_deref(),
        order.firm.as_deref(),
        now,
        author.name.as_str()
    )?;
    Ok(())
}

/// Writes the next entry of an order's log, and what follows from it.
pub(super) async fn append(
    tx: &mut Tx,
    whole: &mut Whole,
    id: Uuid,
    author: &Author,
    now: Time,
    content: Content,
) -> Result<()> {
    let summary = &mut whole.summary;
    let previous = (summary.last_seq > 0).then(|| summary.last_sha256.clone());
    let entry = Entry {
        version: 1,
        order: summary.id,
        seq: summary.last_seq + 1,
        id,
        previous_sha256: previous,
        at: now,
        author: author.clone(),
        content,
    };
    let line = canonical(&entry)?;
    // A number that JSON does not know would make the log unreadable.
    serde_json::from_str::<Entry>(&line)?;
    let sha256 = sha256_hex(line.as_bytes());
    execute!(
        &mut *tx,
        "INSERT INTO work_order_entries (vessel_id, order_id, seq, id, line, sha256)
         VALUES ($1, $2, $3, $4, $5, $6)",
        summary.vessel_id,
        summary.id,
        entry.seq,
        id,
        line,
        sha256.as_str()
    )?;
    summary.last_seq = entry.seq;
    summary.last_sha256 = sha256;
    whole.log.push(entry);
    whole.summary.state = whole.standing().state;
    execute!(
        tx,
        "UPDATE work_orders SET state = $3, last_seq = $4, last_sha256 = $5
         WHERE vessel_id = $1 AND id = $2",
        whole.summary.vessel_id,
        whole.summary.id,
        whole.summary.state,
        whole.summary.last_seq,
        whole.summary.last_sha256.as_str()
    )?;
    Ok(())
}

/// Notes that an order was completed, with the record that was signed.
pub(super) async fn complete(
    tx: &mut Tx,
    summary: &Summary,
    completed_at: Time,
    record: &str,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE work_orders
         SET completed_at = $3, record = $4, adjuster_name = $5, adjuster_licence = $6, firm = $7
         WHERE vessel_id = $1 AND id = $2",
        summary.vessel_id,
        summary.id,
        completed_at,
        record,
        summary.adjuster_name.as_deref(),
        summary.adjuster_licence.as_deref(),
        summary.firm.as_deref()
    )?;
    Ok(())
}

/// The record as it was signed; none before the order is completed.
pub(super) async fn record(db: &Db, vessel: VesselId, id: OrderId) -> Result<Option<String>> {
    let found = row!(
        db,
        (Option<String>,),
        "SELECT record FROM work_orders WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        id
    )?;
    Ok(found.and_then(|(record,)| record))
}

pub(super) async fn insert_photo(
    tx: &mut Tx,
    summary: &Summary,
    id: PhotoId,
    media_type: &str,
    sha256: &str,
    bytes: &[u8],
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO work_order_photos (vessel_id, order_id, id, media_type, sha256, bytes)
         VALUES ($1, $2, $3, $4, $5, $6)",
        summary.vessel_id,
        summary.id,
        id,
        media_type,
        sha256,
        bytes
    )?;
    Ok(())
}

/// A photograph's media type and bytes.
pub(super) async fn photo(
    db: &Db,
    vessel: VesselId,
    order: OrderId,
    id: PhotoId,
) -> Result<Option<(String, Vec<u8>)>> {
    Ok(row!(
        db,
        (String, Vec<u8>),
        "SELECT media_type, bytes FROM work_order_photos
         WHERE vessel_id = $1 AND order_id = $2 AND id = $3
         ORDER BY id",
        vessel,
        order,
        id
    )?)
}
