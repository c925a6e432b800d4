//! The frames that every encoder and decoder must agree on. The second decoder,
//! in Python, is checked against them and many more.
//!
//! `UPDATE_VECTORS=1` writes missing ones; none is ever changed.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

mod support;

use binnacle_compass::angle::{CourseOverGround, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_wire::batch::{Batch, Thinned};
use binnacle_wire::{DecodeError, decode, encode};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use support::{Dice, batch, voyage};

/// Batches with the names of their dense vectors and of the plain frames of
/// earlier agents; batches without samples have one kind only.
fn written() -> Vec<(&'static str, &'static str, Batch)> {
    let mut references = voyage(3, 40);
    for (row, sample) in references.iter_mut().enumerate() {
        let heading = sample.gyro.map(TrueHeading::degrees);
        sample.satellite = heading
            .filter(|_| row > 10)
            .and_then(|h| TrueHeading::new(h + 0.6));
        sample.gyro = sample.gyro.filter(|_| row < 20);
    }
    let mut crossing = voyage(4, 20);
    for (row, sample) in crossing.iter_mut().enumerate() {
        let east = 179.9 + 0.02 * row as f64;
        let lon = if east > 180.0 { east - 360.0 } else { east };
        sample.position = Position::new(-16.5, lon).unwrap();
        sample.gyro = TrueHeading::new(359.2 + 0.1 * row as f64);
    }
    let mut gaps = voyage(5, 150);
    for (row, sample) in gaps.iter_mut().enumerate() {
        sample.sog_kn = sample.sog_kn.filter(|_| row / 50 % 2 == 0);
        sample.rate_of_turn_deg_min = None;
        sample.spread_deg = sample.spread_deg.filter(|_| row == 149);
    }
    vec![
        ("tally_only", "tally_only", support::empty()),
        ("dense_one_sample", "one_sample", batch(1, voyage(1, 1))),
        ("dense_quarter_day", "quarter_day", batch(7, voyage(2, 29))),
        (
            "dense_two_references",
            "two_references",
            batch(8, references),
        ),
        (
            "dense_antimeridian_and_north",
            "antimeridian_and_north",
            batch(9, crossing),
        ),
        ("dense_gaps", "gaps_over_blocks", batch(10, gaps)),
        (
            "dense_alert",
            "one_alert",
            noted(11, voyage(6, 3), &[1], None),
        ),
        (
            "alerts_alone",
            "alerts_alone",
            noted(12, Vec::new(), &[2, 3], None),
        ),
        (
            "dense_thinned",
            "thinned",
            noted(13, voyage(7, 12), &[], Some(17)),
        ),
        ("dense_motion", "dense_motion", batch(14, motion())),
        (
            "dense_motion_gaps",
            "dense_motion_gaps",
            batch(15, motion_with_gaps()),
        ),
    ]
}

/// A day with everything that a sample may have.
fn motion() -> Vec<Sample> {
    let mut samples = support::voyage_with_motion(8, 114);
    for sample in &mut samples[40..] {
        let heading = sample.gyro.map(TrueHeading::degrees);
        sample.satellite = heading.and_then(|h| TrueHeading::new(h - 0.4));
        sample.satellite_source = Some(SourceId::from_name("bridge GP THS"));
    }
    samples
}

/// Another gyro from some time on, then none; courses across north; gaps in each column.
fn motion_with_gaps() -> Vec<Sample> {
    let mut samples = motion();
    for (row, sample) in samples.iter_mut().enumerate() {
        sample.cog = CourseOverGround::new(row as f64 - 57.0).filter(|_| row % 3 > 0);
        sample.roll_deg = sample.roll_deg.filter(|_| row > 60).map(|roll| -roll);
        sample.roll_spread_deg = sample.roll_spread_deg.filter(|_| row > 70);
        sample.temperature_c = (row % 6 == 0).then_some(-12.0);
        if row > 30 {
            sample.gyro_source = Some(SourceId::from_name("bridge HE HDT"));
        }
        if row > 80 {
            (sample.gyro, sample.gyro_source) = (None, None);
        }
    }
    samples
}

fn noted(seq: u64, samples: Vec<Sample>, revisions: &[u32], thinned: Option<u64>) -> Batch {
    Batch {
        alerts: revisions.iter().copied().map(support::alert).collect(),
        thinned: thinned.map(|samples| Thinned {
            samples,
            windows: 60 * samples,
        }),
        ..batch(seq, samples)
    }
}

/// Frames that only a later or a faulty encoder writes.
fn edited() -> Vec<(&'static str, Vec<u8>)> {
    let good = unhex(&read("quarter_day.hex"));
    let dense = encode(&batch(7, voyage(2, 29))).unwrap();
    let with = |at: usize, byte: u8| {
        let mut body = good[..good.len() - 4].to_vec();
        body[at] = byte;
        sealed(body)
    };
    let mut flipped = good.clone();
    flipped[60] ^= 1;
    vec![
        ("later_version", with(2, 2)),
        ("later_flags", with(3, 0x80)),
        ("flipped_bit", flipped),
        ("cut_short", good[..good.len() - 9].to_vec()),
        (
            "cut_short_and_sealed",
            sealed(good[..good.len() - 9].to_vec()),
        ),
        ("not_a_batch", b"{\"samples\":[]}".to_vec()),
        ("unknown_column", unknown_column()),
        ("unknown_note", with_note(77, b"of a later agent")),
        ("longer_alert", with_note(1, &longer_alert())),
        ("short_alert", with_note(1, &longer_alert()[..20])),
        (
            "note_beyond_the_end",
            sealed(with_note(77, &[0; 12])[..30].to_vec()),
        ),
        (
            "dense_cut_short",
            sealed(dense[..dense.len() - 12].to_vec()),
        ),
        (
            "dense_too_long",
            sealed([&dense[..dense.len() - 4], &[0, 0]].concat()),
        ),
        ("dense_unknown_column", dense_unknown_column()),
        ("dense_unknown_predictor", dense_unknown_predictor()),
    ]
}

/// One sample, and a column 77 with some value.
fn dense_unknown_column() -> Vec<u8> {
    let mut body = encode(&Batch {
        tally: BTreeMap::new(),
        ..batch(1, voyage(1, 1))
    })
    .unwrap();
    body.truncate(body.len() - 4);
    // Magic, version, flags, stream, seq, no tally, one sample; nine columns with steps.
    assert_eq!((body[22], body[23], body[40]), (1, 9, 10));
    body[23] = 10;
    body.splice(42..42, [77, 0x10]);
    let ends = (0..=0xffff_u16).map(|end| [&body[..], &end.to_be_bytes()].concat());
    let mut frames = ends.map(sealed);
    frames
        .find(|frame| decode(frame).is_ok())
        .expect("some end is a column")
}

/// Ones in place of the columns: the first has gaps, and predictor 15.
fn dense_unknown_predictor() -> Vec<u8> {
    let mut body = b"BN\x01\x02".to_vec();
    body.extend([0x11; 16]);
    body.extend([1, 0, 1, 5]);
    body.extend([1, 0x50, 2, 0x13, 3, 0x13, 6, 0x22, 10, 0x10]);
    body.extend([0xff; 40]);
    sealed(body)
}

/// No sample, and one note.
fn with_note(kind: u8, bytes: &[u8]) -> Vec<u8> {
    let mut body = b"BN\x01\x01".to_vec();
    body.extend([0x11; 16]);
    // seq 1; no tally; one note.
    body.extend([1, 0, 1, kind, bytes.len() as u8]);
    body.extend(bytes);
    // No samples, no columns.
    body.extend([0, 0]);
    sealed(body)
}

/// An alert with extra bytes at the end, as a later agent may write.
fn longer_alert() -> Vec<u8> {
    let frame = encode(&noted(1, Vec::new(), &[1], None)).unwrap();
    // The note's bytes, behind the head, seq, tally, count, kind and length.
    let from = frame
        .windows(16)
        .position(|id| id == support::alert(1).id.as_bytes());
    let from = from.unwrap();
    let mut bytes = frame[from..frame.len() - 6].to_vec();
    bytes.extend(b"and more");
    bytes
}

/// One sample of five columns and a column 77, which no version has yet.
fn unknown_column() -> Vec<u8> {
    let mut body = b"BN\x01\0".to_vec();
    body.extend([0x11; 16]);
    // seq 1; no tally; one sample; six columns.
    body.extend([1, 0, 1, 6]);
    body.extend([1, 0x50, 2, 0x13, 3, 0x13, 6, 0x22, 10, 0x10, 77, 0x10]);
    // Each column: all present, predictor 0, first value as a zigzag varint.
    let firsts: [i64; 6] = [358_000_000, 43_350, -3_030, 4_500, 60, -5];
    let mut bits = String::new();
    for first in firsts {
        bits.push_str("0000");
        let mut code = (first << 1 ^ first >> 63).cast_unsigned();
        while code > 0x7f {
            write!(bits, "{:08b}", code & 0x7f | 0x80).unwrap();
            code >>= 7;
        }
        write!(bits, "{code:08b}").unwrap();
    }
    for byte in bits.as_bytes().chunks(8) {
        let text = format!("{:0<8}", std::str::from_utf8(byte).unwrap());
        body.push(u8::from_str_radix(&text, 2).unwrap());
    }
    sealed(body)
}

fn sealed(mut body: Vec<u8>) -> Vec<u8> {
    let checksum = crc32fast::hash(&body);
    body.extend(checksum.to_le_bytes());
    body
}

fn as_json(decoded: &Result<Batch, DecodeError>) -> Value {
    match decoded {
        Ok(batch) => {
            let mut meaning = json!({
                "stream": batch.stream,
                "seq": batch.seq,
                "tally": batch.tally,
                "samples": batch.samples,
            });
            if !batch.alerts.is_empty() {
                meaning["alerts"] = json!(batch.alerts);
            }
            if let Some(thinned) = batch.thinned {
                meaning["thinned"] = json!(thinned);
            }
            meaning
        }
        Err(error) => {
            let kind = format!("{error:?}");
            let end = kind.find(['(', ' ', '{']).unwrap_or(kind.len());
            json!({ "error": kind[..end] })
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

fn unhex(text: &str) -> Vec<u8> {
    let digits: Vec<char> = text.chars().filter(|c| !c.is_whitespace()).collect();
    digits
        .chunks(2)
        .map(|pair| u8::from_str_radix(&String::from_iter(pair), 16).unwrap())
        .collect()
}

fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The stored frame and batch of a vector.
fn stored(name: &str, bytes: &[u8]) -> (Vec<u8>, Value) {
    let frame = folder("vectors").join(format!("{name}.hex"));
    let meaning = frame.with_extension("json");
    if std::env::var_os("UPDATE_VECTORS").is_some() && !frame.exists() {
        let wrapped: Vec<String> = hex(bytes)
            .as_bytes()
            .chunks(64)
            .map(|line| String::from_utf8_lossy(line).into_owned())
            .collect();
        std::fs::write(&frame, wrapped.join("\n") + "\n").unwrap();
        let text = serde_json::to_string_pretty(&as_json(&decode(bytes))).unwrap();
        std::fs::write(&meaning, text + "\n").unwrap();
    }
    let meaning = serde_json::from_str(&read(&format!("{name}.json"))).unwrap();
    (unhex(&read(&format!("{name}.hex"))), meaning)
}

fn read(name: &str) -> String {
    let path = folder("vectors").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn frames_are_written_and_read_as_they_always_were() {
    for (name, plain, batch) in written() {
        let bytes = encode(&batch).unwrap();
        let (frame, meaning) = stored(name, &bytes);
        assert_eq!(hex(&bytes), hex(&frame), "{name}");
        assert_eq!(as_json(&decode(&frame)), meaning, "{name}");
        let (plain, of_plain) = stored(plain, &bytes);
        assert_eq!(as_json(&decode(&plain)), of_plain, "{name}");
        assert_eq!(meaning, of_plain, "{name}");
    }
    for (name, bytes) in edited() {
        let (frame, meaning) = stored(name, &bytes);
        assert_eq!(as_json(&decode(&frame)), meaning, "{name}");
    }
}

#[test]
fn a_note_of_a_later_agent_is_skipped() {
    let batch = decode(&with_note(77, b"of a later agent")).unwrap();
    assert_eq!((batch.seq, batch.alerts.len()), (1, 0));
    let batch = decode(&with_note(1, &longer_alert())).unwrap();
    assert_eq!(batch.alerts, [support::alert(1)]);
}

#[test]
fn a_column_of_a_later_version_is_skipped() {
    let batch = decode(&unknown_column()).unwrap();
    assert_eq!(batch.samples.len(), 1);
    assert_eq!(batch.samples[0].compass.degrees().to_string(), "90");
    assert_eq!(batch.samples[0].windows, 60);
}

#[test]
fn the_python_decoder_agrees_on_every_vector_and_a_thousand_more() {
    let mut frames: Vec<Vec<u8>> = Vec::new();
    for (name, plain, batch) in written() {
        let bytes = encode(&batch).unwrap();
        frames.extend([name, plain].map(|name| stored(name, &bytes).0));
    }
    frames.extend(edited().iter().map(|(name, bytes)| stored(name, bytes).0));
    let mut dice = Dice(1);
    for frame in frames.clone().iter().filter(|frame| frame.len() > 60) {
        for _ in 0..20 {
            let mut spoilt = frame[..frame.len() - 4].to_vec();
            let at = 4 + dice.next() as usize % (spoilt.len() - 4);
            spoilt[at] ^= 1 << (dice.next() % 8);
            frames.push(sealed(spoilt));
        }
    }
    for seed in 0..500 {
        let sail = if seed % 2 == 0 {
            voyage
        } else {
            support::voyage_with_motion
        };
        let samples = sail(seed, 1 + dice.next() as usize % 60);
        let plain = batch(seed + 1, samples);
        let alerts = [1, 2, 3].map(support::alert)[..seed as usize % 4].to_vec();
        let good = encode(&Batch { alerts, ..plain }).unwrap();
        let mut spoilt = good[..good.len() - 4].to_vec();
        let at = 4 + dice.next() as usize % (spoilt.len() - 4);
        spoilt[at] ^= 1 << (dice.next() % 8);
        frames.extend([good, sealed(spoilt)]);
    }
    let answers = python(&frames);
    assert_eq!(answers.len(), frames.len());
    for (frame, answer) in frames.iter().zip(answers) {
        assert_eq!(as_json(&decode(frame)), answer, "{}", hex(frame));
    }
}

fn python(frames: &[Vec<u8>]) -> Vec<Value> {
    let mut python = Command::new("python3")
        .arg(folder("decoder").join("sr1.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3, which the tests need, can be started");
    let lines: String = frames.iter().map(|frame| hex(frame) + "\n").collect();
    let mut stdin = python.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || stdin.write_all(lines.as_bytes()));
    let output = python.wait_with_output().unwrap();
    feeder.join().unwrap().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}
