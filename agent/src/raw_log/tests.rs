//! The raw log on a real file.

use super::*;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use tempfile::TempDir;

const START_S: i64 = 1_788_220_800;

fn second(offset_s: i64) -> Second {
    Second {
        time: Timestamp::from_micros((START_S + offset_s) * 1_000_000).unwrap(),
        position: Some(Position::new(43.5, -3.25).unwrap()),
        compass: CompassHeading::new(offset_s.rem_euclid(360) as f64),
        gyro: None,
        satellite: TrueHeading::new(359.99),
        sog_kn: Some(12.34),
        rate_of_turn_deg_min: Some(-7.5),
        roll_deg: None,
    }
}

fn fill(raw_log: &mut RawLog, seconds: std::ops::Range<i64>) {
    for offset_s in seconds {
        let second = second(offset_s);
        raw_log.record(second.time, || second, Instant::now());
    }
}

fn table(directory: &Path, span: Span) -> Vec<String> {
    let mut out = Vec::new();
    let rows = export(&path(directory), span, &mut out).unwrap();
    let lines: Vec<String> = String::from_utf8(out)
        .unwrap()
        .lines()
        .skip(1)
        .map(str::to_owned)
        .collect();
    assert_eq!(lines.len() as u64, rows);
    lines
}

const BLOCK_S: i64 = 168;
fn count(rows: &[String]) -> i64 {
    i64::try_from(rows.len()).unwrap()
}

fn kept(directory: &Path) -> i64 {
    count(&table(directory, Span::default()))
}

/// Four blocks.
const SMALL: u64 = 4 * BLOCK_BYTES;

#[test]
fn every_second_comes_back_as_it_was_and_once() {
    let directory = TempDir::new().unwrap();
    let mut raw_log = RawLog::open(directory.path(), SMALL);
    fill(&mut raw_log, 0..BLOCK_S + 10);
    // The same second again, as when several sentences carry the time.
    fill(&mut raw_log, BLOCK_S + 9..BLOCK_S + 10);
    raw_log.flush(Instant::now());
    let rows = table(directory.path(), Span::default());
    assert_eq!(count(&rows), BLOCK_S + 10);
    assert_eq!(
        rows[1],
        "2026-09-01T00:00:01Z,43.5000000,-3.2500000,1.00,,359.99,12.34,-7.5,"
    );
    let span = Span {
        from: Some(second(5).time),
        until: Some(second(8).time),
    };
    assert_eq!(table(directory.path(), span), rows[5..8]);
}

#[test]
fn the_oldest_are_written_over_and_the_file_keeps_its_limit_over_restarts() {
    let directory = TempDir::new().unwrap();
    for start in 0..7 {
        let mut raw_log = RawLog::open(directory.path(), SMALL);
        fill(&mut raw_log, start * BLOCK_S..(start + 1) * BLOCK_S);
        let length = std::fs::metadata(path(directory.path())).unwrap().len();
        assert!(length <= SMALL, "{length}");
    }
    let rows = table(directory.path(), Span::default());
    assert_eq!(count(&rows), 4 * BLOCK_S);
    assert!(rows[0].starts_with(&second(3 * BLOCK_S).time.to_string()));
    assert!(rows.is_sorted(), "in the order of time");
}

#[test]
fn a_torn_block_costs_only_itself_and_what_is_no_ring_is_written_over() {
    let directory = TempDir::new().unwrap();
    let mut raw_log = RawLog::open(directory.path(), SMALL);
    fill(&mut raw_log, 0..3 * BLOCK_S);
    drop(raw_log);
    let file = path(directory.path());
    let mut bytes = std::fs::read(&file).unwrap();
    bytes[BLOCK_BYTES as usize + 100] ^= 1;
    bytes.truncate(3 * BLOCK_BYTES as usize - 1000);
    std::fs::write(&file, &bytes).unwrap();
    assert_eq!(kept(directory.path()), BLOCK_S);
    let mut raw_log = RawLog::open(directory.path(), SMALL);
    fill(&mut raw_log, 5 * BLOCK_S..6 * BLOCK_S);
    assert_eq!(kept(directory.path()), 2 * BLOCK_S);
    std::fs::write(&file, vec![0x5a; 20_000]).unwrap();
    let mut raw_log = RawLog::open(directory.path(), SMALL);
    fill(&mut raw_log, 0..BLOCK_S);
    assert_eq!(kept(directory.path()), BLOCK_S);
}

#[test]
fn a_smaller_limit_makes_the_file_smaller() {
    let directory = TempDir::new().unwrap();
    fill(&mut RawLog::open(directory.path(), SMALL), 0..4 * BLOCK_S);
    let raw_log = RawLog::open(directory.path(), 2 * BLOCK_BYTES);
    assert_eq!(raw_log.status().unwrap().bytes, 2 * BLOCK_BYTES);
}

#[test]
fn a_ring_that_gives_way_frees_the_disk_and_begins_again_in_an_hour() {
    let directory = TempDir::new().unwrap();
    let mut raw_log = RawLog::open(directory.path(), SMALL);
    fill(&mut raw_log, 0..2 * BLOCK_S);
    let now = Instant::now();
    raw_log.release_disk("the disk is full", now);
    let status = raw_log.status().unwrap();
    assert_eq!(status.problem.as_deref(), Some("the disk is full"));
    assert_eq!(std::fs::metadata(path(directory.path())).unwrap().len(), 0);
    fill(&mut raw_log, 2 * BLOCK_S..3 * BLOCK_S);
    assert_eq!(std::fs::metadata(path(directory.path())).unwrap().len(), 0);
    for offset_s in 3 * BLOCK_S..4 * BLOCK_S {
        let second = second(offset_s);
        raw_log.record(second.time, || second, now + PAUSE_AFTER_FULL);
    }
    assert_eq!(raw_log.status().unwrap().problem, None);
    assert_eq!(kept(directory.path()), BLOCK_S);
}

#[test]
fn a_place_that_cannot_be_written_is_a_ring_that_keeps_nothing() {
    let directory = TempDir::new().unwrap();
    let mut raw_log = RawLog::open(&directory.path().join("nowhere"), SMALL);
    fill(&mut raw_log, 0..2 * BLOCK_S);
    assert!(raw_log.status().unwrap().problem.is_some());
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_without_room_makes_the_ring_give_way() {
    let directory = TempDir::new().unwrap();
    std::os::unix::fs::symlink("/dev/full", path(directory.path())).unwrap();
    let mut raw_log = RawLog::open(directory.path(), SMALL);
    fill(&mut raw_log, 0..BLOCK_S);
    let problem = raw_log.status().unwrap().problem.unwrap();
    assert!(problem.contains("No space left"), "{problem}");
}

#[test]
fn without_a_limit_there_is_no_ring() {
    let directory = TempDir::new().unwrap();
    let mut raw_log = RawLog::open(directory.path(), 0);
    fill(&mut raw_log, 0..2 * BLOCK_S);
    assert_eq!(raw_log.status(), None);
    assert!(!path(directory.path()).exists());
}
