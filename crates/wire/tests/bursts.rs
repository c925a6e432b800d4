//! Frames over a link of short messages.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

mod support;

use binnacle_wire::burst::{
    Ack, BurstError, Joiner, MAX_OPEN, MESSAGE_BYTES, StreamTag, capacity, read_ack, split,
    write_ack,
};
use binnacle_wire::{decode, encode};
use proptest::prelude::*;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use support::{Dice, batch, voyage};

fn day(seed: u64) -> Vec<u8> {
    encode(&batch(40 + seed, voyage(seed, 144))).unwrap()
}

#[test]
fn an_ordinary_day_fits_into_three_messages() {
    // No ten-minute mean of the day is missing; most days have fewer samples.
    for seed in 0..50 {
        let messages = split(&day(seed)).unwrap();
        assert!(messages.len() <= 3, "seed {seed}: {}", messages.len());
        assert!(messages.iter().all(|m| m.len() <= MESSAGE_BYTES));
    }
}

#[test]
fn a_frame_within_the_capacity_fits() {
    for samples in 1..400 {
        let mut sent = batch(u64::MAX >> 12, voyage(3, samples));
        sent.seq = u64::MAX;
        let frame = encode(&sent).unwrap();
        let parts = split(&frame).unwrap().len();
        assert!(frame.len() > capacity(parts - 1), "{samples}");
    }
}

#[test]
fn repeated_reordered_and_mixed_days_come_back() {
    let mut dice = Dice(5);
    let frames: Vec<Vec<u8>> = (0..20).map(day).collect();
    let once: Vec<Vec<u8>> = frames.iter().flat_map(|f| split(f).unwrap()).collect();
    let mut messages = [once.clone(), once].concat();
    for index in (1..messages.len()).rev() {
        messages.swap(index, dice.next() as usize % (index + 1));
    }
    let mut joiner = Joiner::default();
    let joined = messages.iter().filter_map(|m| joiner.push(m).unwrap());
    let mut joined: Vec<Vec<u8>> = joined.collect();
    joined.sort();
    joined.dedup();
    let mut wanted = frames;
    wanted.sort();
    assert_eq!(joined, wanted);
}

#[test]
fn a_damaged_message_is_refused_and_the_frame_waits_for_a_whole_one() {
    let frame = day(1);
    let messages = split(&frame).unwrap();
    for bit in 0..messages[0].len() * 8 {
        let mut damaged = messages[0].clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(Joiner::default().push(&damaged).is_err(), "bit {bit}");
    }
    let mut joiner = Joiner::default();
    let mut damaged = messages[1].clone();
    damaged[100] ^= 4;
    assert_eq!(joiner.push(&messages[0]), Ok(None));
    assert_eq!(joiner.push(&damaged), Err(BurstError::Damaged));
    assert_eq!(joiner.push(&messages[2]), Ok(None));
    let incomplete: Vec<_> = joiner.incomplete().collect();
    assert_eq!(incomplete.len(), 1);
    assert_eq!(
        (incomplete[0].1, incomplete[0].2, incomplete[0].3),
        (41, 2, 3)
    );
    assert_eq!(joiner.push(&messages[1]), Ok(Some(frame)));
    assert_eq!(joiner.incomplete().count(), 0);
}

#[test]
fn parts_of_two_frames_of_one_number_are_never_mixed() {
    let first = split(&encode(&batch(9, voyage(1, 144))).unwrap()).unwrap();
    let frame = encode(&batch(9, voyage(2, 144))).unwrap();
    let second = split(&frame).unwrap();
    let mut joiner = Joiner::default();
    joiner.push(&first[0]).unwrap();
    joiner.push(&first[1]).unwrap();
    joiner.push(&second[0]).unwrap();
    joiner.push(&second[1]).unwrap();
    assert_eq!(joiner.push(&second[2]), Ok(Some(frame)));
}

#[test]
fn the_oldest_incomplete_frames_are_dropped() {
    let mut joiner = Joiner::default();
    for seq in 0..2 * MAX_OPEN as u64 {
        let frame = encode(&batch(seq + 1, voyage(1, 114))).unwrap();
        joiner.push(&split(&frame).unwrap()[0]).unwrap();
    }
    assert_eq!(joiner.incomplete().count(), MAX_OPEN);
    assert!(joiner.incomplete().all(|open| open.1 > MAX_OPEN as u64));
}

