//! The tally in a frame: well-known reasons by number, others by name.

use super::bits::{BitReader, BitWriter};
use super::error::{DecodeError, EncodeError};
use crate::reasons;
use std::collections::BTreeMap;

/// The most reasons of one tally.
const REASONS_MAX: usize = 255;
/// The most bytes of a reason's name.
const NAME_MAX: usize = 64;
/// Stands in place of a number before a name.
const NAMED: u64 = 0;

/// Writes the tally in order of the names.
pub(super) fn write(
    writer: &mut BitWriter,
    tally: &BTreeMap<String, u64>,
) -> Result<(), EncodeError> {
    if tally.len() > REASONS_MAX {
        return Err(EncodeError::TooManyReasons(tally.len()));
    }
    writer.varint(tally.len() as u64);
    for (name, count) in tally {
        match reasons::number(name) {
            Some(number) => writer.varint(number),
            None => write_name(writer, name)?,
        }
        writer.varint(*count);
    }
    Ok(())
}

fn write_name(writer: &mut BitWriter, name: &str) -> Result<(), EncodeError> {
    if name.is_empty() || name.len() > NAME_MAX {
        return Err(EncodeError::ReasonName(name.to_owned()));
    }
    writer.varint(NAMED);
    writer.varint(name.len() as u64);
    writer.bytes(name.as_bytes());
    Ok(())
}

/// Reads the tally of [`write()`], with the names in any order.
pub(super) fn read(reader: &mut BitReader<'_>) -> Result<BTreeMap<String, u64>, DecodeError> {
    let entries = reader.varint()?;
    let mut tally = BTreeMap::new();
    for entry in 0..entries {
        let entry = entry as usize;
        if entry >= REASONS_MAX {
            return Err(DecodeError::BadReason(entry));
        }
        let name = match reader.varint()? {
            NAMED => read_name(reader, entry)?,
            number => reasons::name(number)
                .ok_or(DecodeError::BadReason(entry))?
                .to_owned(),
        };
        if tally.insert(name, reader.varint()?).is_some() {
            return Err(DecodeError::BadReason(entry));
        }
    }
    Ok(tally)
}

fn read_name(reader: &mut BitReader<'_>, entry: usize) -> Result<String, DecodeError> {
    let length = reader.varint()?;
    if length == 0 || length > NAME_MAX as u64 {
        return Err(DecodeError::BadReason(entry));
    }
    String::from_utf8(reader.bytes(length as usize)?).map_err(|_| DecodeError::BadReason(entry))
}
