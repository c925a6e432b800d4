//! The frame: header, tally, notes, profile, columns, checksum.

use super::bits::{BitReader, BitWriter};
use super::columns::{self, Column};
use super::dense;
use super::error::{DecodeError, EncodeError};
use super::notes::{self, Notes};
use super::plain;
use super::range::{RangeReader, RangeWriter};
use super::step::Step;
use super::tally;
use crate::batch::{Batch, StreamId};
use uuid::Uuid;

/// The largest frame, in bytes.
pub const MAX_BYTES: usize = 262_144;
/// The most samples of one frame.
pub const MAX_SAMPLES: usize = 65_535;

const MAGIC: [u8; 2] = *b"BN";
const VERSION: u8 = 1;
/// Notes follow the tally.
const HAS_NOTES: u8 = 1;
/// The columns are range-coded.
const IS_DENSE: u8 = 2;
/// Bytes of magic, version and flags.
const HEAD_BYTES: usize = 4;
const CHECKSUM_BYTES: usize = 4;
/// Columns that a frame may have, known and unknown.
const MAX_COLUMNS: u64 = 64;

/// Writes a batch as a frame, with the samples in order of time.
///
/// # Errors
/// Fails when a value is out of range (see [`super::check`]) or the batch is too
/// large.
pub fn encode(batch: &Batch) -> Result<Vec<u8>, EncodeError> {
    if batch.samples.len() > MAX_SAMPLES {
        return Err(EncodeError::TooManySamples(batch.samples.len()));
    }
    if batch.seq == 0 {
        return Err(EncodeError::SeqZero);
    }
    for (row, sample) in batch.samples.iter().enumerate() {
        columns::check(sample, row)?;
    }
    let mut samples = batch.samples.clone();
    samples.sort_by_key(|sample| sample.time);
    let columns = columns::from_samples(&samples);

    let mut writer = BitWriter::default();
    writer.bytes(&MAGIC);
    let has_notes = !batch.alerts.is_empty() || batch.thinned.is_some();
    let notes = if has_notes { HAS_NOTES } else { 0 };
    let dense = if samples.is_empty() { 0 } else { IS_DENSE };
    writer.bytes(&[VERSION, notes | dense]);
    writer.bytes(batch.stream.0.as_bytes());
    writer.varint(batch.seq);
    tally::write(&mut writer, &batch.tally)?;
    if has_notes {
        notes::write(&mut writer, &batch.alerts, batch.thinned)?;
    }
    writer.varint(samples.len() as u64);
    writer.varint(columns.len() as u64);
    for column in &columns {
        writer.varint(column.id);
        writer.bits(u64::from(column.step.byte()), 8);
    }
    let mut bytes = writer.into_bytes();
    bytes.extend(write_columns(&columns));
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    if bytes.len() > MAX_BYTES {
        return Err(EncodeError::TooLarge(bytes.len()));
    }
    Ok(bytes)
}

/// Range-codes the columns; no bytes for no columns.
fn write_columns(columns: &[Column]) -> Vec<u8> {
    let mut writer = RangeWriter::new();
    let mut times: Option<Vec<i64>> = None;
    for column in columns {
        dense::write(&mut writer, &column.values, times.as_deref());
        // The column of times is the first, and whole.
        times.get_or_insert_with(|| column.values.iter().flatten().copied().collect());
    }
    writer.into_bytes()
}

