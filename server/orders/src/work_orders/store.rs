//! Orders and their logs on their way into the database.

use crate::work_orders::log_entry::{Author, Entry, OrderEvent, canonical, sha256_hex};
use crate::work_orders::offer_state::{Exchange, Offers};
use crate::work_orders::order::{NewOrder, State, Summary};
use crate::work_orders::order_state::OrderState;
pub(crate) use crate::work_orders::queries::{
    lines, list, lock, overdue, summary, vessel_of_asked, whole,
};
use binnacle_platform::db::{Db, Tx, execute, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, OperatorId, OrderId, PhotoId, VesselId};
use binnacle_platform::time::Time;
use uuid::Uuid;

/// An order with its log.
pub(crate) struct StoredOrder {
    pub(crate) summary: Summary,
    pub(crate) log: Vec<Entry>,
}

impl StoredOrder {
    /// How it stands.
    pub(crate) fn standing(&self) -> OrderState {
        OrderState::of(self.log.iter().map(|entry| &entry.content))
    }

    /// Brings the line about the order in step with its last entry.
    fn follow(&mut self, standing: &OrderState) {
        let summary = &mut self.summary;
        summary.state = standing.state;
        summary.answer_by = standing.offers.answer_by();
        summary.call_fit = standing.call.as_ref().map(|call| call.fit);
        let holder = standing.offers.holder().map(|offer| offer.firm_id);
        if summary.firm_id.is_some() && holder.is_none() && !summary.state.is_over() {
            (
                summary.firm,
                summary.adjuster_name,
                summary.adjuster_licence,
            ) = (None, None, None);
        }
        summary.firm_id = holder;
        match self.log.last().map(|entry| &entry.content) {
            Some(OrderEvent::Accepted(said)) => {
                summary.firm = Some(said.firm.firm_name.clone());
                summary.adjuster_name.clone_from(&said.adjuster_name);
                summary.adjuster_licence.clone_from(&said.adjuster_licence);
            }
            Some(OrderEvent::ProposalAccepted(said)) => {
                summary.firm = Some(said.firm.firm_name.clone());
                (summary.adjuster_name, summary.adjuster_licence) = (None, None);
                summary.agree(said);
            }
            Some(OrderEvent::RetimeAccepted(said)) => summary.agree(said),
            _ => {}
        }
    }
}

impl Summary {
    /// Is to be done as was agreed on.
    fn agree(&mut self, said: &Exchange) {
        if let Some(terms) = &said.terms {
            self.planned_at = terms.planned_at;
            self.berth = terms.berth.clone().or(self.berth.take());
        }
    }
}

pub(crate) fn read(lines: Vec<(String,)>) -> Result<Vec<Entry>> {
    let read = |(line,): (String,)| Ok(serde_json::from_str(&line)?);
    lines.into_iter().map(read).collect()
}

