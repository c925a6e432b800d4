//! The spool on a real file.

mod alerts;

use super::acknowledged::NeverSent;
use super::*;
use crate::alert::AlertRecord;
use crate::sampler::Exclusion;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::StreamId;
use binnacle_wire::messages::{CardWithdrawn, Downlink, Settings};
use std::collections::BTreeMap;
use tempfile::TempDir;
use uuid::Uuid;

pub(crate) fn sample(minute: i64) -> Sample {
    let time = Timestamp::from_micros((1_700_000_000 + minute * 60) * 1_000_000).unwrap();
    let position = Position::new(43.0, -3.0).unwrap();
    Sample {
        gyro: TrueHeading::new(98.0),
        sog_kn: Some(12.0),
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.1),
        windows: 60,
        ..Sample::new(time, position, CompassHeading::new(100.0).unwrap())
    }
}

pub(crate) fn identity(stream: u128) -> Identity {
    Identity {
        server: "http://127.0.0.1:1".to_owned(),
        token: "secret-token".to_owned(),
        other_token: None,
        stream: StreamId(Uuid::from_u128(stream)),
        vessel_name: "Txori".to_owned(),
        compass_name: "Standard compass".to_owned(),
    }
}

pub(crate) fn downlink(contiguous_seq: u64) -> Downlink {
    Downlink {
        contiguous_seq,
        model: None,
        unread: None,
        card_withdrawn: None,
        settings: None,
        server_time: sample(0).time,
    }
}

pub(crate) fn accepted(windows: u64) -> BTreeMap<String, u64> {
    BTreeMap::from([("accepted".to_owned(), windows)])
}

/// Returns a ten-second sample with noise in every column: the densest that any settings allow, and
/// the least compressible.
pub(crate) fn restless(window: i64) -> Sample {
    // Multiplicative hashing: noise that is the same in every run.
    let noise = |column: i64| {
        let mixed = (window * 10 + column).cast_unsigned() + 1;
        let mixed = mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        f64::from(((mixed ^ (mixed >> 29)) >> 40) as u32 & 0xffff) / 65_536.0
    };
    let heading_deg = 97.0 + 4.0 * noise(0);
    Sample {
        time: sample(0).time.plus_seconds(10.0 * window as f64),
        compass: CompassHeading::new(heading_deg + 2.0 * noise(1)).unwrap(),
        gyro: TrueHeading::new(heading_deg),
        satellite: TrueHeading::new(heading_deg + noise(2)),
        sog_kn: Some(12.0 + 3.0 * noise(3)),
        rate_of_turn_deg_min: Some(10.0 * noise(4) - 5.0),
        spread_deg: Some(noise(5)),
        windows: 1,
        ..sample(0)
    }
}

impl Spool {
    /// Damages a byte of a batch.
    pub(crate) async fn damage(&self, seq: i64) {
        sqlx::query(
            "UPDATE batches SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) || x'00' AS BLOB)
             WHERE seq = $1",
        )
        .bind(seq)
        .execute(&self.pool)
        .await
        .unwrap();
    }
}

pub(crate) async fn enrolled() -> (TempDir, Spool) {
    let directory = TempDir::new().unwrap();
    let spool = Spool::open(directory.path()).await.unwrap();
    spool.enrol(&identity(7)).await.unwrap();
    (directory, spool)
}

/// The next batch, marked as sent.
pub(crate) async fn next_sent(spool: &Spool) -> Option<SealedBatch> {
    let batch = spool.next_batch().await.unwrap()?;
    assert!(spool.mark_tried(&batch).await.unwrap());
    Some(batch)
}

pub(crate) async fn seal(spool: &Spool, minutes: std::ops::Range<i64>) {
    let samples: Vec<Sample> = minutes.map(sample).collect();
    spool
        .store(&samples, &accepted(60), Seal::All)
        .await
        .unwrap();
}

#[tokio::test]
async fn a_sealed_batch_holds_the_samples_and_the_tally_once() {
    let (_directory, spool) = enrolled().await;
    spool
        .store(&[sample(1)], &accepted(60), Seal::Full)
        .await
        .unwrap();
    assert_eq!(spool.next_batch().await.unwrap(), None);
    let (pending, sealed) = spool
        .store(&[sample(0)], &accepted(30), Seal::All)
        .await
        .unwrap();
    assert_eq!((pending, sealed), (Pending::default(), 1));
    let sent = spool.next_batch().await.unwrap().unwrap();
    let batch = binnacle_wire::decode(&sent.bytes).unwrap();
    assert_eq!(
        (sent.seq, batch.seq, batch.stream),
        (1, 1, identity(7).stream)
    );
    assert_eq!(batch.tally, accepted(90));
    let times: Vec<Timestamp> = batch.samples.iter().map(|s| s.time).collect();
    assert_eq!(times, [sample(0).time, sample(1).time]);
    let (_, sealed) = spool.store(&[], &BTreeMap::new(), Seal::All).await.unwrap();
    assert_eq!(sealed, 0, "nothing is left to seal");
}

