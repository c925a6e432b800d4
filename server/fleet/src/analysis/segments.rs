//! Segments in the database: a cache of the log, by key.
//!
//! Invariants:
//!
//! - A row is used only if its key is the one that the log has, and what is sealed in it is whole.
//! - The last two states are kept: the link of a ship that comes into port brings what is weeks old.
//! - A damaged row is removed, and its vessel's analysis queued, by whoever finds it.

use super::input::{Hash, decode, load_batches};
use super::packed::{pack, unpack};
use super::sealed::{seal, unseal};
use crate::analysis_queue;
use anyhow::Context;
use binnacle_compass::result::SampleDiagnostic;
use binnacle_compass::segment::Segment;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use tracing::warn;

/// Number of states that are kept.
pub const KEPT_STATES: usize = 2;

/// Row without what is sealed in it.
#[derive(Clone, Debug)]
pub struct KnownSegment {
    /// Its segment.
    pub segment: Segment,
    /// Hash of the numbers of its batches.
    pub batches: Hash,
    /// Hash of its samples.
    pub samples: Hash,
    /// Hash of all that it was derived from.
    pub key: Hash,
    /// Tells whether it has a state.
    pub has_state: bool,
}

/// Row to be stored.
#[derive(Clone, Debug)]
pub struct NewSegment {
    /// Its segment and its hashes.
    pub known: KnownSegment,
    first_sample_at: Option<Time>,
    last_sample_at: Option<Time>,
    diagnoses: Vec<u8>,
    state: Option<Vec<u8>>,
}

#[derive(sqlx::FromRow)]
struct KnownRow {
    segment: i64,
    batches_sha256: Vec<u8>,
    samples_sha256: Vec<u8>,
    key: Vec<u8>,
    has_state: i64,
}

#[derive(sqlx::FromRow)]
struct DiagnosesRow {
    segment: i64,
    first_sample_at: Time,
    last_sample_at: Time,
    diagnoses: Vec<u8>,
}

impl NewSegment {
    /// Seals diagnoses in order of time, and a state.
    ///
    /// # Errors
    /// Fails when the memory does not suffice.
    pub fn new(
        known: KnownSegment,
        diagnoses: &[SampleDiagnostic],
        state: Option<&[u8]>,
    ) -> anyhow::Result<NewSegment> {
        let time = |found: &SampleDiagnostic| Time(found.sample.time);
        Ok(NewSegment {
            known,
            first_sample_at: diagnoses.first().map(time),
            last_sample_at: diagnoses.last().map(time),
            diagnoses: seal(&pack(diagnoses))?,
            state: state.map(seal).transpose()?,
        })
    }
}

/// Lists a compass's rows in order.
pub async fn list(db: &Db, vessel: VesselId, compass: CompassId) -> Result<Vec<KnownSegment>> {
    let found = rows!(
        db,
        KnownRow,
        "SELECT segment, batches_sha256, samples_sha256, key,
                CASE WHEN state IS NULL THEN CAST(0 AS BIGINT) ELSE CAST(1 AS BIGINT) END
                    AS has_state
         FROM segments WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY segment",
        vessel,
        compass
    )?;
    // Hashes of another length are those of a damaged row: they agree with no other.
    let hash = |bytes: Vec<u8>| Hash(bytes.try_into().unwrap_or([0; 32]));
    let known = found.into_iter().map(|row| KnownSegment {
        segment: Segment::new(row.segment),
        batches: hash(row.batches_sha256),
        samples: hash(row.samples_sha256),
        key: hash(row.key),
        has_state: row.has_state != 0,
    });
    Ok(known.collect())
}

/// Returns the state at the end of a segment; none if it is damaged.
pub async fn find_state(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    segment: Segment,
) -> Result<Option<Vec<u8>>> {
    let found = row!(
        db,
        (Option<Vec<u8>>,),
        "SELECT state FROM segments WHERE vessel_id = $1 AND compass_id = $2 AND segment = $3
         ORDER BY segment",
        vessel,
        compass,
        segment.number()
    )?;
    let Some(sealed) = found.and_then(|(state,)| state) else {
        return Ok(None);
    };
    match unseal(&sealed) {
        Ok(state) => Ok(Some(state)),
        Err(error) => {
            warn!(%vessel, %error, "a kept analysis is damaged and will be made again");
            Ok(None)
        }
    }
}