/// Has whoever orders the same meanwhile wait.
///
/// # Errors
/// When the database fails.
pub async fn lock_compass(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> Result<()> {
    execute!(
        tx,
        "UPDATE compasses SET name = name WHERE vessel_id = $1 AND id = $2",
        vessel,
        compass
    )?;
    Ok(())
}

/// Whether a compass has an order that is not done yet.
pub(crate) async fn is_under_way(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<bool> {
    lock_compass(tx, vessel, compass).await?;
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2
           AND state IN ('planned', 'offered', 'proposed', 'declined', 'accepted', 'on_board',
                         'measured', 'adjusting')",
        vessel,
        compass
    )?;
    Ok(found.is_some_and(|(orders,)| orders > 0))
}

/// Whether a compass's correctors are being moved.
pub(crate) async fn is_adjusting(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<bool> {
    lock_compass(tx, vessel, compass).await?;
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND state = 'adjusting'",
        vessel,
        compass
    )?;
    Ok(found.is_some_and(|(orders,)| orders > 0))
}

/// The compass's last order that was completed; one that was closed after headings at sea
/// had spoken against it counts as failed still.
pub(crate) async fn last_completed(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<(OrderId, State, Time)>> {
    Ok(row!(
        in tx,
        (OrderId, State, Time),
        "SELECT id,
                CASE WHEN state = 'closed' AND verified_at IS NULL THEN 'failed' ELSE state END,
                completed_at
         FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND completed_at IS NOT NULL
         ORDER BY completed_at DESC, id DESC
         LIMIT 1",
        vessel,
        compass
    )?)
}

/// The names of a vessel of the operator's and of one of her compasses.
///
/// # Errors
/// [`Error::NotFound`] when there is no such vessel or compass.
pub(crate) async fn names(
    tx: &mut Tx,
    operator: OperatorId,
    vessel: VesselId,
    compass: CompassId,
) -> Result<(String, String)> {
    let found = row!(
        in &mut *tx,
        (String,),
        "SELECT name FROM vessels WHERE operator_id = $1 AND id = $2 ORDER BY id",
        operator,
        vessel
    )?;
    let (vessel_name,) = found.ok_or(Error::NotFound("vessel"))?;
    let found = row!(
        in tx,
        (String,),
        "SELECT name FROM compasses WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        compass
    )?;
    let (compass_name,) = found.ok_or(Error::NotFound("compass"))?;
    Ok((vessel_name, compass_name))
}

pub(crate) async fn insert(
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
pub(crate) async fn append(
    tx: &mut Tx,
    whole: &mut StoredOrder,
    id: Uuid,
    author: &Author,
    now: Time,
    content: OrderEvent,
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
    let standing = whole.standing();
    whole.follow(&standing);
    let summary = &whole.summary;
    execute!(
        &mut *tx,
        "UPDATE work_orders
         SET state = $3, last_seq = $4, last_sha256 = $5, firm_id = $6, answer_by = $7,
             planned_at = $8, berth = $9, adjuster_name = $10, adjuster_licence = $11, firm = $12,
             call_fit = $13
         WHERE vessel_id = $1 AND id = $2",
        summary.vessel_id,
        summary.id,
        summary.state,
        summary.last_seq,
        summary.last_sha256.as_str(),
        summary.firm_id,
        summary.answer_by,
        summary.planned_at,
        summary.berth.as_deref(),
        summary.adjuster_name.as_deref(),
        summary.adjuster_licence.as_deref(),
        summary.firm.as_deref(),
        summary.call_fit
    )?;
    if whole
        .log
        .last()
        .is_some_and(|entry| entry.content.is_about_offers())
    {
        write_offers(tx, whole, &standing.offers).await?;
    }
    Ok(())
}

async fn write_offers(tx: &mut Tx, whole: &StoredOrder, offers: &Offers) -> Result<()> {
    for offer in &offers.all {
        execute!(
            &mut *tx,
            "INSERT INTO work_order_offers (vessel_id, order_id, firm_id, state, answer_by)
             VALUES ($1, $2, $3, $4, $5)
             ON CONFLICT (vessel_id, order_id, firm_id) DO UPDATE
             SET state = excluded.state, answer_by = excluded.answer_by",
            whole.summary.vessel_id,
            whole.summary.id,
            offer.firm_id,
            offer.state,
            offer.answer_by
        )?;
    }
    Ok(())
}

/// Notes that an order was completed, with the record that was signed.
pub(crate) async fn complete(
    tx: &mut Tx,
    summary: &Summary,
    (completed_at, received_at): (Time, Time),
    record: &str,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE work_orders
         SET completed_at = $3, record = $4, adjuster_name = $5, adjuster_licence = $6, firm = $7,
             completion_received_at = $8
         WHERE vessel_id = $1 AND id = $2",
        summary.vessel_id,
        summary.id,
        completed_at,
        record,
        summary.adjuster_name.as_deref(),
        summary.adjuster_licence.as_deref(),
        summary.firm.as_deref(),
        received_at
    )?;
    Ok(())
}

/// Notes that headings at sea verified an adjustment, and what they said.
pub(crate) async fn verified(
    tx: &mut Tx,
    summary: &Summary,
    verified_at: Time,
    verification: &str,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE work_orders SET verified_at = $3, verification = $4
         WHERE vessel_id = $1 AND id = $2",
        summary.vessel_id,
        summary.id,
        verified_at,
        verification
    )?;
    Ok(())
}

/// The record as it was signed; none before the order is completed.
pub(crate) async fn record(db: &Db, vessel: VesselId, id: OrderId) -> Result<Option<String>> {
    let found = row!(
        db,
        (Option<String>,),
        "SELECT record FROM work_orders WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        id
    )?;
    Ok(found.and_then(|(record,)| record))
}

pub(crate) async fn insert_photo(
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
pub(crate) async fn photo(
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
