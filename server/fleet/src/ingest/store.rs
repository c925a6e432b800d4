//! Batches in the database.

use super::sender::StreamState;
use crate::agent_auth::Agent;
use axum::http::StatusCode;
use binnacle_compass::sample::Sample;
use binnacle_platform::db::{Result as DbResult, Tx, execute, row};
use binnacle_platform::error::{DomainProblem, Error, Result};
use binnacle_platform::ids::{OperatorId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::batch::Batch;
use serde_json::Map;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Lead over the server's clock beyond which a sample's date is wrong, seconds. Such a sample
/// does not give the last position.
const AHEAD_S: f64 = 86_400.0;

/// Tally of accepted windows whose samples were thinned out on board.
const THINNED: &str = "thinned";

/// Batch of an agent, as it was received.
pub(super) struct Upload<'a> {
    pub(super) agent: Agent,
    /// State of the stream as last read; another batch may have been stored since.
    pub(super) stream: StreamState,
    pub(super) batch: &'a Batch,
    pub(super) bytes: &'a [u8],
    pub(super) board: Option<BoardReport>,
    pub(super) now: Time,
}

/// The agent's report of its state on board.
#[derive(Clone, Copy)]
pub(super) struct BoardReport {
    /// Number of batches that wait there.
    pub(super) waits: u32,
    /// Rest of the link's budget.
    pub(super) budget_percent: Option<i32>,
}

/// Result of storing a batch.
pub(super) struct Stored {
    /// False if the same bytes were stored already.
    pub(super) is_new: bool,
    /// Number up to which every batch of the stream is stored.
    pub(super) contiguous_seq: i64,
}

/// Stores a batch.
pub(super) async fn insert(tx: &mut Tx, upload: Upload<'_>) -> Result<Stored> {
    let (agent, batch) = (upload.agent, upload.batch);
    let seq = i64::try_from(batch.seq).map_err(|_| Error::NotFound("batch"))?;
    let hash = Sha256::digest(upload.bytes).to_vec();
    let first = batch.samples.first().map(|sample| Time(sample.time));
    let last = batch.samples.last().map(|sample| Time(sample.time));
    let inserted = execute!(
        &mut *tx,
        "INSERT INTO batches (vessel_id, stream, seq, bytes, sha256, samples,
                              first_sample_at, last_sample_at, received_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)
         ON CONFLICT (vessel_id, stream, seq) DO NOTHING",
        agent.vessel_id,
        batch.stream.0,
        seq,
        upload.bytes,
        hash.as_slice(),
        batch.samples.len() as i64,
        first,
        last,
        upload.now
    )?;
    let is_new = inserted == 1;
    if !is_new {
        must_be_the_same(tx, &upload, seq, &hash).await?;
    }
    let contiguous_seq = update_stream(tx, upload, seq, is_new).await?;
    Ok(Stored {
        is_new,
        contiguous_seq,
    })
}

async fn must_be_the_same(tx: &mut Tx, upload: &Upload<'_>, seq: i64, hash: &[u8]) -> Result<()> {
    let known = row!(
        in tx,
        (Vec<u8>,),
        "SELECT sha256 FROM batches WHERE vessel_id = $1 AND stream = $2 AND seq = $3
         ORDER BY seq",
        upload.agent.vessel_id,
        upload.batch.stream.0,
        seq
    )?;
    if known.is_some_and(|(known,)| known == hash) {
        return Ok(());
    }
    Err(forked(upload.batch.seq))
}

