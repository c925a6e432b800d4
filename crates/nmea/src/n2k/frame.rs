//! Frames and messages, with the header that a CAN identifier carries.

/// Number of the parameter group of an address claim (ISO 11783-5).
pub(super) const ADDRESS_CLAIM: u32 = 60_928;
/// Number of the parameter group of a request (ISO 11783-3).
pub(super) const REQUEST: u32 = 59_904;
/// Destination of a message to all.
pub(super) const ALL: u8 = 255;
/// First PDU format whose second byte belongs to the group's number (ISO 11783-3: PDU2).
const FIRST_BROADCAST_FORMAT: u32 = 240;
/// Bits of an extended CAN identifier.
const IDENTIFIER_BITS: u32 = 0x1fff_ffff;

/// Returns whether a parameter group is a claim or a request, which a sender on the bus must read.
pub fn is_network_management(pgn: u32) -> bool {
    matches!(pgn, ADDRESS_CLAIM | REQUEST)
}

/// Priority, parameter group, source and destination of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Header {
    /// Priority, 0 (highest) to 7.
    pub priority: u8,
    /// Number of the parameter group: 0 to 131,071 on a bus.
    pub pgn: u32,
    /// Address of the sender.
    pub source: u8,
    /// Address of the receiver; 255 for all.
    pub destination: u8,
}

impl Header {
    /// Reads the 29 bits of an extended CAN identifier; higher bits are ignored.
    pub fn from_identifier(identifier: u32) -> Header {
        let identifier = identifier & IDENTIFIER_BITS;
        let format = (identifier >> 16) & 0xff;
        let specific = (identifier >> 8) & 0xff;
        let page = (identifier >> 24) & 0x01;
        let is_broadcast = format >= FIRST_BROADCAST_FORMAT;
        let low = if is_broadcast { specific } else { 0 };
        Header {
            priority: (identifier >> 26) as u8,
            pgn: (page << 16) | (format << 8) | low,
            source: identifier as u8,
            destination: if is_broadcast { ALL } else { specific as u8 },
        }
    }

    /// Returns the CAN identifier, 29 bits.
    pub fn identifier(self) -> u32 {
        let format = (self.pgn >> 8) & 0xff;
        let specific = if format >= FIRST_BROADCAST_FORMAT {
            self.pgn & 0xff
        } else {
            u32::from(self.destination)
        };
        let page = (self.pgn >> 16) & 0x01;
        (u32::from(self.priority & 0x07) << 26)
            | (page << 24)
            | (format << 16)
            | (specific << 8)
            | u32::from(self.source)
    }
}

/// Frame of a CAN bus with an extended identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Header.
    pub header: Header,
    bytes: [u8; 8],
    length: u8,
}

impl Frame {
    /// Makes a frame; `None` for more than eight bytes.
    pub fn new(header: Header, data: &[u8]) -> Option<Frame> {
        let mut bytes = [0xff; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Frame {
            header,
            bytes,
            length: data.len() as u8,
        })
    }

    /// The bytes of the frame, at most eight.
    pub fn data(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

/// Whole message: a single frame's, or a fast packet's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Header.
    pub header: Header,
    /// Content, at most 223 bytes.
    pub data: Vec<u8>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identifier_reads_and_writes_its_header() {
        for (identifier, priority, pgn, source, destination) in [
            (0x09f1_1213, 2, 127_250, 0x13, ALL),
            (0x0df1_1913, 3, 127_257, 0x13, ALL),
            (0x18ea_ff44, 6, REQUEST, 0x44, ALL),
            (0x18ee_ff07, 6, ADDRESS_CLAIM, 0x07, ALL),
            (0x18ea_0344, 6, REQUEST, 0x44, 3),
        ] {
            let header = Header::from_identifier(identifier);
            let expected = Header {
                priority,
                pgn,
                source,
                destination,
            };
            assert_eq!(header, expected);
            assert_eq!(header.identifier(), identifier);
        }
    }

    #[test]
    fn a_frame_has_eight_bytes_at_most() {
        let header = Header::from_identifier(0x09f1_1213);
        assert_eq!(Frame::new(header, &[1, 2]).unwrap().data(), [1, 2]);
        assert!(Frame::new(header, &[0; 8]).is_some());
        assert_eq!(Frame::new(header, &[0; 9]), None);
    }
}
