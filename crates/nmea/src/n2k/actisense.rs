//! Messages as Actisense gateways send them, and as their loggers store them.
//!
//! A message lies between `DLE STX` and `DLE ETX`, with each DLE in it doubled: command, length,
//! content, and a byte that makes the sum of all zero. A received message has priority, group,
//! destination, source, the gateway's milliseconds, length and data. In an EBL file, records
//! between `ESC SOH` and `ESC LF` stand among the messages, with each ESC doubled; the one of type
//! 3 has the time as 100 ns since 1601.

use super::frame::{Header, Message};
use super::text::Stamp;

const DLE: u8 = 0x10;
const STX: u8 = 0x02;
const ETX: u8 = 0x03;
const ESC: u8 = 0x1b;
const SOH: u8 = 0x01;
const LF: u8 = 0x0a;
/// Command of a received message, and of one to be sent.
const RECEIVED: u8 = 0x93;
const SEND: u8 = 0x94;
/// Bytes before the data of a received message.
const HEADER_BYTES: usize = 11;
/// Type of the record with the time.
const TIME_RECORD: u8 = 3;
/// Microseconds from 1601 to 1970.
const FROM_1601_MICROS: i64 = 11_644_473_600_000_000;
/// Bytes of a recording in which the first message is looked for.
pub const SEARCHED_BYTES: usize = 1024;
/// Longest frame: command, length, content of 255 bytes, checksum.
const MOST_BYTES: usize = 258;

/// Decoder of a stream of bytes, in bounded memory whatever the bytes are.
#[derive(Debug, Default)]
pub struct Decoder {
    is_ebl: bool,
    state: State,
    buffer: Vec<u8>,
    unix_micros: Option<i64>,
    /// Frames that were damaged.
    pub damaged: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Between,
    BetweenAfterDle,
    BetweenAfterEsc,
    Frame,
    FrameAfterDle,
    Record,
    RecordAfterEsc,
}

impl Decoder {
    /// Makes the decoder of a recording by its first [`SEARCHED_BYTES`], or all if it is shorter;
    /// `None` if they are of no such one.
    pub fn of_recording(first: &[u8]) -> Option<Decoder> {
        if first.starts_with(&[ESC, SOH]) {
            return Some(Decoder::of_ebl());
        }
        let first = &first[..first.len().min(SEARCHED_BYTES)];
        let has_message = first.windows(3).any(|w| w == [DLE, STX, RECEIVED]);
        has_message.then(Decoder::of_stream)
    }

    /// Makes the decoder of a gateway's stream.
    pub fn of_stream() -> Decoder {
        Decoder::default()
    }

    /// Makes the decoder of an EBL file.
    pub fn of_ebl() -> Decoder {
        Decoder {
            is_ebl: true,
            ..Decoder::default()
        }
    }

    /// Decodes bytes, and passes each whole message with its time to `each`.
    pub fn push(&mut self, bytes: &[u8], mut each: impl FnMut(Stamp, Message)) {
        for byte in bytes {
            if let Some(message) = self.byte(*byte) {
                each(self.unix_micros.map_or(Stamp::None, Stamp::Unix), message);
            }
        }
    }

    fn byte(&mut self, byte: u8) -> Option<Message> {
        self.state = match (self.state, byte) {
            (State::Between, DLE) => State::BetweenAfterDle,
            (State::Between, ESC) if self.is_ebl => State::BetweenAfterEsc,
            (State::BetweenAfterDle | State::FrameAfterDle, STX) => {
                if self.state == State::FrameAfterDle {
                    self.damaged += 1;
                }
                self.buffer.clear();
                State::Frame
            }
            (State::BetweenAfterEsc, SOH) => {
                self.buffer.clear();
                State::Record
            }
            (State::Frame, DLE) => State::FrameAfterDle,
            (State::FrameAfterDle, ETX) => {
                self.state = State::Between;
                let message = received(&self.buffer);
                if message.is_none() && !is_other_command(&self.buffer) {
                    self.damaged += 1;
                }
                return message;
            }
            (State::Frame, byte) | (State::FrameAfterDle, byte @ DLE) => {
                self.keep(byte, State::Frame)
            }
            (State::FrameAfterDle, _) => {
                self.damaged += 1;
                State::Between
            }
            (State::Record, ESC) => State::RecordAfterEsc,
            (State::RecordAfterEsc, LF) => {
                self.record();
                State::Between
            }
            (State::Record, byte) | (State::RecordAfterEsc, byte @ ESC) => {
                self.keep(byte, State::Record)
            }
            (
                State::Between
                | State::BetweenAfterDle
                | State::BetweenAfterEsc
                | State::RecordAfterEsc,
                _,
            ) => State::Between,
        };
        None
    }

    fn keep(&mut self, byte: u8, state: State) -> State {
        if self.buffer.len() == MOST_BYTES {
            self.damaged += 1;
            return State::Between;
        }
        self.buffer.push(byte);
        state
    }

    fn record(&mut self) {
        let Some((&TIME_RECORD, time)) = self.buffer.split_first() else {
            return;
        };
        if let Ok(time) = <[u8; 8]>::try_from(time) {
            let micros = i64::try_from(u64::from_le_bytes(time) / 10).ok();
            self.unix_micros = micros.map(|micros| micros - FROM_1601_MICROS);
        }
    }
}

/// Returns whether a sound frame has another command.
fn is_other_command(frame: &[u8]) -> bool {
    is_sound(frame) && frame.first() != Some(&RECEIVED)
}

