//! Fast packets: messages of up to 223 bytes in several frames.
//!
//! The first byte of each frame has a sequence number in its upper three bits and the frame's
//! number in the lower five; the first frame's second byte is the length.

use super::frame::{Frame, Header, Message};

/// Greatest length of a message.
const MOST_BYTES: usize = 223;
/// Bytes of content in the first frame and in each later one.
const FIRST_BYTES: usize = 6;
const LATER_BYTES: usize = 7;
/// Messages that may be incomplete at a time; the oldest gives way.
const MOST_OPEN: usize = 64;

/// Makes messages of frames, in memory bounded whatever the frames are.
#[derive(Debug, Default)]
pub struct Assembler {
    open: Vec<Open>,
}

/// Incomplete message.
#[derive(Debug)]
struct Open {
    header: Header,
    sequence: u8,
    length: usize,
    data: Vec<u8>,
    next: u8,
}

impl Assembler {
    /// Adds a frame. Returns the message that it completes.
    ///
    /// Frames of groups other than those of [`super::Data`] count as single ones.
    pub fn add(&mut self, frame: &Frame) -> Option<Message> {
        if !is_fast_packet(frame.header.pgn) {
            return Some(Message {
                header: frame.header,
                data: frame.data().to_vec(),
            });
        }
        let (&first, rest) = frame.data().split_first()?;
        let (sequence, number) = (first >> 5, first & 0x1f);
        if number == 0 {
            return self.begin(frame.header, sequence, rest);
        }
        let at = self.position(frame.header)?;
        let open = &mut self.open[at];
        if open.sequence != sequence || open.next != number {
            // A frame was lost: nothing of the message is sure.
            self.open.remove(at);
            return None;
        }
        open.next += 1;
        open.data.extend_from_slice(rest);
        self.complete(at)
    }

    fn begin(&mut self, header: Header, sequence: u8, rest: &[u8]) -> Option<Message> {
        if let Some(at) = self.position(header) {
            self.open.remove(at);
        }
        let (&length, data) = rest.split_first()?;
        let length = usize::from(length);
        if length > MOST_BYTES {
            return None;
        }
        if self.open.len() == MOST_OPEN {
            self.open.remove(0);
        }
        self.open.push(Open {
            header,
            sequence,
            length,
            data: data.to_vec(),
            next: 1,
        });
        self.complete(self.open.len() - 1)
    }

    fn position(&self, header: Header) -> Option<usize> {
        self.open
            .iter()
            .position(|open| (open.header.source, open.header.pgn) == (header.source, header.pgn))
    }

    fn complete(&mut self, at: usize) -> Option<Message> {
        if self.open[at].data.len() < self.open[at].length {
            return None;
        }
        let mut open = self.open.remove(at);
        open.data.truncate(open.length);
        Some(Message {
            header: open.header,
            data: open.data,
        })
    }
}

/// Returns whether a parameter group comes in fast packets.
fn is_fast_packet(pgn: u32) -> bool {
    matches!(pgn, 126_464 | 126_996 | 129_029)
}

/// Splits a message into its frames; `sequence` tells apart fast packets of one group.
pub fn split(message: &Message, sequence: u8) -> Vec<Frame> {
    if !is_fast_packet(message.header.pgn) {
        return Frame::new(message.header, &message.data)
            .into_iter()
            .collect();
    }
    let data = &message.data[..message.data.len().min(MOST_BYTES)];
    let (first, later) = data.split_at(data.len().min(FIRST_BYTES));
    let mark = |number: usize| ((sequence & 0x07) << 5) | number as u8;
    let mut head = vec![mark(0), data.len() as u8];
    head.extend_from_slice(first);
    let mut contents = vec![head];
    for (index, part) in later.chunks(LATER_BYTES).enumerate() {
        let mut content = vec![mark(index + 1)];
        content.extend_from_slice(part);
        contents.push(content);
    }
    contents
        .into_iter()
        .filter_map(|mut content| {
            content.resize(8, 0xff);
            Frame::new(message.header, &content)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(length: u8) -> Message {
        Message {
            header: Header {
                priority: 3,
                pgn: 129_029,
                source: 7,
                destination: 255,
            },
            data: (0..length).collect(),
        }
    }

    fn assembled(frames: &[Frame]) -> Vec<Message> {
        let mut assembler = Assembler::default();
        frames.iter().filter_map(|f| assembler.add(f)).collect()
    }

    #[test]
    fn a_message_of_any_length_comes_back_from_its_frames() {
        for length in [0, 1, 6, 7, 13, 14, 43, 134, 223] {
            let frames = split(&message(length), 5);
            assert_eq!(assembled(&frames), [message(length)], "{length}");
        }
    }

    #[test]
    fn a_lost_or_repeated_frame_loses_its_message_alone() {
        let (one, two) = (split(&message(43), 1), split(&message(43), 2));
        let with_loss: Vec<Frame> = one.iter().skip(1).chain(&two).copied().collect();
        assert_eq!(assembled(&with_loss).len(), 1);
        let gap: Vec<Frame> = [&one[..3], &one[4..], &two[..]].concat();
        assert_eq!(assembled(&gap).len(), 1);
        let twice: Vec<Frame> = one.iter().flat_map(|frame| [*frame; 2]).collect();
        assert_eq!(assembled(&twice), []);
    }

    #[test]
    fn messages_of_several_senders_may_be_mixed() {
        let mut other = message(43);
        other.header.source = 8;
        let pairs = split(&message(43), 0).into_iter().zip(split(&other, 0));
        let mixed: Vec<Frame> = pairs.flat_map(|(a, b)| [a, b]).collect();
        assert_eq!(assembled(&mixed), [message(43), other]);
    }

    #[test]
    fn open_messages_are_bounded() {
        let mut assembler = Assembler::default();
        for pgn_source in 0..=250 {
            let mut first = message(43);
            first.header.source = pgn_source;
            assembler.add(&split(&first, 0)[0]);
        }
        assert_eq!(assembler.open.len(), MOST_OPEN);
    }
}