/// Returns the diagnoses that were settled at the end of a segment; none if they are damaged.
pub async fn find_settled(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    segment: Segment,
) -> Result<Option<Vec<SampleDiagnostic>>> {
    let found = find_diagnoses(db, vessel, compass, segment).await?;
    Ok(join(db, vessel, compass, found.into_iter().collect())
        .await?
        .ok())
}

/// Returns the row of a segment, if it has diagnoses.
async fn find_diagnoses(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    segment: Segment,
) -> Result<Option<DiagnosesRow>> {
    let found = row!(
        db,
        DiagnosesRow,
        "SELECT segment, first_sample_at, last_sample_at, diagnoses FROM segments
         WHERE vessel_id = $1 AND compass_id = $2 AND segment = $3 AND first_sample_at IS NOT NULL
         ORDER BY segment",
        vessel,
        compass,
        segment.number()
    )?;
    Ok(found)
}

/// Stores rows in place of those of their segments, and removes rows beyond the last and states
/// that are too old.
pub(super) async fn save(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    new: &[NewSegment],
) -> Result<()> {
    for row in new {
        execute!(
            &mut *tx,
            "INSERT INTO segments (vessel_id, compass_id, segment, batches_sha256, samples_sha256,
                                   key, first_sample_at, last_sample_at, diagnoses, state)
             VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)
             ON CONFLICT (vessel_id, compass_id, segment) DO UPDATE
             SET batches_sha256 = excluded.batches_sha256,
                 samples_sha256 = excluded.samples_sha256, key = excluded.key,
                 first_sample_at = excluded.first_sample_at,
                 last_sample_at = excluded.last_sample_at,
                 diagnoses = excluded.diagnoses, state = excluded.state",
            vessel,
            compass,
            row.known.segment.number(),
            row.known.batches.0.to_vec(),
            row.known.samples.0.to_vec(),
            row.known.key.0.to_vec(),
            row.first_sample_at,
            row.last_sample_at,
            row.diagnoses.as_slice(),
            row.state.as_deref()
        )?;
    }
    let Some(last) = new.last() else {
        return Ok(());
    };
    execute!(
        &mut *tx,
        "DELETE FROM segments WHERE vessel_id = $1 AND compass_id = $2 AND segment > $3",
        vessel,
        compass,
        last.known.segment.number()
    )?;
    execute!(
        &mut *tx,
        "UPDATE segments SET state = NULL
         WHERE vessel_id = $1 AND compass_id = $2 AND state IS NOT NULL
           AND segment NOT IN (SELECT segment FROM segments
                               WHERE vessel_id = $1 AND compass_id = $2 AND state IS NOT NULL
                               ORDER BY segment DESC LIMIT $3)",
        vessel,
        compass,
        KEPT_STATES as i64
    )?;
    Ok(())
}

/// Notes the hashes of batches by segment, where they have the samples that are known.
pub async fn note_batches(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    moved: &[(Segment, Hash)],
) -> Result<()> {
    if moved.is_empty() {
        return Ok(());
    }
    let mut tx = db.begin().await?;
    for (segment, batches) in moved {
        execute!(
            &mut tx,
            "UPDATE segments SET batches_sha256 = $4
             WHERE vessel_id = $1 AND compass_id = $2 AND segment = $3",
            vessel,
            compass,
            segment.number(),
            batches.0.to_vec()
        )?;
    }
    tx.commit().await?;
    Ok(())
}

/// A row of diagnoses, with its period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chunk {
    segment: Segment,
    /// Time of its first sample.
    pub from: Time,
    /// The instant after its last.
    pub to: Time,
}

