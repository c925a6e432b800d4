//! Identity of a device on a bus: its NAME, product information, parameter groups and heartbeat.
//!
//! Layouts and units are those of canboat's published database (PGN reference, version 6).

use super::frame::{ALL, Header, Message};
use super::heading::{MAGNETIC_VARIATION, VESSEL_HEADING};
use super::identity::{Address, Name};
use std::time::Duration;

/// Number of the parameter group of an acknowledgement (ISO 11783-3).
pub(super) const ACKNOWLEDGEMENT: u32 = 59_392;
/// Number of the parameter group that lists all others.
pub(super) const GROUP_LIST: u32 = 126_464;
/// Number of the parameter group of the heartbeat.
pub(super) const HEARTBEAT: u32 = 126_993;
/// Number of the parameter group of the product information.
pub(super) const PRODUCT_INFORMATION: u32 = 126_996;

/// Interval of the heartbeat.
pub const HEARTBEAT_INTERVAL: Duration = Duration::from_mins(1);
/// Step of the heartbeat's interval, milliseconds.
const HEARTBEAT_STEP_MS: u128 = 10;
/// Sequence numbers of the heartbeat.
const SEQUENCES: u8 = 253;
/// Version of the standard, thousandths.
const STANDARD_VERSION: u16 = 2_100;
const TEXT_BYTES: usize = 32;

/// Parameter groups that it sends.
const SENT: [u32; 7] = [
    ACKNOWLEDGEMENT,
    super::frame::REQUEST,
    super::frame::ADDRESS_CLAIM,
    GROUP_LIST,
    HEARTBEAT,
    PRODUCT_INFORMATION,
    VESSEL_HEADING,
];
/// Parameter groups that it acts on.
const RECEIVED: [u32; 2] = [super::frame::REQUEST, super::frame::ADDRESS_CLAIM];

/// Device on the bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// Unique number, of 21 bits.
    pub unique_number: u32,
    /// Manufacturer's code, of 11 bits.
    pub manufacturer: u16,
    /// Name of the product.
    pub model: String,
    /// Version of the program.
    pub software: String,
    /// Serial number.
    pub serial: String,
}

impl Device {
    /// Returns the NAME of a sensor of the ship's heading that may have any address.
    pub fn name(&self) -> Name {
        const FUNCTION_OWN_SHIP_ATTITUDE: u64 = 140;
        const CLASS_NAVIGATION: u64 = 60;
        const MARINE: u64 = 4;
        const ANY_ADDRESS: u64 = 1;
        Name::from_number(
            u64::from(self.unique_number & 0x1f_ffff)
                | (u64::from(self.manufacturer & 0x7ff) << 21)
                | (FUNCTION_OWN_SHIP_ATTITUDE << 40)
                | (CLASS_NAVIGATION << 49)
                | (MARINE << 60)
                | (ANY_ADDRESS << 63),
        )
    }

    /// Returns the product information.
    pub(super) fn product_information(&self) -> Vec<u8> {
        let mut data = STANDARD_VERSION.to_le_bytes().to_vec();
        // No product code is assigned.
        data.extend([0, 0]);
        for text in [&self.model, &self.software, "", &self.serial].map(|text| text as &str) {
            let bytes = text.bytes().filter(u8::is_ascii).take(TEXT_BYTES);
            let from = data.len();
            data.extend(bytes);
            data.resize(from + TEXT_BYTES, 0xff);
        }
        // It is not certified, and the bus need not power it.
        data.extend([0, 0]);
        data
    }
}

/// Returns the heartbeat, to all.
pub(super) fn heartbeat(source: Address, sequence: u8) -> Message {
    let interval = HEARTBEAT_INTERVAL.as_millis() / HEARTBEAT_STEP_MS;
    let [low, high] = (interval as u16).to_le_bytes();
    let data = vec![
        low,
        high,
        sequence % SEQUENCES,
        0xff,
        0xff,
        0xff,
        0xff,
        0xff,
    ];
    to(ALL, 7, HEARTBEAT, source.number(), data)
}

/// Returns the lists of the groups that it sends and acts on.
pub(super) fn group_lists() -> [Vec<u8>; 2] {
    let list = |function: u8, groups: &[u32]| {
        let groups = groups.iter().flat_map(|pgn| group_bytes(*pgn));
        std::iter::once(function).chain(groups).collect()
    };
    let sent: Vec<u32> = SENT.into_iter().chain([MAGNETIC_VARIATION]).collect();
    [list(0, &sent), list(1, &RECEIVED)]
}

/// Returns the refusal of a request for a group that it does not send.
pub(super) fn refusal(pgn: u32) -> Vec<u8> {
    const REFUSED: u8 = 1;
    let [low, middle, high] = group_bytes(pgn);
    vec![REFUSED, 0xff, 0xff, 0xff, 0xff, low, middle, high]
}

/// Returns the number of a group as three bytes.
pub(super) fn group_bytes(pgn: u32) -> [u8; 3] {
    let [low, middle, high, _] = pgn.to_le_bytes();
    [low, middle, high]
}

pub(super) fn to(destination: u8, priority: u8, pgn: u32, source: u8, data: Vec<u8>) -> Message {
    let header = Header {
        priority,
        pgn,
        source,
        destination,
    };
    Message { header, data }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_its_parts_in_their_places() {
        let device = Device {
            unique_number: 42,
            manufacturer: 2046,
            model: String::new(),
            software: String::new(),
            serial: String::new(),
        };
        // Encoded by canboatjs 3.20, but for the reserved bit, which it sets.
        let bytes = [0x2a, 0x00, 0xc0, 0xff, 0x00, 0x8c, 0x78, 0xc0];
        assert_eq!(device.name().number(), u64::from_le_bytes(bytes));
    }

    #[test]
    fn a_heartbeat_and_a_refusal_have_the_bytes_that_other_programs_read() {
        let beat = heartbeat(Address::new(35).unwrap(), 3);
        // Encoded by canboatjs 3.20.
        assert_eq!(beat.data, [0x70, 0x17, 3, 0xff, 0xff, 0xff, 0xff, 0xff]);
        assert_eq!(heartbeat(Address::new(35).unwrap(), 253).data[2], 0);
        // A message of canboatjs's tests (test/pgns/59392.js).
        let bytes = [0x01, 0xff, 0xff, 0xff, 0xff, 0x16, 0xf0, 0x01];
        assert_eq!(refusal(126_998), bytes);
    }
}
