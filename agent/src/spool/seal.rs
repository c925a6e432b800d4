//! Sealing of samples into batches, in one transaction.

use super::database::{Spool, forget, get, put};
use super::identity::Identity;
use super::keys::{ALERT, IDENTITY, NEXT_SEQ, THINNED};
use crate::alert::AlertRecord;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_wire::alert::ShipAlert;
use binnacle_wire::batch::Batch;
use binnacle_wire::codec;
use sqlx::SqliteConnection;
use std::collections::BTreeMap;

/// Samples at which a batch is sealed, some 4 kB: the cost of a connection is small beside it.
pub(crate) const SAMPLES_PER_BATCH: u32 = 512;

/// Extent of sealing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seal {
    /// Full batches only.
    Full,
    /// Everything, including the tally.
    All,
}

/// Unsealed samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Pending {
    /// Number of samples.
    pub(crate) samples: u64,
    /// Time of the first sample.
    pub(crate) since: Option<Timestamp>,
}

impl Spool {
    /// Adds samples and counted windows, and seals. Nothing is sealed without an identity, because
    /// there is no stream to number it in. Returns what remains pending and how many batches were
    /// sealed.
    pub(crate) async fn store(
        &self,
        samples: &[Sample],
        tally: &BTreeMap<String, u64>,
        seal: Seal,
    ) -> sqlx::Result<(Pending, usize)> {
        let mut tx = self.write().await?;
        for sample in samples {
            insert_sample(&mut tx, sample).await?;
        }
        for (reason, windows) in tally {
            add_to_tally(&mut tx, reason, *windows).await?;
        }
        let mut sealed = 0;
        let mut pending = pending(&mut tx).await?;
        if let Some(identity) = get::<Identity>(&mut tx, IDENTITY).await? {
            while pending.samples >= u64::from(SAMPLES_PER_BATCH)
                || (seal == Seal::All && (pending.samples > 0 || sealed == 0))
            {
                if !seal_one(&mut tx, &identity, &[]).await? {
                    break;
                }
                sealed += 1;
                pending = self::pending(&mut tx).await?;
            }
        }
        tx.commit().await?;
        Ok((pending, sealed))
    }

    /// Adds samples and counted windows, and seals everything as evidence of alerts, which go with
    /// the newest samples. The record of the last alert is stored in the same transaction.
    pub(crate) async fn store_evidence(
        &self,
        samples: &[Sample],
        tally: &BTreeMap<String, u64>,
        alerts: &[ShipAlert],
        record: Option<&AlertRecord>,
    ) -> sqlx::Result<(Pending, usize)> {
        let mut tx = self.write().await?;
        for sample in samples {
            insert_sample(&mut tx, sample).await?;
        }
        for (reason, windows) in tally {
            add_to_tally(&mut tx, reason, *windows).await?;
        }
        if let Some(record) = record {
            put(&mut tx, ALERT, record).await?;
        }
        let mut sealed = 0;
        if let Some(identity) = get::<Identity>(&mut tx, IDENTITY).await? {
            if alerts.iter().any(|alert| alert.revision == 1) {
                // The batch sealed last lies just before the alert.
                prioritise_newest(&mut tx).await?;
            }
            while pending(&mut tx).await?.samples > u64::from(SAMPLES_PER_BATCH) {
                sealed += usize::from(seal_one(&mut tx, &identity, &[]).await?);
                prioritise_newest(&mut tx).await?;
            }
            sealed += usize::from(seal_one(&mut tx, &identity, alerts).await?);
        }
        let pending = pending(&mut tx).await?;
        tx.commit().await?;
        Ok((pending, sealed))
    }

    /// Returns the unsealed samples.
    pub(crate) async fn pending(&self) -> sqlx::Result<Pending> {
        let mut connection = self.pool.acquire().await?;
        pending(&mut connection).await
    }
}

async fn insert_sample(tx: &mut SqliteConnection, sample: &Sample) -> sqlx::Result<()> {
    if let Err(error) = codec::check(sample, 0) {
        tracing::error!(%error, "a sample that no batch can carry was dropped");
        return add_to_tally(tx, "unsendable", u64::from(sample.windows)).await;
    }
    let text = serde_json::to_string(sample).map_err(|e| sqlx::Error::Encode(e.into()))?;
    sqlx::query("INSERT INTO pending_samples (time_micros, sample) VALUES ($1, $2)")
        .bind(sample.time.micros())
        .bind(text)
        .execute(tx)
        .await?;
    Ok(())
}

