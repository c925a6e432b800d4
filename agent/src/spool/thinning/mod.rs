//! Thinning of the spool to its disk limit, and of the backlog to the budget. The oldest batches
//! are thinned first, repeatedly if necessary, and never dropped as a whole.
//!
//! Invariants:
//!
//! - Tried bytes are never changed: the server may have them.
//! - Evidence of alerts is never changed.
//! - Samples are dropped by heading, time and length alone, in each batch by itself, and the batch
//!   says how many. Every window of the tally remains accounted for.

mod selection;

pub(super) use selection::add;

use super::account::REQUEST_BYTES;
use super::acknowledged;
use super::database::{Spool, get, put};
use super::keys::THINNED;
use binnacle_compass::sample::Sample;
use binnacle_wire::batch::{Batch, Thinned};
use selection::{MAX_LEVEL, select_rows, thin, thinned_sample};
use sqlx::SqliteConnection;

/// Share of the disk limit above which batches are thinned.
const FULL_SHARE: f64 = 0.9;
/// Batches thinned in one transaction.
const THIN_AT_ONCE: i64 = 64;
/// Limit on pending samples: without an identity nothing is sealed, so they are thinned unsealed.
pub(crate) const MAX_PENDING: u64 = 20_000;
/// Limit on unreadable batches kept for inspection.
const MAX_QUARANTINED: i64 = 100;

/// SQLite's primary result codes for a file that cannot be read or written, as on a disk without
/// space for the journal's index, and for a full disk.
const IO_ERROR: i32 = 10;
const DISK_FULL: i32 = 13;

/// Returns whether more disk space would probably have helped.
pub(crate) fn is_disk_full(error: &sqlx::Error) -> bool {
    let sqlx::Error::Database(error) = error else {
        return false;
    };
    let code = error.code().and_then(|code| code.parse::<i32>().ok());
    code.is_some_and(|code| matches!(code & 0xff, IO_ERROR | DISK_FULL))
}

impl Spool {
    /// Thins until the used space is within the limit, or nothing is left to thin.
    pub(crate) async fn shrink_to_limit(&self, limit_bytes: u64) -> sqlx::Result<()> {
        let full = (limit_bytes as f64 * FULL_SHARE) as u64;
        loop {
            let mut tx = self.write().await?;
            if used_bytes(&mut tx).await? <= full {
                return Ok(());
            }
            sqlx::query("DELETE FROM quarantine WHERE id <= (SELECT MAX(id) FROM quarantine) - $1")
                .bind(MAX_QUARANTINED)
                .execute(&mut *tx)
                .await?;
            // Delete what the server has before anything else.
            if acknowledged::delete_oldest(&mut tx).await? > 0 {
                tx.commit().await?;
                continue;
            }
            let touched = thin_batches(&mut tx, 0).await? + thin_pending(&mut tx).await?;
            tx.commit().await?;
            if touched == 0 {
                tracing::warn!(limit_bytes, "the spool is full and nothing is left to thin");
                return Ok(());
            }
        }
    }
}

impl Spool {
    /// Thins until the backlog costs no more than `limit_bytes` to send, or nothing is left to
    /// thin.
    pub(crate) async fn thin_backlog(&self, limit_bytes: u64) -> sqlx::Result<()> {
        loop {
            let mut tx = self.write().await?;
            if backlog_bytes(&mut tx).await? <= limit_bytes || thin_batches(&mut tx, 0).await? == 0
            {
                return Ok(());
            }
            tx.commit().await?;
        }
    }

    /// Thins every batch larger than `max_bytes`, as far as possible.
    pub(crate) async fn thin_batches_to(&self, max_bytes: usize) -> sqlx::Result<()> {
        loop {
            let mut tx = self.write().await?;
            if thin_batches(&mut tx, max_bytes).await? == 0 {
                return Ok(());
            }
            tx.commit().await?;
        }
    }
}

async fn backlog_bytes(connection: &mut SqliteConnection) -> sqlx::Result<u64> {
    let (bytes, batches): (i64, i64) = sqlx::query_as(
        "SELECT COALESCE(SUM(LENGTH(bytes)), 0), COUNT(*) FROM batches
         WHERE standing = 'waiting'",
    )
    .fetch_one(connection)
    .await?;
    Ok(bytes.unsigned_abs() + batches.unsigned_abs() * REQUEST_BYTES)
}

pub(super) async fn used_bytes(connection: &mut SqliteConnection) -> sqlx::Result<u64> {
    let (pages, free, size): (i64, i64, i64) = sqlx::query_as(
        "SELECT page_count, freelist_count, page_size
         FROM pragma_page_count, pragma_freelist_count, pragma_page_size",
    )
    .fetch_one(connection)
    .await?;
    Ok(((pages - free) * size).unsigned_abs())
}