/// Lists the rows with samples in a range of time, to be read one by one.
pub async fn chunks_between(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    from: Option<Time>,
    to: Option<Time>,
) -> Result<Vec<Chunk>> {
    let found = rows!(
        db,
        (i64, Time, Time),
        "SELECT segment, first_sample_at, last_sample_at FROM segments
         WHERE vessel_id = $1 AND compass_id = $2
           AND last_sample_at >= $3 AND first_sample_at < $4
         ORDER BY segment",
        vessel,
        compass,
        from.map_or(i64::MIN, |from| from.0.micros()),
        to.map_or(i64::MAX, |to| to.0.micros())
    )?;
    let chunk = |(segment, first, last): (i64, Time, Time)| Chunk {
        segment: Segment::new(segment),
        from: first,
        to: Time(last.0.plus_seconds(1e-6)),
    };
    Ok(found.into_iter().map(chunk).collect())
}

/// Returns the samples of a row; none if the row no longer exists.
pub async fn chunk(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    chunk: &Chunk,
) -> Result<Vec<SampleDiagnostic>> {
    let found = find_diagnoses(db, vessel, compass, chunk.segment).await?;
    read(db, vessel, compass, found.into_iter().collect()).await
}

/// Returns a compass's samples from one instant until before another, in order of time, each with
/// its outcome in the last analysis.
pub async fn samples(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    from: Option<Time>,
    to: Option<Time>,
) -> Result<Vec<SampleDiagnostic>> {
    let found = rows!(
        db,
        DiagnosesRow,
        "SELECT segment, first_sample_at, last_sample_at, diagnoses FROM segments
         WHERE vessel_id = $1 AND compass_id = $2
           AND last_sample_at >= $3 AND first_sample_at < $4
         ORDER BY segment",
        vessel,
        compass,
        from.map_or(i64::MIN, |from| from.0.micros()),
        to.map_or(i64::MAX, |to| to.0.micros())
    )?;
    let mut samples = read(db, vessel, compass, found).await?;
    samples.retain(|found| {
        let at = Time(found.sample.time);
        from.is_none_or(|from| at >= from) && to.is_none_or(|to| at < to)
    });
    Ok(samples)
}

/// Reads diagnoses with their samples.
async fn read(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    stored: Vec<DiagnosesRow>,
) -> Result<Vec<SampleDiagnostic>> {
    match join(db, vessel, compass, stored).await? {
        Ok(samples) => Ok(samples),
        Err(damaged) => {
            remove(db, vessel, compass, damaged).await?;
            let error = anyhow::anyhow!("stored diagnoses are damaged and will be made again");
            Err(Error::Internal(error))
        }
    }
}

/// Joins diagnoses to their samples, or returns the number of a row that is damaged.
async fn join(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    stored: Vec<DiagnosesRow>,
) -> Result<std::result::Result<Vec<SampleDiagnostic>, i64>> {
    let (Some(first), Some(last)) = (stored.first(), stored.last()) else {
        return Ok(Ok(Vec::new()));
    };
    let (first, last) = (first.first_sample_at.0, last.last_sample_at.0);
    let batches = load_batches(db, vessel, compass, Some(first), Some(last)).await?;
    let joined = tokio::task::spawn_blocking(move || {
        let samples = decode(&batches)?;
        let mut all = Vec::new();
        for row in stored {
            let own = unseal(&row.diagnoses)
                .ok()
                .and_then(|bytes| unpack(&bytes, &samples));
            match own {
                Some(own) => all.extend(own),
                None => return Ok(Err(row.segment)),
            }
        }
        Ok::<_, anyhow::Error>(Ok(all))
    });
    Ok(joined.await??)
}

/// Removes a damaged row, and queues the analysis that makes it again.
async fn remove(db: &Db, vessel: VesselId, compass: CompassId, segment: i64) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM segments WHERE vessel_id = $1 AND compass_id = $2 AND segment = $3",
        vessel,
        compass,
        segment
    )?;
    let now = row!(
        in &mut tx,
        (Time,),
        "SELECT analysed_at FROM analyses WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    let (now,) = now.context("diagnoses without an analysis")?;
    analysis_queue::enqueue(&mut tx, vessel, now, 0.0).await?;
    tx.commit().await?;
    Ok(())
}
