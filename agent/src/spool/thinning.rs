//! Keeps the spool within its limit, and what waits within what the link may cost: what
//! has waited longest is thinned, again and again if need be, and never dropped whole.
//!
//! What always holds:
//!
//! - Bytes that were tried are never touched: the shore may have them.
//! - Evidence of alerts is never touched.
//! - Samples are left out by heading, time and length alone, in each batch by itself,
//!   and the batch says how many. What each window of the tally became can be told.

use super::account::REQUEST_BYTES;
use super::{Spool, THINNED, acknowledged, get, put};
use binnacle_magnetics::angle::TrueHeading;
use binnacle_magnetics::sample::Sample;
use binnacle_wire::batch::Thinned;
use sqlx::SqliteConnection;
use std::collections::BTreeMap;

/// Thinning begins when so much of the limit is used, and goes on until it is less.
const FULL_SHARE: f64 = 0.9;
/// So many batches are thinned in one transaction.
const THIN_AT_ONCE: i64 = 64;
/// Without an identity nothing is sealed: more samples than these are thinned as they are.
pub(crate) const MAX_PENDING: u64 = 20_000;
/// Batches that cannot be read are for a person to look at; more than these are not.
const MAX_QUARANTINED: i64 = 100;
const BIN_DEG: f64 = 10.0;

/// Of each 10° of heading, so many samples in so many seconds. Six an hour cost the
/// estimate nothing, two an hour some 5 % of its error (the study behind
/// docs/science.md); the last one leaves a ship offline for years with a sample for
/// each heading and day.
const LEVELS: [(i64, usize); 5] = [
    (3_600, 6),
    (3_600, 2),
    (3_600, 1),
    (6 * 3_600, 1),
    (24 * 3_600, 1),
];
/// A batch of this level cannot be thinned further; 0 is one that was not thinned.
const MAX_LEVEL: i64 = 5;

/// SQLite's primary result codes for a file that cannot be read or written, as on a disk
/// without room for the journal's index, and for a full disk.
const IO_ERROR: i32 = 10;
const DISK_FULL: i32 = 13;

/// Whether a disk with more room would have helped, as far as can be told.
pub(crate) fn is_disk_full(error: &sqlx::Error) -> bool {
    let sqlx::Error::Database(error) = error else {
        return false;
    };
    let code = error.code().and_then(|code| code.parse::<i32>().ok());
    code.is_some_and(|code| matches!(code & 0xff, IO_ERROR | DISK_FULL))
}

impl Spool {
    /// Thins until what is in use is within the limit, or nothing is left to thin.
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
            // What the shore has goes before what it has not.
            if acknowledged::delete_oldest(&mut tx).await? > 0 {
                tx.commit().await?;
                continue;
            }
            let touched = thin_batches(&mut tx, 0).await? + thin_pending(&mut tx).await?;
            tx.commit().await?;
            if touched == 0 {
                tracing::warn!(limit_bytes, "the spool is full of what cannot be thinned");
                return Ok(());
            }
        }
    }
}

impl Spool {
    /// Thins until what waits costs no more than so many octets to send, or nothing is
    /// left to thin.
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

