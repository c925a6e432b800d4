//! Properties of every batch and of any bytes.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

mod support;

use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::time::Timestamp;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::{Batch, StreamId, Thinned};
use binnacle_wire::codec::{MAX_BYTES, MAX_SAMPLES};
use binnacle_wire::{DecodeError, decode, encode};
use proptest::option;
use proptest::prelude::*;
use support::Dice;
use uuid::Uuid;

/// Tolerance for the floating-point sums of the test itself.
const SLACK: f64 = 1e-9;

fn samples() -> impl Strategy<Value = Vec<Sample>> {
    let heading = || -10.0..370.0_f64;
    let sample = (
        (
            315_964_800_000_000..4_102_444_800_000_000_i64,
            -90.0..=90.0_f64,
            -180.0..=180.0_f64,
        ),
        (heading(), option::of(heading()), option::of(heading())),
        (
            option::of(0.0..200.0_f64),
            option::of(-3600.0..3600.0_f64),
            option::of(0.0..180.0_f64),
        ),
        (
            option::of(heading()),
            option::of(-90.0..=90.0_f64),
            option::of(0.0..=90.0_f64),
            option::of(-100.0..=100.0_f64),
        ),
        (
            option::of(any::<u16>()),
            option::of(any::<u16>()),
            any::<bool>(),
        ),
        1..=u16::MAX,
    );
    let sample = sample.prop_map(|(place, headings, rest, motion, sources, windows)| Sample {
        cog: motion.0.and_then(CourseOverGround::new),
        roll_deg: motion.1,
        roll_spread_deg: motion.2,
        temperature_c: motion.3,
        gyro_source: sources.0.map(SourceId::new),
        satellite_source: sources.1.map(SourceId::new),
        position_reckoned: sources.2,
        gyro: headings.1.and_then(TrueHeading::new),
        satellite: headings.2.and_then(TrueHeading::new),
        sog_kn: rest.0,
        rate_of_turn_deg_min: rest.1,
        spread_deg: rest.2,
        windows,
        ..Sample::new(
            Timestamp::from_micros(place.0).unwrap(),
            Position::new(place.1, place.2).unwrap(),
            CompassHeading::new(headings.0).unwrap(),
        )
    });
    prop::collection::vec(sample, 0..300)
}

fn thinned() -> impl Strategy<Value = Thinned> {
    let counts = (any::<u64>(), any::<u64>());
    counts.prop_map(|(samples, windows)| Thinned { samples, windows })
}

fn alerts() -> impl Strategy<Value = ShipAlert> {
    let seconds = || 315_964_800..4_102_444_800_i64;
    let angle = || (-1800..=1800_i32).prop_map(|tenths| f64::from(tenths) / 10.0);
    let head = (any::<u128>(), 1..=u32::MAX, 0..3_u8, any::<u32>());
    let angles = (option::of(angle()), option::of(angle()), angle());
    (head, seconds(), seconds(), angles).prop_map(|(head, since, at, angles)| ShipAlert {
        id: Uuid::from_u128(head.0),
        revision: head.1,
        state: [
            ShipAlertState::Open,
            ShipAlertState::Agree,
            ShipAlertState::NotJudged,
        ][usize::from(head.2)],
        since: Timestamp::from_micros(since * 1_000_000).unwrap(),
        at: Timestamp::from_micros(at * 1_000_000).unwrap(),
        gyro_departure_deg: angles.0,
        satellite_departure_deg: angles.1,
        limit_deg: angles.2.abs(),
        model_version: head.3,
    })
}

fn batches() -> impl Strategy<Value = Batch> {
    let reason = prop_oneof!["accepted", "turning", "settling", "[a-zé_]{1,30}"];
    let tally = prop::collection::btree_map(reason, any::<u64>(), 0..20);
    let head = (any::<u128>(), 1..=u64::MAX);
    let notes = (prop::collection::vec(alerts(), 0..4), option::of(thinned()));
    (head, samples(), tally, notes).prop_map(|((stream, seq), samples, tally, notes)| Batch {
        stream: StreamId(Uuid::from_u128(stream)),
        seq,
        samples,
        tally,
        alerts: notes.0,
        thinned: notes.1,
    })
}

fn close(sent: Option<f64>, decoded: Option<f64>, half_step: f64) -> bool {
    match (sent, decoded) {
        (None, None) => true,
        (Some(sent), Some(decoded)) => (sent - decoded).abs() <= half_step + SLACK,
        _ => false,
    }
}

