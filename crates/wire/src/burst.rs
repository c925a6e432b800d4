//! Frames split into short-burst messages, and joined again, for a link that
//! carries a few hundred bytes at a time and loses, repeats and reorders them.
//!
//! Invariants: a joined frame can be read by [`decode`](crate::decode).
//! Whatever the order of messages, [`Joiner`] keeps at most [`MAX_OPEN`]
//! frames' worth of them. No bytes cause a panic.

use crate::batch::StreamId;
use crate::codec::{self, DecodeError};
use std::collections::VecDeque;

/// The largest message that every one of these modems accepts.
pub const MESSAGE_BYTES: usize = 340;
/// The most parts of one frame.
pub const PARTS_MAX: usize = 16;
/// The most incomplete frames that a joiner keeps.
pub const MAX_OPEN: usize = 256;

/// First byte of a part of a frame.
const PART: u8 = 0xb1;
/// First byte of an acknowledgement.
const ACK: u8 = 0xb2;
/// Bytes of kind and check.
const HEAD_BYTES: usize = 3;
const TAG_BYTES: usize = 4;
const VARINT_MAX: usize = 10;

/// The reason why a frame cannot be split, or a message not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BurstError {
    /// Not a frame, either given or joined.
    #[error(transparent)]
    Frame(#[from] DecodeError),
    /// It would take more than [`PARTS_MAX`] messages.
    #[error("a frame of {0} bytes is too large for {PARTS_MAX} messages")]
    TooLarge(usize),
    /// More than [`MESSAGE_BYTES`].
    #[error("a message of {0} bytes is too long")]
    TooLong(usize),
    /// A message of an unknown kind.
    #[error("not a short-burst message")]
    UnknownKind,
    /// The message ends within its head.
    #[error("the message is cut short")]
    Truncated,
    /// The check does not match.
    #[error("the message is damaged")]
    Damaged,
    /// The part's number is beyond the last.
    #[error("no part {part} in a frame of {parts} parts")]
    NoSuchPart {
        /// Number of the part, from 0.
        part: usize,
        /// Number of parts.
        parts: usize,
    },
}

/// Short form of a stream in a message: the end of its UUID.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StreamTag([u8; TAG_BYTES]);

impl StreamTag {
    /// Returns the tag of a stream.
    pub fn from_stream(stream: StreamId) -> StreamTag {
        let bytes = stream.0.as_bytes();
        let mut tag = [0; TAG_BYTES];
        tag.copy_from_slice(&bytes[bytes.len() - TAG_BYTES..]);
        StreamTag(tag)
    }
}

/// Acknowledgement that every batch up to this one is durable on the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ack {
    /// The stream.
    pub stream: StreamTag,
    /// As in [`Downlink`](crate::messages::Downlink).
    pub contiguous_seq: u64,
}

/// Returns the most bytes of a frame that `messages` messages carry, for any
/// sequence number.
pub const fn capacity(messages: usize) -> usize {
    messages * (MESSAGE_BYTES - HEAD_BYTES - TAG_BYTES - VARINT_MAX - 1)
}

/// Splits a frame into messages of nearly equal size.
///
/// # Errors
/// Fails when it is not a frame, or too large.
pub fn split(frame: &[u8]) -> Result<Vec<Vec<u8>>, BurstError> {
    let batch = codec::decode(frame)?;
    let mut head = StreamTag::from_stream(batch.stream).0.to_vec();
    put_varint(&mut head, batch.seq);
    let capacity = MESSAGE_BYTES - HEAD_BYTES - head.len() - 1;
    let parts = frame.len().div_ceil(capacity);
    if parts > PARTS_MAX {
        return Err(BurstError::TooLarge(frame.len()));
    }
    let chunks = frame.chunks(frame.len().div_ceil(parts));
    let messages = chunks.enumerate().map(|(part, chunk)| {
        let mut content = head.clone();
        content.push((part << 4 | (parts - 1)) as u8);
        content.extend(chunk);
        message(PART, &content)
    });
    Ok(messages.collect())
}

/// Writes the server's acknowledgement.
pub fn write_ack(ack: Ack) -> Vec<u8> {
    let mut content = ack.stream.0.to_vec();
    put_varint(&mut content, ack.contiguous_seq);
    message(ACK, &content)
}

/// Reads the bytes of [`write_ack`]; fields that a later server may append are
/// ignored.
///
/// # Errors
/// Fails when the message is of another kind, or damaged.
pub fn read_ack(bytes: &[u8]) -> Result<Ack, BurstError> {
    let mut rest = content(ACK, bytes)?;
    Ok(Ack {
        stream: take_tag(&mut rest)?,
        contiguous_seq: take_varint(&mut rest)?,
    })
}