#[test]
fn too_much_for_sixteen_messages_is_refused() {
    let frame = encode(&batch(1, voyage(1, 3000))).unwrap();
    assert_eq!(split(&frame), Err(BurstError::TooLarge(frame.len())));
    assert!(matches!(split(&frame[1..]), Err(BurstError::Frame(_))));
}

#[test]
fn an_acknowledgement_is_read_without_a_later_servers_fields() {
    let ack = Ack {
        stream: StreamTag::from_stream(batch(1, Vec::new()).stream),
        contiguous_seq: 300,
    };
    assert_eq!(read_ack(&write_ack(ack)), Ok(ack));
    assert_eq!(read_ack(&write_ack(ack)[..5]), Err(BurstError::Damaged));
    let part = &split(&day(1)).unwrap()[0];
    assert_eq!(read_ack(part), Err(BurstError::UnknownKind));
}

fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        write!(text, "{byte:02x}").unwrap();
    }
    text
}

/// One message per line; the last line is the frame. Never changed, like the
/// frames.
#[test]
fn the_written_messages_match_the_vector() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors/bursts/day.txt");
    let vector = std::fs::read_to_string(&path).unwrap();
    let frame = unhex(vector.lines().last().unwrap());
    let ack = Ack {
        stream: StreamTag::from_stream(batch(1, Vec::new()).stream),
        contiguous_seq: 130,
    };
    let mut lines: Vec<String> = split(&frame).unwrap().iter().map(|m| hex(m)).collect();
    lines.push(hex(&write_ack(ack)));
    lines.push(hex(&frame));
    assert_eq!(vector.lines().collect::<Vec<_>>(), lines);
    // A plain frame of earlier agents: it still means the same.
    let dense = encode(&batch(130, voyage(2, 114))).unwrap();
    assert_eq!(decode(&frame), decode(&dense));
}

fn unhex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text
        .chars()
        .filter_map(|c| c.to_digit(16))
        .map(|digit| digit as u8)
        .collect();
    digits
        .chunks(2)
        .map(|pair| pair[0] << 4 | pair[1])
        .collect()
}

#[test]
fn the_python_joiner_agrees_on_the_vector_and_on_a_mixed_hundred() {
    let vector = Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors/bursts/day.txt");
    let vector = std::fs::read_to_string(vector).unwrap();
    let mut messages: Vec<String> = vector.lines().map(str::to_owned).collect();
    let mut dice = Dice(9);
    let mut mixed = Vec::new();
    for seed in 0..40 {
        let samples = 20 + dice.next() as usize % 200;
        let frame = encode(&batch(seed + 1, voyage(seed, samples))).unwrap();
        mixed.extend(split(&frame).unwrap());
    }
    for index in (1..mixed.len()).rev() {
        mixed.swap(index, dice.next() as usize % (index + 1));
        let length = mixed[index].len();
        if dice.next().is_multiple_of(8) {
            mixed[index][dice.next() as usize % length] ^= 16;
        }
    }
    messages.extend(mixed.iter().map(|message| hex(message)));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("decoder/bursts.py");
    let mut python = Command::new("python3")
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3, which the tests need, can be started");
    let lines = messages.join("\n") + "\n";
    let mut stdin = python.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || stdin.write_all(lines.as_bytes()));
    let output = python.wait_with_output().unwrap();
    feeder.join().unwrap().unwrap();
    let results = String::from_utf8(output.stdout).unwrap();
    let mut joiner = Joiner::default();
    let wanted = messages.iter().map(|message| {
        let pairs = message.as_bytes().chunks(2);
        let byte = |pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
        match joiner.push(&pairs.map(byte).collect::<Vec<u8>>()) {
            Ok(Some(frame)) => hex(&frame),
            Ok(None) => "waits".to_owned(),
            Err(_) => "refused".to_owned(),
        }
    });
    assert_eq!(
        results.lines().collect::<Vec<_>>(),
        wanted.collect::<Vec<_>>()
    );
    assert!(results.lines().filter(|line| line.len() > 100).count() > 20);
}

proptest! {
    #[test]
    fn no_bytes_make_the_joiner_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = Joiner::default().push(&bytes);
        let _ = read_ack(&bytes);
        // With a matching check, so that the code behind it is reached.
        for kind in [0xb1_u8, 0xb2] {
            let crc = crc32fast::hash(&[&[kind][..], &bytes[..]].concat()) as u16;
            let message = [&[kind][..], &crc.to_le_bytes(), &bytes[..]].concat();
            let _ = Joiner::default().push(&message);
            let _ = read_ack(&message);
        }
    }
}