fn turned(sent: Option<TrueHeading>, decoded: Option<TrueHeading>, half_step: f64) -> bool {
    match (sent, decoded) {
        (Some(sent), Some(decoded)) => {
            wrap_180(sent.degrees() - decoded.degrees()).abs() <= half_step + SLACK
        }
        (sent, decoded) => sent.is_none() && decoded.is_none(),
    }
}

fn within_half_a_step(sent: &Sample, decoded: &Sample) -> bool {
    let east = wrap_180(sent.position.lon_deg() - decoded.position.lon_deg());
    let compass = wrap_180(sent.compass.degrees() - decoded.compass.degrees());
    sent.time.seconds_since(decoded.time).abs() <= 2.5
        && (sent.position.lat_deg() - decoded.position.lat_deg()).abs() <= 0.000_5 + SLACK
        && east.abs() <= 0.000_5 + SLACK
        && compass.abs() <= 0.01 + SLACK
        && turned(sent.gyro, decoded.gyro, 0.025)
        && turned(sent.satellite, decoded.satellite, 0.025)
        && close(sent.sog_kn, decoded.sog_kn, 0.1)
        && close(
            sent.rate_of_turn_deg_min,
            decoded.rate_of_turn_deg_min,
            0.25,
        )
        && close(sent.spread_deg, decoded.spread_deg, 0.01)
        && sent.windows == decoded.windows
        && motion_within_half_a_step(sent, decoded)
}

fn motion_within_half_a_step(sent: &Sample, decoded: &Sample) -> bool {
    let course = match (sent.cog, decoded.cog) {
        (Some(sent), Some(decoded)) => {
            wrap_180(sent.degrees() - decoded.degrees()).abs() <= 0.5 + SLACK
        }
        (sent, decoded) => sent.is_none() && decoded.is_none(),
    };
    course
        && close(sent.roll_deg, decoded.roll_deg, 0.1)
        && close(sent.roll_spread_deg, decoded.roll_spread_deg, 0.25)
        && close(sent.temperature_c, decoded.temperature_c, 0.5)
        && sent.position_reckoned == decoded.position_reckoned
        && (sent.gyro_source, sent.satellite_source)
            == (decoded.gyro_source, decoded.satellite_source)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_batch_comes_back_within_half_a_step_and_then_to_the_byte(sent in batches()) {
        let bytes = encode(&sent).unwrap();
        let decoded = decode(&bytes).unwrap();
        prop_assert_eq!(encode(&decoded).unwrap(), bytes);
        prop_assert_eq!((decoded.stream, decoded.seq, &decoded.tally), (sent.stream, sent.seq, &sent.tally));
        prop_assert_eq!((&decoded.alerts, decoded.thinned), (&sent.alerts, sent.thinned));
        let mut samples = sent.samples;
        samples.sort_by_key(|sample| sample.time);
        prop_assert_eq!(samples.len(), decoded.samples.len());
        for (sent, decoded) in samples.iter().zip(&decoded.samples) {
            prop_assert!(within_half_a_step(sent, decoded), "{:?} decoded as {:?}", sent, decoded);
        }
    }

    #[test]
    fn any_bytes_are_decoded_or_refused(
        body in prop::collection::vec(any::<u8>(), 0..400),
        head in prop_oneof![Just(&b""[..]), Just(&b"BN"[..]), Just(&b"BN\x01\0"[..]), Just(&b"BN\x01\x01"[..]), Just(&b"BN\x01\x02"[..])],
    ) {
        decode_and_encode(&with_checksum([head, &body].concat()));
        decode_and_encode(&body);
    }
}

fn with_checksum(mut body: Vec<u8>) -> Vec<u8> {
    let checksum = crc32fast::hash(&body);
    body.extend(checksum.to_le_bytes());
    body
}

/// Every decoded batch can be encoded again.
fn decode_and_encode(bytes: &[u8]) -> bool {
    let Ok(batch) = decode(bytes) else {
        return false;
    };
    assert!(batch.samples.len() <= MAX_SAMPLES);
    encode(&batch).unwrap();
    true
}

/// Frames of earlier agents.
const PLAIN: [&str; 3] = [
    include_str!("../vectors/quarter_day.hex"),
    include_str!("../vectors/two_references.hex"),
    include_str!("../vectors/gaps_over_blocks.hex"),
];

