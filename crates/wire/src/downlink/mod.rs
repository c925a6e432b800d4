//! The server's response to an agent as bytes, format `bd1`: an eighth of its
//! size as JSON.
//!
//! `DOWNLINK.md` in this crate describes every byte. Invariants:
//!
//! - A response is decoded as it was encoded, with two exceptions: times are
//!   whole seconds, and the model's deviation stays within 0.001° and its band
//!   within 0.005°.
//! - [`decode`] accepts or refuses any bytes, in time and memory bounded by
//!   their number, and never panics.
//! - Fields that a later server adds are skipped.

mod fields;
mod model;

use crate::codec::bits::{BitReader, BitWriter};
use crate::messages::{Downlink, Settings};
use fields::{read_time, read_withdrawn, write_time, write_withdrawn};
use uuid::Uuid;

/// The form that an agent asks for: `?form=1`.
pub const FORM: u8 = 1;

/// The ALPN protocol (RFC 7301) of an agent that will not connect again within
/// a day. A ticket for a next session would be useless to it.
pub const ONCE: &[u8] = b"once";

const MAGIC: [u8; 2] = *b"BD";
/// Bytes of magic and version.
const HEAD_BYTES: usize = 3;
const CHECKSUM_BYTES: usize = 4;
const MODEL: u64 = 1;
const CARD_WITHDRAWN: u64 = 2;
const SETTINGS: u64 = 3;

/// The reason why bytes are not a readable response.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The bytes are something else altogether.
    #[error("these bytes are not a compact response: they do not begin with 42 44")]
    BadMagic,
    /// The bytes were damaged or cut on the way.
    #[error("the compact response is damaged")]
    Damaged,
    /// A later form, although the agent did not ask for it.
    #[error("the compact response has form {0}, and this program reads form 1")]
    Form(u8),
    /// A part is cut short or out of range.
    #[error("the compact response's {0} cannot be read")]
    Bad(&'static str),
}

/// The name of an agent's current model in `&card=`: the last eight hexadecimal
/// digits of its id, which are random.
pub fn card_tag(model: Uuid) -> String {
    format!("{:08x}", model.as_u128() as u32)
}

/// Writes a response; `None` when this form cannot carry its model, which then
/// goes as JSON.
pub fn encode(downlink: &Downlink) -> Option<Vec<u8>> {
    let mut writer = BitWriter::default();
    writer.bytes(&MAGIC);
    writer.bytes(&[FORM]);
    writer.varint(downlink.contiguous_seq);
    write_time(&mut writer, downlink.server_time)?;
    if let Some(model) = &downlink.model {
        write_part(&mut writer, MODEL, &model::encode(model)?);
    }
    if let Some(withdrawn) = &downlink.card_withdrawn {
        let mut part = BitWriter::default();
        write_withdrawn(&mut part, withdrawn)?;
        write_part(&mut writer, CARD_WITHDRAWN, &part.into_bytes());
    }
    if let Some(settings) = &downlink.settings {
        // Settings change once a year: JSON is compact enough.
        let text = serde_json::to_vec(settings).ok()?;
        write_part(&mut writer, SETTINGS, &text);
    }
    let mut bytes = writer.into_bytes();
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    Some(bytes)
}

/// True for the bytes of a response in this form or a later one.
pub fn is_compact(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Reads a response.
///
/// # Errors
/// Fails when the bytes are another thing, incomplete, or of a later form.
pub fn decode(bytes: &[u8]) -> Result<Downlink, DecodeError> {
    if !is_compact(bytes) {
        return Err(DecodeError::BadMagic);
    }
    let body = bytes.len().checked_sub(CHECKSUM_BYTES);
    let body = body.filter(|body| *body >= HEAD_BYTES);
    let (content, checksum) = bytes.split_at(body.ok_or(DecodeError::Damaged)?);
    if crc32fast::hash(content).to_le_bytes() != checksum {
        return Err(DecodeError::Damaged);
    }
    if content[2] != FORM {
        return Err(DecodeError::Form(content[2]));
    }
    let mut reader = BitReader::new(&content[HEAD_BYTES..]);
    let contiguous_seq = reader.varint().map_err(|_| DecodeError::Damaged)?;
    let mut downlink = Downlink {
        contiguous_seq,
        model: None,
        unread: None,
        card_withdrawn: None,
        settings: None,
        server_time: read_time(&mut reader).ok_or(DecodeError::Bad("time"))?,
    };
    while reader.left() > 0 {
        let (kind, bytes) = read_part(&mut reader).ok_or(DecodeError::Damaged)?;
        let mut part = BitReader::new(&bytes);
        match kind {
            MODEL => {
                let model = model::read(&mut part).ok_or(DecodeError::Bad("model"))?;
                downlink.model = Some(model);
            }
            CARD_WITHDRAWN => {
                let withdrawn = read_withdrawn(&mut part);
                let withdrawn = withdrawn.ok_or(DecodeError::Bad("withdrawal"))?;
                downlink.card_withdrawn = Some(withdrawn);
            }
            SETTINGS => downlink.settings = Some(read_settings(&bytes)?),
            _ => {}
        }
    }
    Ok(downlink)
}

fn write_part(writer: &mut BitWriter, kind: u64, bytes: &[u8]) {
    writer.varint(kind);
    writer.varint(bytes.len() as u64);
    writer.bytes(bytes);
}

fn read_part(reader: &mut BitReader<'_>) -> Option<(u64, Vec<u8>)> {
    let kind = reader.varint().ok()?;
    let length = usize::try_from(reader.varint().ok()?).ok()?;
    Some((kind, reader.bytes(length).ok()?))
}

fn read_settings(bytes: &[u8]) -> Result<Settings, DecodeError> {
    serde_json::from_slice(bytes).map_err(|_| DecodeError::Bad("settings"))
}

#[cfg(test)]
mod tests;