    /// Thins every batch until it has no more than so many octets, as far as it may be.
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

/// Thins the oldest of those batches, larger than this, that were thinned least; says how
/// many.
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
        let (bytes, samples) = match thin_batch(bytes, level) {
            Ok(thin_batch) => thin_batch,
            Err(problem) => {
                tracing::error!(seq, problem, "a batch cannot be thinned");
                (bytes.clone(), 0)
            }
        };
        // Written anew rather than in place: shorter rows in place leave every page half
        // empty, and none of them free.
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

/// A batch with fewer samples, and how many they are.
fn thin_batch(bytes: &[u8], level: i64) -> Result<(Vec<u8>, i64), String> {
    let mut batch = binnacle_wire::decode(bytes).map_err(|e| e.to_string())?;
    let before = std::mem::take(&mut batch.samples);
    let (kept, dropped) = thin(before, level);
    if dropped.samples == 0 {
        return Ok((bytes.to_vec(), count(&kept)));
    }
    batch.samples = kept;
    batch.thinned = Some(add(batch.thinned.unwrap_or_default(), dropped));
    let bytes = binnacle_wire::encode(&batch).map_err(|e| e.to_string())?;
    Ok((bytes, count(&batch.samples)))
}

/// Thins samples that are not sealed, where there are very many; says how many.
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
        // Little at a time would come back with every sample.
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

/// The samples to keep, and what is left out.
fn thin(samples: Vec<Sample>, level: i64) -> (Vec<Sample>, Thinned) {
    let keep = select_rows(samples.iter(), level);
    let dropped = samples.iter().zip(&keep).filter(|(_, keep)| !**keep);
    let dropped = dropped.fold(Thinned::default(), |all, (sample, _)| {
        add(all, thinned_sample(sample))
    });
    let kept = samples.into_iter().zip(keep).filter(|(_, keep)| *keep);
    (kept.map(|(sample, _)| sample).collect(), dropped)
}

/// Of each heading and time those of the most windows, the earliest of equals.
fn select_rows<'a>(samples: impl Iterator<Item = &'a Sample>, level: i64) -> Vec<bool> {
    let index = usize::try_from(level - 1).unwrap_or_default();
    let (seconds, most) = LEVELS[index.min(LEVELS.len() - 1)];
    let mut groups: BTreeMap<(i64, i64), Vec<(u16, usize)>> = BTreeMap::new();
    let mut rows = 0;
    for sample in samples {
        let reference = sample.gyro.or(sample.satellite);
        let heading_deg = reference.map_or(sample.compass.degrees(), TrueHeading::degrees);
        let time = sample.time.micros().div_euclid(seconds * 1_000_000);
        let bin = (heading_deg / BIN_DEG).floor() as i64;
        let group = groups.entry((time, bin)).or_default();
        group.push((sample.windows, rows));
        rows += 1;
    }
    let mut keep = vec![false; rows];
    for group in groups.values_mut() {
        group.sort_by_key(|(windows, row)| (std::cmp::Reverse(*windows), *row));
        for (_, row) in group.iter().take(most) {
            keep[*row] = true;
        }
    }
    keep
}

fn count(samples: &[Sample]) -> i64 {
    i64::try_from(samples.len()).unwrap_or(i64::MAX)
}

fn thinned_sample(sample: &Sample) -> Thinned {
    Thinned {
        samples: 1,
        windows: u64::from(sample.windows),
    }
}