#[tokio::test]
async fn before_enrolment_samples_wait_and_then_go_in_batches_of_512() {
    let directory = TempDir::new().unwrap();
    let spool = Spool::open(directory.path()).await.unwrap();
    seal(&spool, 0..600).await;
    assert_eq!(spool.pending().await.unwrap().samples, 600);
    spool.enrol(&identity(7)).await.unwrap();
    let (pending, sealed) = spool
        .store(&[], &BTreeMap::new(), Seal::Full)
        .await
        .unwrap();
    assert_eq!((pending.samples, sealed), (600 - 512, 1));
    assert_eq!(pending.since, Some(sample(512).time));
}

#[tokio::test]
async fn samples_go_before_counts_without_any() {
    let (_directory, spool) = enrolled().await;
    let counts = BTreeMap::from([("slow".to_owned(), 4)]);
    spool.store(&[], &counts, Seal::All).await.unwrap();
    seal(&spool, 1..2).await;
    let first = spool.next_batch().await.unwrap().unwrap();
    assert_eq!((first.seq, first.samples), (2, 1));
    spool.park(2, "refused").await.unwrap();
    assert_eq!(spool.next_batch().await.unwrap().unwrap().seq, 1);
}

#[tokio::test]
async fn a_batch_goes_only_when_it_and_all_before_it_are_acknowledged() {
    let (_directory, spool) = enrolled().await;
    for minute in 0..3 {
        seal(&spool, minute..minute + 1).await;
    }
    let stream = identity(7).stream;
    let first = next_sent(&spool).await.unwrap();
    spool.park(1, "unreadable").await.unwrap();
    let second = next_sent(&spool).await.unwrap();
    assert_eq!(second.seq, 2);
    spool
        .acknowledge(stream, &second, &downlink(0))
        .await
        .unwrap()
        .unwrap();
    assert!(!spool.has_unfillable_gap(0).await.unwrap());
    let status = spool.status().await.unwrap();
    assert_eq!((status.waiting_batches, status.parked_batches), (1, 1));
    assert_eq!(status.parked_because.as_deref(), Some("unreadable"));
    spool.unpark().await.unwrap();
    spool
        .acknowledge(stream, &first, &downlink(2))
        .await
        .unwrap()
        .unwrap();
    let status = spool.status().await.unwrap();
    assert_eq!(
        (status.acknowledged_batches, status.acknowledged_samples),
        (2, 2)
    );
    assert_eq!((status.waiting_batches, status.contiguous_seq), (1, 2));
    assert_eq!(spool.next_batch().await.unwrap().unwrap().seq, 3);
    assert!(!spool.has_unfillable_gap(1).await.unwrap());
}

#[tokio::test]
async fn an_acknowledgement_beyond_what_was_sent_is_refused_and_changes_nothing() {
    let (_directory, spool) = enrolled().await;
    for minute in 0..3 {
        seal(&spool, minute..minute + 1).await;
    }
    let stream = identity(7).stream;
    let first = next_sent(&spool).await.unwrap();
    let acknowledged = spool.acknowledge(stream, &first, &downlink(1)).await;
    assert_eq!(acknowledged.unwrap(), Ok(()));
    let second = next_sent(&spool).await.unwrap();
    let before = spool.status().await.unwrap();
    for claimed in [3, 99, u64::MAX] {
        let mut response = downlink(claimed);
        // Late enough to delete what was acknowledged a month ago.
        response.server_time = response.server_time.plus_seconds(40.0 * 86_400.0);
        let refused = spool.acknowledge(stream, &second, &response).await.unwrap();
        assert_eq!(refused, Err(NeverSent { claimed, sent: 2 }));
        assert_eq!(spool.status().await.unwrap(), before);
        assert_eq!(spool.next_batch().await.unwrap().unwrap(), second);
    }
    let kept: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM batches")
        .fetch_one(&spool.pool)
        .await
        .unwrap();
    assert_eq!(kept, 3);
    let acknowledged = spool.acknowledge(stream, &second, &downlink(2)).await;
    assert_eq!(acknowledged.unwrap(), Ok(()));
}

