//! Fields that several parts of a response have in common.

use crate::codec::bits::{BitReader, BitWriter};
use crate::messages::CardWithdrawn;
use binnacle_compass::time::Timestamp;

/// The most bytes of a reason for withdrawing a card.
const MAX_REASON_BYTES: usize = 255;

/// Writes whole seconds since 1970; `None` for an earlier time.
pub(super) fn write_time(writer: &mut BitWriter, time: Timestamp) -> Option<()> {
    let seconds = u64::try_from(time.micros().div_euclid(1_000_000)).ok()?;
    writer.varint(seconds);
    Some(())
}

pub(super) fn read_time(reader: &mut BitReader<'_>) -> Option<Timestamp> {
    let seconds = i64::try_from(reader.varint().ok()?).ok()?;
    Timestamp::from_micros(seconds.checked_mul(1_000_000)?).ok()
}

pub(super) fn write_withdrawn(writer: &mut BitWriter, withdrawn: &CardWithdrawn) -> Option<()> {
    write_time(writer, withdrawn.since)?;
    let reason = withdrawn.reason.as_bytes();
    if reason.len() > MAX_REASON_BYTES {
        return None;
    }
    writer.varint(reason.len() as u64);
    writer.bytes(reason);
    Some(())
}

pub(super) fn read_withdrawn(reader: &mut BitReader<'_>) -> Option<CardWithdrawn> {
    let since = read_time(reader)?;
    let length = usize::try_from(reader.varint().ok()?).ok()?;
    if length > MAX_REASON_BYTES {
        return None;
    }
    let reason = String::from_utf8(reader.bytes(length).ok()?).ok()?;
    Some(CardWithdrawn { since, reason })
}
