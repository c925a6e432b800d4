//! Blocks of the raw log: 4 096 bytes, all numbers little-endian.
//!
//! | at | bytes | content |
//! |---|---|---|
//! | 0 | 4 | `BNR1` |
//! | 4 | 8 | number, rising |
//! | 12 | 4 | CRC-32 of the above |
//! | 16 | 168 × 24 | seconds, see below |
//! | 4048 | 2 | number of seconds in use |
//! | 4092 | 4 | CRC-32 of 16 to 4092 |
//!
//! A second is its time since 1970 (u32), latitude and longitude in 10⁻⁷ degree (i32), compass,
//! gyro and satellite compass in 0.01° (u16), speed over ground in 0.01 knot (u16), rate of turn in
//! 0.1° per minute and roll in 0.01° (i16). The least number of a signed field, and the greatest of
//! an unsigned one, mean that the value is absent.

use super::second::Second;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

pub(super) const BLOCK_BYTES: u64 = 4_096;
const HEAD_BYTES: usize = 16;
/// Seconds per block.
pub(super) const RECORDS: usize = 168;
const RECORD_BYTES: usize = 24;
const COUNT_AT: usize = HEAD_BYTES + RECORDS * RECORD_BYTES;
const CHECKSUM_AT: usize = BLOCK_BYTES as usize - 4;
const MAGIC: [u8; 4] = *b"BNR1";

/// Contents of an intact block.
#[derive(Debug, PartialEq)]
pub(super) struct Block {
    pub(super) number: u64,
    pub(super) seconds: Vec<Second>,
}

/// Encodes a block of at most [`RECORDS`] seconds.
pub(super) fn write(number: u64, seconds: &[Second]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(BLOCK_BYTES as usize);
    bytes.extend(MAGIC);
    bytes.extend(number.to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    let seconds = &seconds[..seconds.len().min(RECORDS)];
    for second in seconds {
        write_second(&mut bytes, second);
    }
    bytes.resize(COUNT_AT, 0);
    bytes.extend((seconds.len() as u16).to_le_bytes());
    bytes.resize(CHECKSUM_AT, 0);
    let checksum = crc32fast::hash(&bytes[HEAD_BYTES..]);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

/// Decodes the number in a block's head; `None` unless the head is intact.
fn number(head: &[u8; HEAD_BYTES]) -> Option<u64> {
    let (stated, checksum) = head.split_last_chunk::<4>()?;
    let (magic, number) = stated.split_first_chunk::<4>()?;
    let whole = *magic == MAGIC && crc32fast::hash(stated) == u32::from_le_bytes(*checksum);
    let number = u64::from_le_bytes(number.try_into().ok()?);
    // The highest number leaves none for the next block, so it was never written.
    (whole && number < u64::MAX).then_some(number)
}

/// Decodes a block; `None` unless it is intact.
fn read(bytes: &[u8]) -> Option<Block> {
    let (head, rest) = bytes.split_first_chunk::<HEAD_BYTES>()?;
    let number = number(head)?;
    let (content, checksum) = rest.split_last_chunk::<4>()?;
    if bytes.len() as u64 != BLOCK_BYTES
        || crc32fast::hash(content) != u32::from_le_bytes(*checksum)
    {
        return None;
    }
    let (records, tail) = content.split_at_checked(RECORDS * RECORD_BYTES)?;
    let count = u16::from_le_bytes(*tail.first_chunk()?);
    let records = records.chunks_exact(RECORD_BYTES).take(count.into());
    Some(Block {
        number,
        seconds: records.filter_map(read_second).collect(),
    })
}

/// Reads the number of the block in a slot; `None` unless its head is intact.
pub(super) fn number_at(file: &mut File, slot: u64) -> io::Result<Option<u64>> {
    let mut head = [0; HEAD_BYTES];
    file.seek(SeekFrom::Start(slot * BLOCK_BYTES))?;
    match file.read_exact(&mut head) {
        Ok(()) => Ok(number(&head)),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}

/// Reads the block of a slot; `None` unless it is intact.
pub(super) fn block_at(file: &mut File, slot: u64) -> io::Result<Option<Block>> {
    let mut bytes = vec![0; BLOCK_BYTES as usize];
    file.seek(SeekFrom::Start(slot * BLOCK_BYTES))?;
    match file.read_exact(&mut bytes) {
        Ok(()) => Ok(read(&bytes)),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}

fn write_second(bytes: &mut Vec<u8>, second: &Second) {
    let seconds = second.time.micros().div_euclid(1_000_000);
    bytes.extend(u32::try_from(seconds).unwrap_or_default().to_le_bytes());
    let place =
        |degrees: Option<f64>| signed(degrees, 1e7, i32::MIN.into(), i32::MAX.into()) as i32;
    let position = second.position;
    bytes.extend(place(position.map(Position::lat_deg)).to_le_bytes());
    bytes.extend(place(position.map(Position::lon_deg)).to_le_bytes());
    let headings = [
        second.compass.map(CompassHeading::degrees),
        second.gyro.map(TrueHeading::degrees),
        second.satellite.map(TrueHeading::degrees),
    ];
    for value in headings.into_iter().chain([second.sog_kn]) {
        let hundredths = value.map(|value| (value * 100.0).round().clamp(0.0, 65_534.0) as u16);
        bytes.extend(hundredths.unwrap_or(u16::MAX).to_le_bytes());
    }
    let small = |value, steps| signed(value, steps, i16::MIN.into(), i16::MAX.into()) as i16;
    bytes.extend(small(second.rate_of_turn_deg_min, 10.0).to_le_bytes());
    bytes.extend(small(second.roll_deg, 100.0).to_le_bytes());
}

/// Rounds to steps; `none` stands for an absent value.
fn signed(value: Option<f64>, steps: f64, none: i64, most: i64) -> i64 {
    value.map_or(none, |value| {
        ((value * steps).round() as i64).clamp(none + 1, most)
    })
}

/// Decodes a second; `None` for values that no vessel can have.
fn read_second(bytes: &[u8]) -> Option<Second> {
    let mut rest = bytes;
    let seconds = u32::from_le_bytes(take(&mut rest)?);
    let place = |bytes: [u8; 4]| {
        let steps = i32::from_le_bytes(bytes);
        (steps != i32::MIN).then(|| f64::from(steps) / 1e7)
    };
    let (lat, lon) = (place(take(&mut rest)?), place(take(&mut rest)?));
    let mut hundredths = || {
        let steps = u16::from_le_bytes(take(&mut rest)?);
        Some((steps != u16::MAX).then(|| f64::from(steps) / 100.0))
    };
    let (compass, gyro, satellite) = (hundredths()?, hundredths()?, hundredths()?);
    let sog_kn = hundredths()?;
    let mut small = |steps: f64| {
        let value = i16::from_le_bytes(take(&mut rest)?);
        Some((value != i16::MIN).then(|| f64::from(value) / steps))
    };
    Some(Second {
        time: Timestamp::from_micros(i64::from(seconds) * 1_000_000).ok()?,
        position: match (lat, lon) {
            (Some(lat), Some(lon)) => Position::new(lat, lon).ok(),
            _ => None,
        },
        compass: compass.and_then(CompassHeading::new),
        gyro: gyro.and_then(TrueHeading::new),
        satellite: satellite.and_then(TrueHeading::new),
        sog_kn,
        rate_of_turn_deg_min: small(10.0)?,
        roll_deg: small(100.0)?,
    })
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (taken, left) = rest.split_first_chunk::<N>()?;
    *rest = left;
    Some(*taken)
}