#[tokio::test]
async fn a_new_stream_numbers_what_is_left_from_one() {
    let (_directory, spool) = enrolled().await;
    for minute in 0..3 {
        seal(&spool, minute..minute + 1).await;
    }
    let first = next_sent(&spool).await.unwrap();
    spool
        .acknowledge(identity(7).stream, &first, &downlink(1))
        .await
        .unwrap()
        .unwrap();
    spool
        .move_to_stream(StreamId(Uuid::from_u128(8)))
        .await
        .unwrap();
    let moved = spool.next_batch().await.unwrap().unwrap();
    let batch = binnacle_wire::decode(&moved.bytes).unwrap();
    assert_eq!((moved.seq, batch.seq, batch.stream.0.as_u128()), (1, 1, 8));
    assert_eq!(batch.samples[0].time, sample(1).time);
    assert_eq!(
        spool.identity().await.unwrap().unwrap().stream.0.as_u128(),
        8
    );
    seal(&spool, 9..10).await;
    assert_eq!(spool.status().await.unwrap().waiting_batches, 3);
    assert!(!spool.has_unfillable_gap(0).await.unwrap());
}

#[tokio::test]
async fn a_damaged_batch_is_put_aside_and_the_others_go_on() {
    let (_directory, spool) = enrolled().await;
    seal(&spool, 0..1).await;
    seal(&spool, 1..2).await;
    sqlx::query("UPDATE batches SET bytes = x'00' WHERE seq = 1")
        .execute(&spool.pool)
        .await
        .unwrap();
    spool
        .move_to_stream(StreamId(Uuid::from_u128(8)))
        .await
        .unwrap();
    let moved = spool.next_batch().await.unwrap().unwrap();
    assert_eq!(
        binnacle_wire::decode(&moved.bytes).unwrap().samples[0].time,
        sample(1).time
    );
}

#[tokio::test]
async fn a_hold_that_cannot_be_read_is_still_a_hold() {
    let (_directory, spool) = enrolled().await;
    assert_eq!(spool.exclusion().await.unwrap(), None);
    sqlx::query("INSERT INTO state (name, value) VALUES ('hold', '\"degau')")
        .execute(&spool.pool)
        .await
        .unwrap();
    assert_eq!(spool.exclusion().await.unwrap(), Some(Exclusion::Berthed));
    spool.set_exclusion(None).await.unwrap();
    assert_eq!(spool.exclusion().await.unwrap(), None);
}

/// The last free bytes of a disk are for samples.
#[tokio::test]
async fn the_journal_stays_small_however_often_something_is_stored() {
    let (directory, spool) = enrolled().await;
    for window in 0..300 {
        spool
            .store(&[restless(window)], &BTreeMap::new(), Seal::Full)
            .await
            .unwrap();
    }
    let journal = std::fs::metadata(directory.path().join("spool.db-wal")).unwrap();
    assert!(journal.len() < 600_000, "{} bytes", journal.len());
}

#[tokio::test]
async fn everything_is_there_after_opening_again() {
    let (directory, spool) = enrolled().await;
    seal(&spool, 0..1).await;
    spool
        .store(&[sample(5)], &BTreeMap::new(), Seal::Full)
        .await
        .unwrap();
    spool.set_exclusion(Some(Exclusion::Berthed)).await.unwrap();
    let settings = Settings {
        version: 4,
        min_sog_kn: 6.0,
        ..Settings::default()
    };
    let downlink_with_settings = Downlink {
        settings: Some(settings.clone()),
        ..downlink(0)
    };
    spool.save_downlink(&downlink_with_settings).await.unwrap();
    drop(spool);
    let spool = Spool::open(directory.path()).await.unwrap();
    assert_eq!(spool.identity().await.unwrap(), Some(identity(7)));
    assert_eq!(spool.exclusion().await.unwrap(), Some(Exclusion::Berthed));
    assert_eq!(spool.settings().await.unwrap(), settings);
    assert_eq!(spool.pending().await.unwrap().samples, 1);
    assert_eq!(spool.next_batch().await.unwrap().unwrap().seq, 1);
    spool.set_exclusion(None).await.unwrap();
    assert_eq!(spool.exclusion().await.unwrap(), None);
}

#[tokio::test]
async fn a_withdrawn_card_stays_so_until_the_server_says_otherwise() {
    let (directory, spool) = enrolled().await;
    let withdrawn = CardWithdrawn {
        since: sample(1).time,
        reason: "adjustment".to_owned(),
    };
    let withdrawal = Downlink {
        card_withdrawn: Some(withdrawn.clone()),
        ..downlink(0)
    };
    spool.save_downlink(&withdrawal).await.unwrap();
    drop(spool);
    let spool = Spool::open(directory.path()).await.unwrap();
    assert_eq!(spool.card_withdrawn().await.unwrap(), Some(withdrawn));
    spool.save_downlink(&downlink(0)).await.unwrap();
    assert_eq!(spool.card_withdrawn().await.unwrap(), None);
    spool.save_downlink(&withdrawal).await.unwrap();
    let other = Identity {
        vessel_name: "Arrano".to_owned(),
        ..identity(9)
    };
    spool.enrol(&other).await.unwrap();
    assert_eq!(spool.card_withdrawn().await.unwrap(), None);
}