/// Thins the oldest of the least thinned batches that are larger than `min_bytes`. Returns their
/// number.
async fn thin_batches(tx: &mut SqliteConnection, min_bytes: usize) -> sqlx::Result<usize> {
    let rows: Vec<(i64, Vec<u8>, i64)> = sqlx::query_as(
        "SELECT seq, bytes, thinned FROM batches
         WHERE standing <> 'acknowledged' AND NOT tried AND NOT urgent AND thinned < $1
               AND LENGTH(bytes) > $3
         ORDER BY thinned, seq LIMIT $2",
    )
    .bind(MAX_LEVEL)
    .bind(THIN_AT_ONCE)
    .bind(i64::try_from(min_bytes).unwrap_or(i64::MAX))
    .fetch_all(&mut *tx)
    .await?;
    for (seq, bytes, level) in &rows {
        let level = level + 1;
        let (bytes, samples) = match thin_batch(bytes, level, min_bytes) {
            Ok(thin_batch) => thin_batch,
            Err(problem) => {
                tracing::error!(seq, problem, "a batch cannot be thinned");
                (bytes.clone(), 0)
            }
        };
        // Replaced rather than updated: shorter rows in place leave every page half empty, and none
        // of them free.
        sqlx::query(
            "INSERT OR REPLACE INTO batches
                    (seq, bytes, samples, standing, problem, urgent, tried, thinned)
             SELECT seq, $2, CASE WHEN $4 > 0 THEN $4 ELSE samples END,
                    standing, problem, urgent, tried, $3
             FROM batches WHERE seq = $1",
        )
        .bind(seq)
        .bind(bytes)
        .bind(level)
        .bind(samples)
        .execute(&mut *tx)
        .await?;
    }
    Ok(rows.len())
}

/// Returns a batch with fewer samples, and their number. What must fit into `max_bytes`, if not
/// zero, and does not, loses course, roll and temperature.
fn thin_batch(bytes: &[u8], level: i64, max_bytes: usize) -> Result<(Vec<u8>, i64), String> {
    let mut batch = binnacle_wire::decode(bytes).map_err(|e| e.to_string())?;
    let encode = |batch: &Batch| binnacle_wire::encode(batch).map_err(|e| e.to_string());
    let before = std::mem::take(&mut batch.samples);
    let (kept, dropped) = thin(before, level);
    batch.samples = kept;
    let mut thinned = bytes.to_vec();
    if dropped.samples > 0 {
        batch.thinned = Some(add(batch.thinned.unwrap_or_default(), dropped));
        thinned = encode(&batch)?;
    }
    if max_bytes > 0 && thinned.len() > max_bytes {
        batch.samples.iter_mut().for_each(keep_headings);
        thinned = encode(&batch)?;
    }
    Ok((thinned, count(&batch.samples)))
}

/// Removes what a model can be made without.
fn keep_headings(sample: &mut Sample) {
    *sample = Sample {
        cog: None,
        roll_deg: None,
        roll_spread_deg: None,
        temperature_c: None,
        ..*sample
    };
}

/// Thins pending samples when there are too many. Returns the number of dropped ones.
async fn thin_pending(tx: &mut SqliteConnection) -> sqlx::Result<usize> {
    let rows: Vec<(i64, String)> = sqlx::query_as(
        "SELECT id, sample FROM pending_samples
         WHERE (SELECT COUNT(*) FROM pending_samples) > $1 ORDER BY time_micros, id",
    )
    .bind(MAX_PENDING.cast_signed())
    .fetch_all(&mut *tx)
    .await?;
    if rows.is_empty() {
        return Ok(0);
    }
    let read = |(id, text): &(i64, String)| Some((*id, serde_json::from_str::<Sample>(text).ok()?));
    let samples: Vec<(i64, Sample)> = rows.iter().filter_map(read).collect();
    for level in 1..=MAX_LEVEL {
        let keep = select_rows(samples.iter().map(|(_, sample)| sample), level);
        let dropped: Vec<&(i64, Sample)> = samples
            .iter()
            .zip(&keep)
            .filter(|(_, keep)| !**keep)
            .map(|(row, _)| row)
            .collect();
        // Small steps would come back with every sample.
        if dropped.len() * 4 < samples.len() && level < MAX_LEVEL {
            continue;
        }
        let mut thinned = get::<Thinned>(tx, THINNED).await?.unwrap_or_default();
        for (id, sample) in &dropped {
            sqlx::query("DELETE FROM pending_samples WHERE id = $1")
                .bind(id)
                .execute(&mut *tx)
                .await?;
            thinned = add(thinned, thinned_sample(sample));
        }
        put(tx, THINNED, &thinned).await?;
        return Ok(dropped.len());
    }
    Ok(0)
}

fn count(samples: &[Sample]) -> i64 {
    i64::try_from(samples.len()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests;
