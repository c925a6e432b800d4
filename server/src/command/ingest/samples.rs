//! Import of samples that were made of recordings, into the log of a compass.
//!
//! Invariants:
//!
//! - They are stored as batches of a stream of their own, so that everything that follows an
//!   upload follows them too. Each batch has its own transaction.
//! - A sample that the compass's log has already, from an agent or an import, is not stored again.
//!   So an import that was broken off is completed by repeating it.

use super::stream::{batches_within, find_or_open, next_seq};
use anyhow::Context;
use binnacle_compass::sample::Sample;
use binnacle_fleet::compasses;
use binnacle_fleet::ingest::store_batch;
use binnacle_platform::db::Db;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::batch::{Batch, StreamId};
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use uuid::Uuid;

/// Samples in a batch: two weeks under way, far below the limits of a frame.
const SAMPLES_OF_BATCH: usize = 2_000;
/// Delay of the analysis while further batches follow, seconds.
const MORE_FOLLOW_S: f64 = 60.0;

/// Samples to be imported.
#[derive(Debug)]
pub struct Import {
    /// Vessel.
    pub vessel: VesselId,
    /// Compass; the vessel's first one by default.
    pub compass: Option<CompassId>,
    /// Samples in any order.
    pub samples: Vec<Sample>,
}

/// Result of an import, and its progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ImportedSamples {
    /// Samples that were stored.
    pub stored: usize,
    /// Samples that were there already.
    pub repeated: usize,
    /// Batches that were stored.
    pub batches: usize,
}

/// Stores samples, and reports the progress after each batch.
///
/// # Errors
/// Fails when there is no such compass, when a sample has a value that no batch can carry, or when
/// the database does.
pub async fn import_samples(
    db: &Db,
    import: Import,
    now: Time,
    mut progress: impl FnMut(ImportedSamples),
) -> Result<ImportedSamples> {
    let compass = find_compass(db, import.vessel, import.compass).await?;
    let mut samples = import.samples;
    samples.sort_by_key(|sample| sample.time);
    let mut known = stored_samples(db, import.vessel, compass, &samples).await?;
    let mut imported = ImportedSamples::default();
    let mut parts = samples.chunks(SAMPLES_OF_BATCH).peekable();
    while let Some(part) = parts.next() {
        let mut new = Vec::with_capacity(part.len());
        for sample in as_stored(part)? {
            if known.insert(key(&sample)?) {
                new.push(sample);
            }
        }
        imported.repeated += part.len() - new.len();
        if !new.is_empty() {
            imported.stored += new.len();
            imported.batches += 1;
            let delay_s = if parts.peek().is_some() {
                MORE_FOLLOW_S
            } else {
                0.0
            };
            store_part(db, import.vessel, compass, new, now, delay_s).await?;
        }
        progress(imported);
    }
    Ok(imported)
}

/// Finds a compass of the vessel, or its first one by default, and names what is not there.
async fn find_compass(db: &Db, vessel: VesselId, compass: Option<CompassId>) -> Result<CompassId> {
    let compasses = compasses::of_vessel(db, vessel).await?;
    let Some(first) = compasses.first() else {
        return Err(Error::BadRequest(format!("there is no vessel {vessel}")));
    };
    let compass = compass.unwrap_or(first.id);
    if compasses.iter().any(|found| found.id == compass) {
        return Ok(compass);
    }
    let text = format!("vessel {vessel} has no compass {compass}");
    Err(Error::BadRequest(text))
}

/// Stores samples as the next batch of the compass's imports.
async fn store_part(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    samples: Vec<Sample>,
    now: Time,
    delay_s: f64,
) -> Result<()> {
    let mut tx = db.begin().await?;
    let (agent, stream) = find_or_open(&mut tx, vessel, compass, now).await?;
    let seq = next_seq(&mut tx, vessel, stream).await?;
    let batch = batch(stream, seq, samples);
    let bytes = encode(&batch)?;
    let received = store_batch(&mut tx, agent, &batch, &bytes, now, delay_s).await?;
    tx.commit().await?;
    events::announce_all(db, &received.events_out).await?;
    Ok(())
}

/// Returns the keys of the samples that the compass's log has in the time of others.
async fn stored_samples(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    others: &[Sample],
) -> Result<HashSet<String>> {
    let mut keys = HashSet::new();
    let (Some(first), Some(last)) = (others.first(), others.last()) else {
        return Ok(keys);
    };
    let (first, last) = (Time(first.time), Time(last.time));
    for (bytes,) in batches_within(db, vessel, compass, first, last).await? {
        let batch = binnacle_wire::decode(&bytes).context("a stored batch cannot be read")?;
        for sample in &batch.samples {
            keys.insert(key(sample)?);
        }
    }
    Ok(keys)
}

/// Returns samples with the steps of the batch format, as they are read back.
fn as_stored(samples: &[Sample]) -> Result<Vec<Sample>> {
    let bytes = encode(&batch(Uuid::nil(), 1, samples.to_vec()))?;
    let batch = binnacle_wire::decode(&bytes).context("a new batch cannot be read")?;
    Ok(batch.samples)
}

fn batch(stream: Uuid, seq: u64, samples: Vec<Sample>) -> Batch {
    let windows = samples.iter().map(|sample| u64::from(sample.windows)).sum();
    Batch {
        stream: StreamId(stream),
        seq,
        samples,
        tally: BTreeMap::from([("accepted".to_owned(), windows)]),
        alerts: Vec::new(),
        thinned: None,
    }
}

fn encode(batch: &Batch) -> Result<Vec<u8>> {
    binnacle_wire::encode(batch).map_err(|error| Error::BadRequest(error.to_string()))
}

/// Returns the text by which an analysis, too, finds repetitions.
fn key(sample: &Sample) -> Result<String> {
    Ok(serde_json::to_string(sample)?)
}