#[cfg(unix)]
#[tokio::test]
async fn the_token_is_readable_by_its_owner_only_and_never_shown() {
    use std::os::unix::fs::PermissionsExt;
    let (directory, _spool) = enrolled().await;
    for name in ["spool.db", "spool.db-wal"] {
        let mode = std::fs::metadata(directory.path().join(name))
            .unwrap()
            .permissions()
            .mode();
        assert_eq!(mode & 0o077, 0, "{name}");
    }
    assert!(!format!("{:?}", identity(7)).contains("secret"));
}

#[cfg(unix)]
#[tokio::test]
async fn a_copy_that_was_put_back_for_all_to_read_is_the_owners_only_again() {
    use std::os::unix::fs::PermissionsExt;
    let (directory, spool) = enrolled().await;
    let names = ["spool.db", "spool.db-wal"].map(|name| directory.path().join(name));
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    for name in &names {
        std::fs::set_permissions(name, std::fs::Permissions::from_mode(0o644)).unwrap();
    }
    let again = Spool::open(directory.path()).await.unwrap();
    for name in &names {
        assert_eq!(mode(name), 0o600, "{}", name.display());
    }
    again.close().await;
    spool.close().await;
}

#[tokio::test]
async fn a_sample_that_damage_made_impossible_does_not_keep_others_from_being_sealed() {
    let (_directory, spool) = enrolled().await;
    spool
        .store(&[sample(0), sample(1)], &accepted(60), Seal::Full)
        .await
        .unwrap();
    let damaged = sqlx::query(
        "UPDATE pending_samples SET sample = replace(sample, '12.0', '912.0') WHERE id = 1",
    );
    damaged.execute(&spool.pool).await.unwrap();
    let (pending, sealed) = spool.store(&[], &BTreeMap::new(), Seal::All).await.unwrap();
    assert_eq!((pending, sealed), (Pending::default(), 1));
    let sent = spool.next_batch().await.unwrap().unwrap();
    let batch = binnacle_wire::decode(&sent.bytes).unwrap();
    assert_eq!(batch.samples.len(), 1);
    assert_eq!(batch.samples[0].time, sample(1).time);
}

#[tokio::test]
async fn settings_outlive_a_new_token_but_not_another_compass() {
    let (_directory, spool) = enrolled().await;
    let settings = Settings {
        version: 3,
        ..Settings::default()
    };
    let sent = Downlink {
        settings: Some(settings.clone()),
        ..downlink(0)
    };
    spool.save_downlink(&sent).await.unwrap();
    spool.enrol(&identity(8)).await.unwrap();
    assert_eq!(spool.settings().await.unwrap(), settings);
    let other = Identity {
        vessel_name: "Arrano".to_owned(),
        ..identity(9)
    };
    spool.enrol(&other).await.unwrap();
    assert_eq!(spool.settings().await.unwrap(), Settings::default());
}

#[tokio::test]
async fn sealing_goes_on_when_damage_took_the_counter() {
    let (_directory, spool) = enrolled().await;
    seal(&spool, 0..1).await;
    sqlx::query("DELETE FROM state WHERE name = 'next_seq'")
        .execute(&spool.pool)
        .await
        .unwrap();
    seal(&spool, 1..2).await;
    let status = spool.status().await.unwrap();
    assert_eq!((status.waiting_batches, status.pending_samples), (2, 0));
}

pub(crate) fn alert(revision: u32) -> ShipAlert {
    ShipAlert {
        id: Uuid::from_u128(0xa1),
        revision,
        state: ShipAlertState::Open,
        since: sample(0).time,
        at: sample(5).time,
        gyro_departure_deg: Some(28.4),
        satellite_departure_deg: None,
        limit_deg: 3.9,
        model_version: 1,
    }
}

#[tokio::test]
async fn a_spool_of_an_older_agent_goes_on() {
    let directory = TempDir::new().unwrap();
    let spool = Spool::open(directory.path()).await.unwrap();
    sqlx::raw_sql("ALTER TABLE batches DROP COLUMN urgent")
        .execute(&spool.pool)
        .await
        .unwrap();
    drop(spool);
    let spool = Spool::open(directory.path()).await.unwrap();
    spool.enrol(&identity(7)).await.unwrap();
    seal(&spool, 0..1).await;
    assert!(!spool.next_batch().await.unwrap().unwrap().urgent);
}