async fn add_to_tally(tx: &mut SqliteConnection, reason: &str, windows: u64) -> sqlx::Result<()> {
    sqlx::query(
        "INSERT INTO pending_tally (reason, windows) VALUES ($1, $2)
         ON CONFLICT (reason) DO UPDATE SET windows = windows + excluded.windows",
    )
    .bind(reason)
    .bind(i64::try_from(windows).unwrap_or(i64::MAX))
    .execute(tx)
    .await?;
    Ok(())
}

async fn pending(connection: &mut SqliteConnection) -> sqlx::Result<Pending> {
    let (samples, since): (i64, Option<i64>) =
        sqlx::query_as("SELECT COUNT(*), MIN(time_micros) FROM pending_samples")
            .fetch_one(connection)
            .await?;
    Ok(Pending {
        samples: samples.unsigned_abs(),
        since: since.and_then(|micros| Timestamp::from_micros(micros).ok()),
    })
}

/// Moves the batch sealed last to the front, if it waits.
async fn prioritise_newest(tx: &mut SqliteConnection) -> sqlx::Result<()> {
    sqlx::query(
        "UPDATE batches SET urgent = TRUE
         WHERE standing = 'waiting' AND seq = (SELECT MAX(seq) FROM batches)",
    )
    .execute(tx)
    .await?;
    Ok(())
}

/// Seals the oldest samples, the whole tally, and alerts; `false` when there is nothing.
async fn seal_one(
    tx: &mut SqliteConnection,
    identity: &Identity,
    alerts: &[ShipAlert],
) -> sqlx::Result<bool> {
    let rows: Vec<(i64, String)> = sqlx::query_as(
        "DELETE FROM pending_samples WHERE id IN
         (SELECT id FROM pending_samples ORDER BY time_micros, id LIMIT $1)
         RETURNING id, sample",
    )
    .bind(SAMPLES_PER_BATCH)
    .fetch_all(&mut *tx)
    .await?;
    let tally: Vec<(String, i64)> =
        sqlx::query_as("DELETE FROM pending_tally RETURNING reason, windows")
            .fetch_all(&mut *tx)
            .await?;
    if rows.is_empty() && tally.is_empty() && alerts.is_empty() {
        return Ok(false);
    }
    let mut samples: Vec<Sample> = rows
        .iter()
        .filter_map(|(_, text)| read_sample(text))
        .collect();
    samples.sort_by_key(|sample| sample.time);
    let thinned = get(tx, THINNED).await?;
    if thinned.is_some() {
        forget(tx, THINNED).await?;
    }
    let seq = next_seq(tx).await?;
    let count = samples.len();
    let batch = Batch {
        stream: identity.stream,
        seq,
        samples,
        tally: tally
            .into_iter()
            .map(|(reason, windows)| (reason, windows.unsigned_abs()))
            .collect(),
        alerts: alerts.to_vec(),
        thinned,
    };
    let bytes = binnacle_wire::encode(&batch).map_err(|e| sqlx::Error::Encode(e.into()))?;
    insert_batch(tx, seq, &bytes, count, !alerts.is_empty()).await?;
    put(tx, NEXT_SEQ, &(seq + 1)).await?;
    Ok(true)
}

/// Returns the next free number, never that of an existing batch, even when damage took the
/// counter.
async fn next_seq(tx: &mut SqliteConnection) -> sqlx::Result<u64> {
    let highest: Option<i64> = sqlx::query_scalar("SELECT MAX(seq) FROM batches")
        .fetch_one(&mut *tx)
        .await?;
    let free = highest.map_or(1, |seq| seq.cast_unsigned() + 1);
    Ok(get::<u64>(tx, NEXT_SEQ).await?.unwrap_or(1).max(free))
}

fn log_dropped_sample(error: impl std::fmt::Display) {
    tracing::error!(%error, "a damaged sample was dropped");
}

fn read_sample(text: &str) -> Option<Sample> {
    let sample: Sample = serde_json::from_str(text)
        .map_err(log_dropped_sample)
        .ok()?;
    // Damage on the disk may leave a readable number that no batch can carry. It must not keep the
    // other samples from being sealed.
    codec::check(&sample, 0).map_err(log_dropped_sample).ok()?;
    Some(sample)
}

/// Inserts a sealed batch that waits to be sent.
pub(super) async fn insert_batch(
    tx: &mut SqliteConnection,
    seq: u64,
    bytes: &[u8],
    samples: usize,
    urgent: bool,
) -> sqlx::Result<()> {
    sqlx::query(
        "INSERT INTO batches (seq, bytes, samples, standing, urgent, tried)
         VALUES ($1, $2, $3, 'waiting', $4, FALSE)",
    )
    .bind(seq.cast_signed())
    .bind(bytes)
    .bind(i64::try_from(samples).unwrap_or(i64::MAX))
    .bind(urgent)
    .execute(tx)
    .await?;
    Ok(())
}
