//! Round trips of batches at the limits of every field.

use super::*;
use crate::batch::{Batch, StreamId};
use binnacle_compass::angle::{CompassHeading, TrueHeading, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use std::collections::BTreeMap;
use uuid::Uuid;

fn sample(time: &str, compass: f64, gyro: Option<f64>, satellite: Option<f64>) -> Sample {
    let time = Timestamp::parse(time).unwrap();
    let position = Position::new(43.35, -3.03).unwrap();
    Sample {
        gyro: gyro.and_then(TrueHeading::new),
        satellite: satellite.and_then(TrueHeading::new),
        sog_kn: Some(12.4),
        rate_of_turn_deg_min: Some(-0.5),
        spread_deg: Some(0.3),
        windows: 60,
        ..Sample::new(time, position, CompassHeading::new(compass).unwrap())
    }
}

fn batch(samples: Vec<Sample>) -> Batch {
    Batch {
        stream: StreamId(Uuid::from_u128(7)),
        seq: 1,
        samples,
        tally: BTreeMap::new(),
        alerts: Vec::new(),
        thinned: None,
    }
}

fn round_trip(sent: &Batch) -> Batch {
    let bytes = encode(sent).unwrap();
    let decoded = decode(&bytes).unwrap();
    assert_eq!(encode(&decoded).unwrap(), bytes);
    decoded
}

fn apart(a: f64, b: f64) -> f64 {
    wrap_180(a - b).abs()
}

#[test]
fn an_empty_batch_carries_its_tally() {
    let mut sent = batch(Vec::new());
    sent.seq = u64::MAX;
    sent.tally.insert(crate::reasons::TURNING.to_owned(), 12);
    sent.tally.insert("iceberg".to_owned(), u64::MAX);
    assert_eq!(round_trip(&sent), sent);
}

#[test]
fn headings_come_back_within_half_a_step_all_round_the_circle() {
    let mut samples = Vec::new();
    for tenths in 0..3600 {
        let heading = f64::from(tenths) / 10.0;
        for error in [-180.0, -3.337, 0.0, 0.123, 179.99] {
            for (gyro, satellite) in [(true, true), (true, false), (false, true), (false, false)] {
                samples.push(sample(
                    "2026-11-21T07:00:00Z",
                    heading + error,
                    gyro.then_some(heading),
                    satellite.then_some(heading - 2.0 * error),
                ));
            }
        }
    }
    for few in samples.chunks(9000) {
        let decoded = round_trip(&batch(few.to_vec()));
        for (sent, decoded) in few.iter().zip(&decoded.samples) {
            assert!(apart(sent.compass.degrees(), decoded.compass.degrees()) <= 0.010_001);
            assert_eq!(sent.gyro.is_some(), decoded.gyro.is_some());
            assert_eq!(sent.satellite.is_some(), decoded.satellite.is_some());
            for (a, b) in [
                (sent.gyro, decoded.gyro),
                (sent.satellite, decoded.satellite),
            ] {
                let (Some(a), Some(b)) = (a, b) else { continue };
                assert!(apart(a.degrees(), b.degrees()) <= 0.025_001, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_missing_value_stays_missing() {
    let mut sent = batch(vec![
        sample("2026-11-21T07:00:00Z", 359.99, Some(0.0), None);
        200
    ]);
    for (row, sample) in sent.samples.iter_mut().enumerate() {
        sample.sog_kn = (row % 3 == 0).then_some(10.0);
        sample.rate_of_turn_deg_min = None;
        sample.spread_deg = (row == 150).then_some(0.5);
    }
    let decoded = round_trip(&sent);
    for (sent, decoded) in sent.samples.iter().zip(&decoded.samples) {
        assert_eq!(
            (sent.sog_kn, sent.spread_deg),
            (decoded.sog_kn, decoded.spread_deg)
        );
        assert_eq!(
            (decoded.rate_of_turn_deg_min, decoded.satellite),
            (None, None)
        );
        assert_eq!((decoded.cog, decoded.roll_deg), (None, None));
        assert_eq!(
            (decoded.roll_spread_deg, decoded.temperature_c),
            (None, None)
        );
        assert_eq!(
            (decoded.gyro_source, decoded.satellite_source),
            (None, None)
        );
    }
}

#[test]
fn samples_come_out_in_order_of_time() {
    let late = sample("2026-11-21T08:00:00Z", 10.0, Some(9.0), None);
    let early = sample("2026-11-21T07:00:05Z", 20.0, Some(19.0), None);
    let decoded = round_trip(&batch(vec![late, early]));
    let times: Vec<String> = decoded.samples.iter().map(|s| s.time.to_string()).collect();
    assert_eq!(times, ["2026-11-21T07:00:05Z", "2026-11-21T08:00:00Z"]);
}

#[test]
fn a_value_out_of_range_is_refused_by_name() {
    type Spoil = fn(&mut Sample);
    let spoilt: [(&str, Spoil); 9] = [
        ("time", |s| {
            s.time = Timestamp::parse("1850-01-01T00:00:00Z").unwrap();
        }),
        ("sog_kn", |s| s.sog_kn = Some(-1.0)),
        ("sog_kn", |s| s.sog_kn = Some(f64::NAN)),
        ("rate_of_turn_deg_min", |s| {
            s.rate_of_turn_deg_min = Some(f64::INFINITY);
        }),
        ("spread_deg", |s| s.spread_deg = Some(-0.1)),
        ("windows", |s| s.windows = 0),
        ("roll_deg", |s| s.roll_deg = Some(-90.1)),
        ("roll_spread_deg", |s| s.roll_spread_deg = Some(f64::NAN)),
        ("temperature_c", |s| s.temperature_c = Some(101.0)),
    ];
    for (name, spoil) in spoilt {
        let mut bad = sample("2026-11-21T07:00:00Z", 1.0, Some(1.0), None);
        let good = bad;
        spoil(&mut bad);
        match encode(&batch(vec![good, bad])) {
            Err(EncodeError::OutOfRange { row: 1, field, .. }) => assert_eq!(field, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn limits_are_named() {
    let one = sample("2026-11-21T07:00:00Z", 1.0, Some(1.0), None);
    assert_eq!(
        encode(&batch(vec![one; MAX_SAMPLES + 1])),
        Err(EncodeError::TooManySamples(65_536))
    );
    assert_eq!(
        round_trip(&batch(vec![one; MAX_SAMPLES])).samples.len(),
        MAX_SAMPLES
    );
    let zero = Batch {
        seq: 0,
        ..batch(vec![one])
    };
    assert_eq!(encode(&zero), Err(EncodeError::SeqZero));
    let mut wordy = batch(vec![one]);
    wordy.tally.insert("x".repeat(65), 1);
    assert_eq!(encode(&wordy), Err(EncodeError::ReasonName("x".repeat(65))));
    let mut noisy = batch(Vec::new());
    let mut state = 1_u64;
    for _ in 0..MAX_SAMPLES {
        // Knuth's linear congruential generator.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let heading = (state >> 33) as f64 % 36_000.0 / 100.0;
        let mut s = sample(
            "2026-11-21T07:00:00Z",
            heading,
            Some(heading * 7.0),
            Some(heading * 3.0),
        );
        s.position = Position::new(heading / 4.0, heading - 180.0).unwrap();
        noisy.samples.push(s);
    }
    assert!(matches!(encode(&noisy), Err(EncodeError::TooLarge(_))));
}

#[test]
fn each_kind_of_damage_has_its_own_error() {
    let bytes = encode(&batch(vec![sample(
        "2026-11-21T07:00:00Z",
        1.0,
        Some(1.0),
        None,
    )]))
    .unwrap();
    assert_eq!(decode(b""), Err(DecodeError::Truncated));
    assert_eq!(decode(b"{\"samples\":[]}"), Err(DecodeError::BadMagic));
    assert_eq!(decode(&bytes[..7]), Err(DecodeError::Truncated));
    assert!(matches!(
        decode(&bytes[..30]),
        Err(DecodeError::Checksum { .. })
    ));
    assert_eq!(
        decode(&vec![0; MAX_BYTES + 1]),
        Err(DecodeError::TooLarge(MAX_BYTES + 1))
    );
    for bit in 16..bytes.len() * 8 {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(matches!(
            decode(&flipped),
            Err(DecodeError::Checksum { .. })
        ));
    }
    assert_eq!(
        decode(&edited(&bytes, 2, 9)),
        Err(DecodeError::UnsupportedVersion(9))
    );
    assert_eq!(
        decode(&edited(&bytes, 3, 4)),
        Err(DecodeError::UnsupportedFlags(4))
    );
    assert_eq!(decode(&edited(&bytes, 20, 0)), Err(DecodeError::SeqZero));
}

/// The frame with one byte changed and its checksum recomputed.
fn edited(bytes: &[u8], at: usize, byte: u8) -> Vec<u8> {
    let mut body = bytes[..bytes.len() - 4].to_vec();
    body[at] = byte;
    let checksum = crc32fast::hash(&body);
    body.extend(checksum.to_le_bytes());
    body
}