fn unhex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text
        .chars()
        .filter_map(|c| c.to_digit(16))
        .map(|d| d as u8)
        .collect();
    digits
        .chunks(2)
        .map(|pair| pair[0] << 4 | pair[1])
        .collect()
}

#[test]
fn twenty_thousand_mutations_never_panic() {
    let frames: Vec<Vec<u8>> = (0..8)
        .map(|seed| encode(&support::batch(seed + 1, support::voyage(seed, 40))).unwrap())
        .chain([encode(&support::empty()).unwrap()])
        .chain(PLAIN.map(unhex))
        .collect();
    let mut dice = Dice(20_000);
    let (mut stale, mut refused, mut answered) = (0, 0, 0);
    for round in 0..20_000 {
        let frame = &frames[dice.next() as usize % frames.len()];
        let mut body = frame[..frame.len() - 4].to_vec();
        mutate(&mut body, &mut dice);
        if round % 2 == 0 {
            body.extend(&frame[frame.len() - 4..]);
            let unchanged = &body == frame;
            match decode(&body) {
                Err(DecodeError::Checksum { .. } | DecodeError::BadMagic) => stale += 1,
                Ok(_) if unchanged => stale += 1,
                other => panic!("a stale checksum passed: {other:?}"),
            }
        } else if decode_and_encode(&with_checksum(body)) {
            answered += 1;
        } else {
            refused += 1;
        }
    }
    assert_eq!(stale, 10_000);
    // Both must happen often; otherwise the mutations miss their target.
    assert!(
        refused > 2000 && answered > 500,
        "{refused} refused, {answered} answered"
    );
}

fn mutate(body: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..=dice.next() % 3 {
        // Mostly behind the version: the bytes before it have few ways to be
        // wrong.
        let at = (dice.next() as usize % body.len()).max(dice.next() as usize % 4);
        match dice.next() % 5 {
            0 => body[at] = dice.next() as u8,
            1 => body[at] ^= 1 << (dice.next() % 8),
            2 => body.truncate(at.max(8)),
            3 => body.insert(at, dice.next() as u8),
            _ => body[at] = [0, 0x7f, 0x80, 0xff][dice.next() as usize % 4],
        }
    }
}

#[test]
fn a_small_frame_cannot_claim_many_samples() {
    let mut body = b"BN\x01\0".to_vec();
    body.extend([0; 16]);
    // seq 1, no tally, 65,535 samples, five columns that end at once.
    body.extend([1, 0, 0xff, 0xff, 0x03, 5]);
    body.extend([1, 0x50, 2, 0x13, 3, 0x13, 6, 0x22, 10, 0x10]);
    body.extend([0; 60]);
    assert_eq!(
        decode(&with_checksum(body)),
        Err(DecodeError::TooManySamples(65_535))
    );
}

#[test]
fn a_small_dense_frame_cannot_claim_many_samples() {
    // A few bytes may hold many equal samples, and no more than that.
    let alike = support::batch(1, vec![support::voyage(1, 1)[0]; MAX_SAMPLES]);
    let frame = encode(&alike).unwrap();
    assert!(frame.len() < 600, "{}", frame.len());
    assert_eq!(decode(&frame).unwrap().samples.len(), MAX_SAMPLES);
    let mut body = frame[..frame.len() - 100].to_vec();
    assert_eq!(
        decode(&with_checksum(body.clone())),
        Err(DecodeError::Truncated)
    );
    body[3] = 0;
    assert_eq!(
        decode(&with_checksum(body)),
        Err(DecodeError::TooManySamples(65_535))
    );
}

#[test]
fn a_frame_of_all_columns_and_samples_ends_with_its_bytes() {
    let mut body = b"BN\x01\x02".to_vec();
    body.extend([0x11; 16]);
    body.extend([1, 0, 0xff, 0xff, 3, 64]);
    body.extend((1..=64).flat_map(|id| [id, 0x10]));
    body.resize(MAX_BYTES - 4, 0);
    // Zeros are values like the one before: few of these bytes are needed for
    // all.
    assert_eq!(decode(&with_checksum(body)), Err(DecodeError::TrailingBits));
}

#[test]
fn a_frame_over_the_limit_is_refused_unread() {
    let huge = with_checksum(vec![b'B'; MAX_BYTES]);
    assert_eq!(decode(&huge), Err(DecodeError::TooLarge(MAX_BYTES + 4)));
}
