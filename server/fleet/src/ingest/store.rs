//! Batches in the database.

use crate::agent_auth::Agent;
use axum::http::StatusCode;
use binnacle_compass::sample::Sample;
use binnacle_platform::db::{Result as DbResult, Tx, execute, row};
use binnacle_platform::error::{DomainProblem, Error, Result};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_wire::batch::Batch;
use serde_json::Map;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use uuid::Uuid;

/// Lead over the server's clock beyond which a sample's date is wrong, seconds. Such a sample
/// does not give the last position.
const AHEAD_S: f64 = 86_400.0;

/// Tally of accepted windows whose samples were thinned out on board.
const THINNED: &str = "thinned";

#[derive(sqlx::FromRow)]
struct Progress {
    contiguous_seq: i64,
    tally: String,
}

/// Stores a batch. Returns `false` when the same bytes are stored already.
pub(super) async fn insert(
    tx: &mut Tx,
    agent: Agent,
    batch: &Batch,
    bytes: &[u8],
    now: Time,
) -> Result<bool> {
    // Locking the stream's row first serializes the batches of a stream.
    let progress = row!(
        in &mut *tx,
        Progress,
        "UPDATE streams SET last_upload_at = $4
         WHERE vessel_id = $1 AND id = $2 AND agent_id = $3
         RETURNING contiguous_seq, tally",
        agent.vessel_id,
        batch.stream.0,
        agent.agent_id,
        now
    )?
    .ok_or(Error::NotFound("stream"))?;
    let seq = i64::try_from(batch.seq).map_err(|_| Error::NotFound("batch"))?;
    let hash = Sha256::digest(bytes).to_vec();
    let known = row!(
        in &mut *tx,
        (Vec<u8>,),
        "SELECT sha256 FROM batches WHERE vessel_id = $1 AND stream = $2 AND seq = $3
         ORDER BY seq",
        agent.vessel_id,
        batch.stream.0,
        seq
    )?;
    if let Some((known,)) = known {
        return if known == hash {
            Ok(false)
        } else {
            Err(forked(batch.seq))
        };
    }
    let first = batch.samples.first().map(|sample| Time(sample.time));
    let last = batch.samples.last().map(|sample| Time(sample.time));
    execute!(
        &mut *tx,
        "INSERT INTO batches (vessel_id, stream, seq, bytes, sha256, samples,
                              first_sample_at, last_sample_at, received_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        agent.vessel_id,
        batch.stream.0,
        seq,
        bytes,
        hash,
        batch.samples.len() as i64,
        first,
        last,
        now
    )?;
    update_stream(tx, agent.vessel_id, batch, progress).await?;
    update_vessel(tx, agent.vessel_id, batch, now).await?;
    Ok(true)
}

/// Records the agent's state on board: batches that wait, and the rest of the budget.
pub(super) async fn record_board_status(
    tx: &mut Tx,
    vessel: VesselId,
    stream: Uuid,
    waits: u32,
    budget_percent: Option<i32>,
    now: Time,
) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE streams
         SET batches_waiting = $3, budget_left_percent = $4, aboard_at = $5
         WHERE vessel_id = $1 AND id = $2",
        vessel,
        stream,
        i64::from(waits),
        budget_percent.map(i64::from),
        now
    )?;
    Ok(())
}

/// Adds a stored batch to the stream's totals.
async fn update_stream(
    tx: &mut Tx,
    vessel: VesselId,
    batch: &Batch,
    progress: Progress,
) -> Result<()> {
    let mut tally: BTreeMap<String, u64> = serde_json::from_str(&progress.tally)?;
    for (outcome, windows) in &batch.tally {
        let sum = tally.entry(outcome.clone()).or_default();
        *sum = sum.saturating_add(*windows);
    }
    if let Some(thinned) = batch.thinned {
        let sum = tally.entry(THINNED.to_owned()).or_default();
        *sum = sum.saturating_add(thinned.windows);
    }
    let contiguous = contiguous_seq(tx, vessel, batch.stream.0, progress.contiguous_seq).await?;
    execute!(
        &mut *tx,
        "UPDATE streams
         SET contiguous_seq = $3, batches = batches + 1, samples = samples + $4, tally = $5
         WHERE vessel_id = $1 AND id = $2",
        vessel,
        batch.stream.0,
        contiguous,
        batch.samples.len() as i64,
        serde_json::to_string(&tally)?
    )?;
    Ok(())
}

/// Returns the last batch before the first gap, given one without a gap before it.
async fn contiguous_seq(tx: &mut Tx, vessel: VesselId, stream: Uuid, known: i64) -> DbResult<i64> {
    let next = row!(
        in &mut *tx,
        (i64,),
        "SELECT seq FROM batches WHERE vessel_id = $1 AND stream = $2 AND seq = $3 ORDER BY seq",
        vessel,
        stream,
        known + 1
    )?;
    if next.is_none() {
        return Ok(known);
    }
    let last = row!(
        in &mut *tx,
        (i64,),
        "SELECT b.seq FROM batches b
         WHERE b.vessel_id = $1 AND b.stream = $2 AND b.seq > $3
           AND NOT EXISTS (SELECT 1 FROM batches n
                           WHERE n.vessel_id = b.vessel_id AND n.stream = b.stream
                             AND n.seq = b.seq + 1)
         ORDER BY b.seq
         LIMIT 1",
        vessel,
        stream,
        known
    )?;
    Ok(last.map_or(known, |(seq,)| seq))
}

async fn update_vessel(tx: &mut Tx, vessel: VesselId, batch: &Batch, now: Time) -> DbResult<()> {
    execute!(
        &mut *tx,
        "UPDATE vessels SET last_upload_at = $2 WHERE id = $1",
        vessel,
        now
    )?;
    let latest = Time(now.0.plus_seconds(AHEAD_S));
    let believable = |sample: &&Sample| Time(sample.time) <= latest;
    let Some(last) = batch.samples.iter().rev().find(believable) else {
        return Ok(());
    };
    // A late batch does not move the position back, unless the stored one is of the future.
    execute!(
        &mut *tx,
        "UPDATE vessels SET last_sample_at = $2, last_lat = $3, last_lon = $4
         WHERE id = $1 AND (last_sample_at IS NULL OR last_sample_at < $2 OR last_sample_at > $5)",
        vessel,
        Time(last.time),
        last.position.lat_deg(),
        last.position.lon_deg(),
        latest
    )?;
    Ok(())
}

/// Returns the refusal of a batch whose number other bytes have.
fn forked(seq: u64) -> Error {
    let problem = DomainProblem {
        status: StatusCode::CONFLICT,
        kind: "stream-forked",
        title: "The stream has forked",
        detail: format!(
            "batch {seq} of this stream is stored with other bytes; open a new stream and number \
             anew"
        ),
        extra: Map::new(),
    };
    problem.into()
}
