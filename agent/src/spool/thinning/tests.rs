//! Thinning on a real file.

use super::*;
use crate::spool::tests::{accepted, alert, enrolled, identity, restless, sample};
use crate::spool::{Seal, Spool};
use binnacle_compass::angle::CourseOverGround;
use binnacle_compass::sample::SourceId;
use std::collections::BTreeSet;
use tempfile::TempDir;

/// Creates a spool of many days at ten-second samples, more than anybody sends.
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
    let (_directory, spool) = stuffed(400).await;
    let before = spool.status().await.unwrap().used_bytes;
    let limit = before / 2;
    spool.shrink_to_limit(limit).await.unwrap();
    assert!(spool.status().await.unwrap().used_bytes <= limit);
    let batches = all(&spool).await;
    assert_eq!(batches.len(), 400);
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
async fn a_full_disk_is_distinguished_from_other_errors() {
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
async fn a_batch_that_must_fit_loses_course_roll_and_temperature_before_samples() {
    let (_directory, spool) = enrolled().await;
    let samples: Vec<Sample> = (0..60)
        .map(|i| Sample {
            cog: CourseOverGround::new(f64::from(i * 37 % 360)),
            roll_deg: Some(f64::from(i * 13 % 17)),
            roll_spread_deg: Some(f64::from(i * 7 % 11)),
            temperature_c: Some(f64::from(i * 5 % 23)),
            gyro_source: Some(SourceId::from_name("gyro 1")),
            ..sample(i64::from(i) * 10)
        })
        .collect();
    let tally = accepted(60 * 60);
    spool.store(&samples, &tally, Seal::All).await.unwrap();
    let whole = binnacle_wire::encode(&all(&spool).await[0]).unwrap().len();
    spool.thin_batches_to(whole).await.unwrap();
    assert!(all(&spool).await[0].samples[0].cog.is_some());
    spool.thin_batches_to(whole - 1).await.unwrap();
    let batch = &all(&spool).await[0];
    assert_eq!((batch.samples.len(), batch.thinned), (60, None));
    for kept in &batch.samples {
        assert_eq!((kept.cog, kept.temperature_c), (None, None));
        assert_eq!((kept.roll_deg, kept.roll_spread_deg), (None, None));
        assert!(kept.gyro.is_some() && kept.gyro_source.is_some());
    }
}

#[tokio::test]
async fn the_first_batch_reports_samples_thinned_before_enrolment() {
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
    assert!(half_a_year < 64e6 * FULL_SHARE, "{a_window} bytes a window");
    assert!(a_window > 3.0, "{a_window}: the noise is none");
}

#[test]
fn each_level_keeps_the_headings_and_fewer_of_each() {
    let samples: Vec<Sample> = (0..48 * 60)
        .map(|minute| Sample {
            gyro: binnacle_compass::angle::TrueHeading::new(10.0 * (minute / 8 % 36) as f64 + 5.0),
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