/// Adds a batch to the stream's totals if it is new, and records the upload. Returns the number
/// up to which every batch is stored.
async fn update_stream(tx: &mut Tx, mut upload: Upload<'_>, seq: i64, is_new: bool) -> Result<i64> {
    let (agent, batch) = (upload.agent, upload.batch);
    let added = i64::from(is_new);
    loop {
        let tally = if is_new {
            tally_with(&upload.stream.tally, batch)?
        } else {
            upload.stream.tally.clone()
        };
        let contiguous = contiguous_seq(tx, &upload, seq).await?;
        let updated = execute!(
            &mut *tx,
            "UPDATE streams
             SET contiguous_seq = $3, batches = batches + $4, samples = samples + $5, tally = $6,
                 last_upload_at = $7,
                 batches_waiting = CASE WHEN $8 THEN $9 ELSE batches_waiting END,
                 budget_left_percent = CASE WHEN $8 THEN $10 ELSE budget_left_percent END,
                 aboard_at = CASE WHEN $8 THEN $7 ELSE aboard_at END
             WHERE vessel_id = $1 AND id = $2 AND batches = $11 AND contiguous_seq = $12",
            agent.vessel_id,
            batch.stream.0,
            contiguous,
            added,
            batch.samples.len() as i64 * added,
            tally,
            upload.now,
            upload.board.is_some(),
            upload.board.map(|board| i64::from(board.waits)),
            upload
                .board
                .and_then(|board| board.budget_percent.map(i64::from)),
            upload.stream.batches,
            upload.stream.contiguous_seq
        )?;
        if updated == 1 {
            return Ok(contiguous);
        }
        // Another batch of the stream was stored since its state was read.
        upload.stream = StreamState::find(tx, agent, batch.stream.0).await?;
    }
}

/// Returns a stream's tally with a batch's windows added.
fn tally_with(tally: &str, batch: &Batch) -> Result<String> {
    let mut tally: BTreeMap<String, u64> = serde_json::from_str(tally)?;
    for (outcome, windows) in &batch.tally {
        let sum = tally.entry(outcome.clone()).or_default();
        *sum = sum.saturating_add(*windows);
    }
    if let Some(thinned) = batch.thinned {
        let sum = tally.entry(THINNED.to_owned()).or_default();
        *sum = sum.saturating_add(thinned.windows);
    }
    Ok(serde_json::to_string(&tally)?)
}

/// Returns the last batch before the first gap, once a batch is stored.
async fn contiguous_seq(tx: &mut Tx, upload: &Upload<'_>, seq: i64) -> DbResult<i64> {
    let known = &upload.stream;
    if seq != known.contiguous_seq + 1 {
        return Ok(known.contiguous_seq);
    }
    if known.batches == known.contiguous_seq {
        return Ok(seq);
    }
    // It closes a gap.
    let last = row!(
        in &mut *tx,
        (i64,),
        "SELECT b.seq FROM batches b
         WHERE b.vessel_id = $1 AND b.stream = $2 AND b.seq >= $3
           AND NOT EXISTS (SELECT 1 FROM batches n
                           WHERE n.vessel_id = b.vessel_id AND n.stream = b.stream
                             AND n.seq = b.seq + 1)
         ORDER BY b.seq
         LIMIT 1",
        upload.agent.vessel_id,
        upload.batch.stream.0,
        seq
    )?;
    Ok(last.map_or(seq, |(seq,)| seq))
}

/// Records the upload, and the place of the last sample. Returns the vessel's operator.
pub(super) async fn update_vessel(
    tx: &mut Tx,
    vessel: VesselId,
    batch: &Batch,
    now: Time,
) -> Result<OperatorId> {
    let latest = Time(now.0.plus_seconds(AHEAD_S));
    let believable = |sample: &&Sample| Time(sample.time) <= latest;
    let last = batch.samples.iter().rev().find(believable);
    // A late batch does not move the position back, unless the stored one is of the future.
    let (operator,) = row!(
        in tx,
        (OperatorId,),
        "UPDATE vessels
         SET last_upload_at = $2,
             last_lat = CASE WHEN last_sample_at IS NULL OR last_sample_at < $3
                                  OR (last_sample_at > $6 AND $3 IS NOT NULL)
                             THEN $4 ELSE last_lat END,
             last_lon = CASE WHEN last_sample_at IS NULL OR last_sample_at < $3
                                  OR (last_sample_at > $6 AND $3 IS NOT NULL)
                             THEN $5 ELSE last_lon END,
             last_sample_at = CASE WHEN last_sample_at IS NULL OR last_sample_at < $3
                                        OR (last_sample_at > $6 AND $3 IS NOT NULL)
                                   THEN $3 ELSE last_sample_at END
         WHERE id = $1
         RETURNING operator_id",
        vessel,
        now,
        last.map(|last| Time(last.time)),
        last.map(|last| last.position.lat_deg()),
        last.map(|last| last.position.lon_deg()),
        latest
    )?
    .ok_or(Error::NotFound("vessel"))?;
    Ok(operator)
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