pub(super) fn add(a: Thinned, b: Thinned) -> Thinned {
    Thinned {
        samples: a.samples.saturating_add(b.samples),
        windows: a.windows.saturating_add(b.windows),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{accepted, alert, identity, restless, sample};
    use super::*;
    use crate::spool::{Seal, Spool};
    use binnacle_wire::batch::Batch;
    use std::collections::BTreeSet;
    use tempfile::TempDir;

    /// A spool of many days at ten-second samples, as nobody sends them.
    async fn stuffed(batches: i64) -> (TempDir, Spool) {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        spool.enrol(&identity(7)).await.unwrap();
        for number in 0..batches {
            let mut samples: Vec<Sample> = (0..240)
                .map(|i| Sample {
                    time: sample(number * 60).time.plus_seconds(15.0 * f64::from(i)),
                    windows: 1 + (i % 3) as u16,
                    sog_kn: Some(f64::from(i * 7_919 % 1_000) / 10.0),
                    spread_deg: Some(f64::from(i * 104_729 % 1_000) / 100.0),
                    ..sample(0)
                })
                .collect();
            samples[17].windows = 60;
            let windows = samples.iter().map(|s| u64::from(s.windows)).sum();
            let tally = accepted(windows);
            spool.store(&samples, &tally, Seal::All).await.unwrap();
        }
        (directory, spool)
    }

    async fn all(spool: &Spool) -> Vec<Batch> {
        let rows: Vec<(Vec<u8>,)> = sqlx::query_as("SELECT bytes FROM batches ORDER BY seq")
            .fetch_all(&spool.pool)
            .await
            .unwrap();
        let read = |(bytes,): &(Vec<u8>,)| binnacle_wire::decode(bytes).unwrap();
        rows.iter().map(read).collect()
    }

    fn windows(batch: &Batch) -> u64 {
        let kept: u64 = batch.samples.iter().map(|s| u64::from(s.windows)).sum();
        kept + batch.thinned.map_or(0, |thinned| thinned.windows)
    }

    #[tokio::test]
    async fn a_full_spool_thins_and_says_so_and_every_window_is_accounted_for() {
        let (_directory, spool) = stuffed(300).await;
        let before = spool.status().await.unwrap().used_bytes;
        let limit = before / 2;
        spool.shrink_to_limit(limit).await.unwrap();
        assert!(spool.status().await.unwrap().used_bytes <= limit);
        let batches = all(&spool).await;
        assert_eq!(batches.len(), 300);
        for (batch, seq) in batches.iter().zip(1..) {
            assert_eq!(batch.seq, seq);
            assert_eq!(windows(batch), batch.tally["accepted"]);
            assert!(!batch.samples.is_empty());
            let longest = batch.samples.iter().map(|s| s.windows).max();
            assert_eq!(longest, Some(60), "the longest is kept");
        }
        let counted: usize = batches.iter().map(|batch| batch.samples.len()).sum();
        let stated: (i64,) = sqlx::query_as("SELECT SUM(samples) FROM batches")
            .fetch_one(&spool.pool)
            .await
            .unwrap();
        assert_eq!(stated.0, i64::try_from(counted).unwrap());
        assert!(batches.iter().any(|batch| batch.thinned.is_some()));
    }

    #[tokio::test]
    async fn a_full_disk_is_told_from_other_trouble() {
        let (_directory, spool) = stuffed(1).await;
        sqlx::query("PRAGMA max_page_count = 1")
            .execute(&spool.pool)
            .await
            .unwrap();
        let many: Vec<Sample> = (0..5_000).map(restless).collect();
        let full = spool.store(&many, &accepted(1), Seal::Full).await;
        assert!(is_disk_full(&full.unwrap_err()));
        sqlx::query("PRAGMA max_page_count = 100000")
            .execute(&spool.pool)
            .await
            .unwrap();
        let stored = spool.store(&many[..9], &accepted(1), Seal::Full).await;
        assert_eq!(
            stored.unwrap().0.samples,
            9,
            "it goes on when there is room"
        );
        let wrong = sqlx::query("SELECT nothing").execute(&spool.pool).await;
        assert!(!is_disk_full(&wrong.unwrap_err()));
    }

    #[tokio::test]
    async fn a_backlog_beyond_the_budget_is_thinned_the_oldest_first_and_no_further() {
        let (_directory, spool) = stuffed(300).await;
        let mut connection = spool.pool.acquire().await.unwrap();
        let before = backlog_bytes(&mut connection).await.unwrap();
        drop(connection);
        spool.thin_backlog(before).await.unwrap();
        assert!(
            all(&spool)
                .await
                .iter()
                .all(|batch| batch.thinned.is_none())
        );
        spool.thin_backlog(before * 3 / 4).await.unwrap();
        let batches = all(&spool).await;
        assert!(batches[0].thinned.is_some() && batches[299].thinned.is_none());
        assert!(batches.iter().all(|b| windows(b) == b.tally["accepted"]));
        let mut connection = spool.pool.acquire().await.unwrap();
        assert!(backlog_bytes(&mut connection).await.unwrap() <= before * 3 / 4);
    }

    #[tokio::test]
    async fn what_was_tried_and_what_is_evidence_stays_to_the_byte() {
        let (_directory, spool) = stuffed(40).await;
        let evidence: Vec<Sample> = (0..100).map(|i| sample(90_000 + i)).collect();
        spool
            .store_evidence(&evidence, &accepted(1), &[alert(2)], None)
            .await
            .unwrap();
        let urgent = spool.next_batch().await.unwrap().unwrap();
        assert!(urgent.urgent);
        spool.park(urgent.seq, "refused").await.unwrap();
        let tried = spool.next_batch().await.unwrap().unwrap();
        assert!(spool.mark_tried(&tried).await.unwrap());
        spool.shrink_to_limit(1).await.unwrap();
        spool.unpark().await.unwrap();
        assert_eq!(spool.next_batch().await.unwrap().unwrap(), urgent);
        let batches = all(&spool).await;
        assert_eq!(batches[0], binnacle_wire::decode(&tried.bytes).unwrap());
        assert_eq!(batches[40].alerts, [alert(2)]);
        assert!(batches[1..40].iter().all(|batch| batch.samples.len() <= 2));
    }

    #[tokio::test]
    async fn a_batch_that_was_thinned_after_it_was_read_is_not_sent_as_it_was() {
        let (_directory, spool) = stuffed(3).await;
        let stale = spool.next_batch().await.unwrap().unwrap();
        spool.shrink_to_limit(1).await.unwrap();
        assert!(!spool.mark_tried(&stale).await.unwrap());
        let fresh = spool.next_batch().await.unwrap().unwrap();
        assert_ne!(fresh.bytes, stale.bytes);
        assert!(spool.mark_tried(&fresh).await.unwrap());
    }

    #[tokio::test]
    async fn what_was_thinned_before_enrolment_is_said_in_the_first_batch() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let samples: Vec<Sample> = (0..21_000).map(sample).collect();
        let tally = accepted(1);
        spool.store(&samples, &tally, Seal::All).await.unwrap();
        spool.shrink_to_limit(1).await.unwrap();
        let left = spool.pending().await.unwrap().samples;
        assert!(left < 16_000, "{left}");
        spool.enrol(&identity(7)).await.unwrap();
        let tally = accepted(0);
        spool.store(&[], &tally, Seal::All).await.unwrap();
        let batches = all(&spool).await;
        let thinned: u64 = batches
            .iter()
            .filter_map(|batch| batch.thinned)
            .map(|t| t.samples)
            .sum();
        assert_eq!(left + thinned, 21_000);
    }

    #[tokio::test]
    async fn half_a_year_fits_even_with_a_sample_of_every_window() {
        const WINDOWS_A_DAY: i64 = 8_640;
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        spool.enrol(&identity(7)).await.unwrap();
        let empty = spool.status().await.unwrap().used_bytes;
        let windows: Vec<Sample> = (0..3 * WINDOWS_A_DAY).map(restless).collect();
        for quarter_day in windows.chunks(2_160) {
            let tally = accepted(2_160);
            spool.store(quarter_day, &tally, Seal::All).await.unwrap();
        }
        let used = spool.status().await.unwrap().used_bytes - empty;
        let a_window = used as f64 / windows.len() as f64;
        let half_a_year = a_window * 180.0 * WINDOWS_A_DAY as f64;
        assert!(
            half_a_year < 64e6 * FULL_SHARE,
            "{a_window} octets a window"
        );
        assert!(a_window > 3.0, "{a_window}: the noise is none");
    }

    #[test]
    fn each_level_keeps_the_headings_and_fewer_of_each() {
        let samples: Vec<Sample> = (0..48 * 60)
            .map(|minute| Sample {
                gyro: binnacle_magnetics::angle::TrueHeading::new(
                    10.0 * (minute / 8 % 36) as f64 + 5.0,
                ),
                ..sample(minute)
            })
            .collect();
        let mut before = samples.len() + 1;
        for level in 1..=MAX_LEVEL {
            let (kept, dropped) = thin(samples.clone(), level);
            assert!(kept.len() < before, "{level}");
            before = kept.len();
            assert_eq!(kept.len() as u64 + dropped.samples, samples.len() as u64);
            let bins: BTreeSet<i64> = kept
                .iter()
                .map(|s| (s.gyro.unwrap().degrees() / 10.0) as i64)
                .collect();
            assert_eq!(bins.len(), 36, "{level}");
        }
    }
}