fn is_sound(frame: &[u8]) -> bool {
    let sum = frame.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    let stated = frame.get(1).map(|length| usize::from(*length) + 3);
    sum == 0 && stated == Some(frame.len())
}

/// Reads the message of a frame.
fn received(frame: &[u8]) -> Option<Message> {
    if !is_sound(frame) {
        return None;
    }
    let [RECEIVED, _, content @ .., _checksum] = frame else {
        return None;
    };
    let (header, data) = content.split_at_checked(HEADER_BYTES)?;
    let &[priority, low, middle, high, destination, source, .., length] = header else {
        return None;
    };
    if data.len() != usize::from(length) {
        return None;
    }
    Some(Message {
        header: Header {
            priority: priority & 0x07,
            pgn: u32::from_le_bytes([low, middle, high & 0x01, 0]),
            source,
            destination,
        },
        data: data.to_vec(),
    })
}

/// Writes a message for a gateway to send; the gateway sets the source.
pub fn write(message: &Message) -> Vec<u8> {
    let [low, middle, high, _] = message.header.pgn.to_le_bytes();
    let data = &message.data[..message.data.len().min(223)];
    let mut frame = vec![
        SEND,
        data.len() as u8 + 6,
        message.header.priority,
        low,
        middle,
        high,
        message.header.destination,
        data.len() as u8,
    ];
    frame.extend_from_slice(data);
    let sum = frame.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    frame.push(0_u8.wrapping_sub(sum));
    let mut out = vec![DLE, STX];
    for byte in frame {
        if byte == DLE {
            out.push(DLE);
        }
        out.push(byte);
    }
    out.extend([DLE, ETX]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heading of a magnetic sensor at address 204, with a doubled DLE in it.
    const FRAME: [u8; 26] = [
        0x10, 0x02, 0x93, 0x13, 0x02, 0x12, 0xf1, 0x01, 0xff, 0xcc, 0xb1, 0x5d, 0x0a, 0x00, 0x08,
        0xff, 0x10, 0x10, 0xed, 0xff, 0x7f, 0xff, 0x7f, 0xfd, 0x74, 0x10,
    ];

    fn decode(mut decoder: Decoder, bytes: &[u8]) -> (Vec<(Stamp, Message)>, u64) {
        let mut out = Vec::new();
        decoder.push(bytes, |stamp, message| out.push((stamp, message)));
        (out, decoder.damaged)
    }

    fn frame() -> Vec<u8> {
        let mut frame = FRAME.to_vec();
        frame.push(ETX);
        frame
    }

    #[test]
    fn a_message_is_read_from_a_stream_that_begins_anywhere() {
        let bytes = [&frame()[9..], &frame(), &[0x00], &frame()].concat();
        let (messages, damaged) = decode(Decoder::of_stream(), &bytes);
        assert_eq!((messages.len(), damaged), (2, 0));
        let (stamp, message) = &messages[0];
        assert_eq!(*stamp, Stamp::None);
        assert_eq!((message.header.pgn, message.header.source), (127_250, 204));
        assert_eq!(message.data[..2], [0xff, 0x10]);
    }

    #[test]
    fn a_recording_is_known_by_its_first_bytes() {
        assert!(Decoder::of_recording(&frame()).is_some_and(|d| !d.is_ebl));
        assert!(Decoder::of_recording(&[ESC, SOH, 3]).is_some_and(|d| d.is_ebl));
        assert!(Decoder::of_recording(b"$HCHDG,98.3,1.5,W,12.6,E*53").is_none());
    }

    #[test]
    fn a_damaged_frame_is_counted_and_the_next_is_read() {
        let mut broken = frame();
        broken[12] ^= 1;
        let (messages, damaged) = decode(Decoder::of_stream(), &[broken, frame()].concat());
        assert_eq!((messages.len(), damaged), (1, 1));
        let cut = [&frame()[..12], &frame()].concat();
        let (messages, damaged) = decode(Decoder::of_stream(), &cut);
        assert_eq!((messages.len(), damaged), (1, 1));
        let endless = [&FRAME[..14], &[0x00; 1000], &frame()].concat();
        assert_eq!(decode(Decoder::of_stream(), &endless).0.len(), 1);
    }

    #[test]
    fn a_record_of_an_ebl_file_gives_the_time() {
        let unix_micros = 1_708_146_949_768_000_i64;
        let filetime = ((unix_micros + FROM_1601_MICROS) * 10).to_le_bytes();
        let mut bytes = vec![ESC, SOH, TIME_RECORD];
        for byte in filetime {
            if byte == ESC {
                bytes.push(ESC);
            }
            bytes.push(byte);
        }
        bytes.extend([ESC, LF]);
        bytes.extend(frame());
        let (messages, _) = decode(Decoder::of_ebl(), &bytes);
        assert_eq!(messages[0].0, Stamp::Unix(unix_micros));
    }

    #[test]
    fn a_message_to_send_has_a_sum_of_zero_and_doubles_each_dle() {
        let message = Message {
            header: Header {
                priority: 2,
                pgn: 127_250,
                source: 0,
                destination: 255,
            },
            data: vec![DLE; 8],
        };
        let bytes = write(&message);
        let doubled = bytes[2..].windows(2).filter(|pair| *pair == [DLE, DLE]);
        assert_eq!((bytes.len(), doubled.count()), (29, 15));
        let plain: Vec<u8> = bytes[2..10].iter().copied().chain([DLE; 8]).collect();
        let sum = plain.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        assert_eq!(bytes[bytes.len() - 3], 0_u8.wrapping_sub(sum));
    }
}