/// Reads a frame.
///
/// # Errors
/// Fails when the bytes are not a whole, undamaged frame of a version that this
/// decoder knows, or hold values out of range.
pub fn decode(bytes: &[u8]) -> Result<Batch, DecodeError> {
    let (flags, content) = content(bytes)?;
    let mut reader = BitReader::new(content);
    let stream = reader
        .bits(64)
        .and_then(|high| Ok((high, reader.bits(64)?)))?;
    let stream = StreamId(Uuid::from_u64_pair(stream.0, stream.1));
    let seq = reader.varint()?;
    if seq == 0 {
        return Err(DecodeError::SeqZero);
    }
    let tally = tally::read(&mut reader)?;
    let notes = if flags & HAS_NOTES == 0 {
        Notes::default()
    } else {
        notes::read(&mut reader)?
    };
    let stated = reader.varint()?;
    let count = usize::try_from(stated)
        .ok()
        .filter(|count| *count <= MAX_SAMPLES)
        .ok_or(DecodeError::TooManySamples(stated))?;
    let profile = read_profile(&mut reader)?;
    let columns = if flags & IS_DENSE == 0 {
        // Checked before anything of the size of `count` is allocated.
        if count > 0 && columns::REQUIRED * plain::min_bits(count) > reader.left() {
            return Err(DecodeError::TooManySamples(stated));
        }
        let columns = read_columns(&profile, |id, times| {
            plain::read(&mut reader, id, count, times)
        })?;
        reader.finish()?;
        columns
    } else {
        let mut reader = RangeReader::new(reader.rest())?;
        let columns = read_columns(&profile, |id, times| {
            dense::read(&mut reader, id, count, times)
        })?;
        reader.finish()?;
        columns
    };
    Ok(Batch {
        stream,
        seq,
        samples: columns::to_samples(&columns, count)?,
        tally,
        alerts: notes.alerts,
        thinned: notes.thinned,
    })
}

/// Returns the flags of an undamaged frame, and the bytes between its head and
/// checksum.
fn content(bytes: &[u8]) -> Result<(u8, &[u8]), DecodeError> {
    if bytes.len() > MAX_BYTES {
        return Err(DecodeError::TooLarge(bytes.len()));
    }
    if !bytes.starts_with(&MAGIC[..bytes.len().min(2)]) {
        return Err(DecodeError::BadMagic);
    }
    if bytes.len() < HEAD_BYTES + CHECKSUM_BYTES {
        return Err(DecodeError::Truncated);
    }
    let (body, checksum) = bytes
        .split_last_chunk::<CHECKSUM_BYTES>()
        .ok_or(DecodeError::Truncated)?;
    let (stated, computed) = (u32::from_le_bytes(*checksum), crc32fast::hash(body));
    if stated != computed {
        return Err(DecodeError::Checksum { stated, computed });
    }
    if body[2] != VERSION {
        return Err(DecodeError::UnsupportedVersion(body[2]));
    }
    if body[3] & !(HAS_NOTES | IS_DENSE) != 0 {
        return Err(DecodeError::UnsupportedFlags(body[3]));
    }
    Ok((body[3], &body[HEAD_BYTES..]))
}

/// Reads the column ids, which must rise, and their steps.
fn read_profile(reader: &mut BitReader<'_>) -> Result<Vec<(u64, Step)>, DecodeError> {
    let count = reader.varint()?;
    let mut profile = Vec::new();
    let mut last = 0;
    for index in 0..count {
        let id = reader.varint()?;
        if index >= MAX_COLUMNS || id <= last {
            return Err(DecodeError::ColumnOrder(id));
        }
        last = id;
        let step = Step::from_byte(reader.bits(8)? as u8).ok_or(DecodeError::BadStep(id))?;
        profile.push((id, step));
    }
    Ok(profile)
}

/// Reads every column with `read`, which gets its id and the times; unknown
/// columns are dropped.
fn read_columns(
    profile: &[(u64, Step)],
    mut read: impl FnMut(u64, Option<&[i64]>) -> Result<Vec<Option<i64>>, DecodeError>,
) -> Result<Vec<Column>, DecodeError> {
    let mut columns: Vec<Column> = Vec::new();
    let mut times = None;
    for (id, step) in profile {
        let values = read(*id, times.as_deref())?;
        if *id == columns::TIME {
            let all: Option<Vec<i64>> = values.iter().copied().collect();
            times = Some(all.ok_or(DecodeError::MissingColumn(*id))?);
        }
        if *id <= columns::LAST_KNOWN {
            columns.push(Column {
                id: *id,
                step: *step,
                values,
            });
        }
    }
    Ok(columns)
}