/// Joins the parts of frames, in any order.
#[derive(Debug, Default)]
pub struct Joiner {
    /// Incomplete frames, the oldest first.
    open: VecDeque<OpenFrame>,
}

/// An incomplete frame.
#[derive(Debug)]
struct OpenFrame {
    stream: StreamTag,
    seq: u64,
    parts: Vec<Option<Vec<u8>>>,
}

impl Joiner {
    /// Adds a message, and returns the frame that it completes.
    ///
    /// A part that differs from an earlier one restarts its frame: an agent's
    /// spool may have been lost. A frame that was joined before may be joined
    /// again.
    ///
    /// # Errors
    /// Fails when the message cannot be read, or the joined bytes are not a frame;
    /// those bytes are then dropped.
    pub fn push(&mut self, bytes: &[u8]) -> Result<Option<Vec<u8>>, BurstError> {
        let mut rest = content(PART, bytes)?;
        let (stream, seq) = (take_tag(&mut rest)?, take_varint(&mut rest)?);
        let (&place, chunk) = rest.split_first().ok_or(BurstError::Truncated)?;
        let (part, parts) = (usize::from(place >> 4), usize::from(place & 15) + 1);
        if part >= parts {
            return Err(BurstError::NoSuchPart { part, parts });
        }
        let known = |open: &OpenFrame| (open.stream, open.seq) == (stream, seq);
        let mut open = match self.open.iter().position(known) {
            Some(index) => self
                .open
                .remove(index)
                .unwrap_or(OpenFrame::new(stream, seq, parts)),
            None => OpenFrame::new(stream, seq, parts),
        };
        let is_other = |known: &Vec<u8>| known != chunk;
        if open.parts.len() != parts || open.parts[part].as_ref().is_some_and(is_other) {
            open = OpenFrame::new(stream, seq, parts);
        }
        open.parts[part] = Some(chunk.to_vec());
        let Some(chunks) = open.parts.iter().cloned().collect::<Option<Vec<_>>>() else {
            self.open.push_back(open);
            if self.open.len() > MAX_OPEN {
                self.open.pop_front();
            }
            return Ok(None);
        };
        let frame = chunks.concat();
        codec::decode(&frame)?;
        Ok(Some(frame))
    }

    /// Incomplete frames: stream, sequence number, parts received and parts in
    /// all.
    pub fn incomplete(&self) -> impl Iterator<Item = (StreamTag, u64, usize, usize)> {
        self.open.iter().map(|open| {
            let there = open.parts.iter().flatten().count();
            (open.stream, open.seq, there, open.parts.len())
        })
    }
}

impl OpenFrame {
    fn new(stream: StreamTag, seq: u64, parts: usize) -> OpenFrame {
        OpenFrame {
            stream,
            seq,
            parts: vec![None; parts],
        }
    }
}

fn message(kind: u8, content: &[u8]) -> Vec<u8> {
    let mut bytes = vec![kind];
    bytes.extend(check(kind, content).to_le_bytes());
    bytes.extend(content);
    bytes
}

/// The content behind kind and check, if both are right.
fn content(kind: u8, bytes: &[u8]) -> Result<&[u8], BurstError> {
    if bytes.len() > MESSAGE_BYTES {
        return Err(BurstError::TooLong(bytes.len()));
    }
    let (head, content) = bytes
        .split_first_chunk::<HEAD_BYTES>()
        .ok_or(BurstError::Truncated)?;
    if head[0] != kind {
        return Err(BurstError::UnknownKind);
    }
    if u16::from_le_bytes([head[1], head[2]]) != check(kind, content) {
        return Err(BurstError::Damaged);
    }
    Ok(content)
}

/// The low half of the CRC-32 of kind and content.
fn check(kind: u8, content: &[u8]) -> u16 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&[kind]);
    crc.update(content);
    crc.finalize() as u16
}

fn put_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn take_varint(rest: &mut &[u8]) -> Result<u64, BurstError> {
    let mut value = 0_u64;
    for shift in (0..64).step_by(7) {
        let (&byte, left) = rest.split_first().ok_or(BurstError::Truncated)?;
        *rest = left;
        let bits = u64::from(byte & 0x7f);
        if bits << shift >> shift != bits {
            return Err(BurstError::Damaged);
        }
        value |= bits << shift;
        if byte & 0x80 == 0 {
            return Ok(value);
        }
    }
    Err(BurstError::Damaged)
}

fn take_tag(rest: &mut &[u8]) -> Result<StreamTag, BurstError> {
    let (tag, left) = rest
        .split_first_chunk::<TAG_BYTES>()
        .ok_or(BurstError::Truncated)?;
    *rest = left;
    Ok(StreamTag(*tag))
}
