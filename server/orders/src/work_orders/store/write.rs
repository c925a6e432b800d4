//! Writing of orders and their logs.

use crate::work_orders::events::{Event, OrderEvent};
use crate::work_orders::log::canonical_json::{canonical, sha256_hex};
use crate::work_orders::log::entry::{Author, Entry};
use crate::work_orders::log::seal::{SealedEntry, readers};
use crate::work_orders::new_order::NewOrder;
use crate::work_orders::offers::Offers;
use crate::work_orders::payload::hours::utc_offset_s;
use crate::work_orders::state::State;
use crate::work_orders::store::stored_order::StoredOrder;
use crate::work_orders::summary::Summary;
use binnacle_platform::db::{Tx, execute, row};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, OrderId, PhotoId, VesselId};
use binnacle_platform::signing_keys;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Locks a compass against other orders until the transaction ends.
///
/// # Errors
/// Fails when the database fails.
pub async fn lock_compass(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> Result<()> {
    execute!(
        tx,
        "UPDATE compasses SET name = name WHERE vessel_id = $1 AND id = $2",
        vessel,
        compass
    )?;
    Ok(())
}

/// Returns whether a compass has an unfinished order.
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

/// Returns whether a compass's correctors are being moved.
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
                                  last_seq, last_sha256, job_us, agreed_utc_offset_s)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, 0, '', $13, $14)",
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
        author.name.as_str(),
        order.hours().length_us(),
        utc_offset_s(&order.port, order.planned_at)
    )?;
    Ok(())
}

/// Writes the next entry of an order's log, and its consequences.
pub(crate) async fn append(
    tx: &mut Tx,
    stored: &mut StoredOrder,
    id: Uuid,
    author: &Author,
    now: Time,
    content: OrderEvent,
) -> Result<()> {
    let summary = &mut stored.summary;
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
    // A number without a JSON form (NaN) would make the log unreadable.
    serde_json::from_str::<Entry>(&line)?;
    let sha256 = sha256_hex(line.as_bytes());
    let key = signing_keys::current(&mut *tx, now).await?;
    let mut sealed = SealedEntry {
        seq: entry.seq,
        sha256: sha256.clone(),
        readers: readers(entry.content.event().audience()),
        seal: None,
    };
    sealed.sign(&summary.id.to_string(), &key)?;
    let seal = sealed.seal.as_ref();
    execute!(
        &mut *tx,
        "INSERT INTO work_order_entries (vessel_id, order_id, seq, id, line, sha256, seal_key, seal)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
        summary.vessel_id,
        summary.id,
        entry.seq,
        id,
        line,
        sha256.as_str(),
        seal.map(|seal| seal.key.as_str()),
        seal.map(|seal| seal.signature.as_str())
    )?;
    summary.last_seq = entry.seq;
    summary.last_sha256 = sha256;
    stored.log.push(entry);
    let state = stored.state();
    stored.update_summary(&state);
    let summary = &stored.summary;
    execute!(
        &mut *tx,
        "UPDATE work_orders
         SET state = $3, last_seq = $4, last_sha256 = $5, firm_id = $6, answer_by = $7,
             planned_at = $8, berth = $9, adjuster_name = $10, adjuster_licence = $11, firm = $12,
             call_fit = $13, job_us = $14, agreed_utc_offset_s = $15
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
        summary.call_fit,
        summary.hours().length_us(),
        summary.agreed_utc_offset_s
    )?;
    let last = stored.log.last().map(|entry| entry.content.event());
    if last.is_some_and(Event::changes_offers) {
        write_offers(tx, stored, &state.offers).await?;
    }
    Ok(())
}

async fn write_offers(tx: &mut Tx, stored: &StoredOrder, offers: &Offers) -> Result<()> {
    for offer in &offers.all {
        execute!(
            &mut *tx,
            "INSERT INTO work_order_offers (vessel_id, order_id, firm_id, state, answer_by, team)
             VALUES ($1, $2, $3, $4, $5, $6)
             ON CONFLICT (vessel_id, order_id, firm_id) DO UPDATE
             SET state = excluded.state, answer_by = excluded.answer_by, team = excluded.team",
            stored.summary.vessel_id,
            stored.summary.id,
            offer.firm_id,
            offer.state,
            offer.answer_by,
            offer.team.as_deref()
        )?;
    }
    Ok(())
}

/// Stores the completion of an order, with its signed record.
pub(crate) async fn store_completion(
    tx: &mut Tx,
    summary: &Summary,
    completed_at: Time,
    received_at: Time,
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

/// Stores the verification of an adjustment by headings at sea.
pub(crate) async fn store_verification(
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
