//! Address claim of a device, with what every device on a bus says of itself.
//!
//! Of two devices that claim an address, the one with the lower NAME keeps it (ISO 11783-5); the
//! other claims the next free one. A device sends nothing else before its claim has stood for
//! 250 ms.

use super::data::Data;
use super::frame::{ADDRESS_CLAIM, ALL, Header, Message, REQUEST};
use super::identity::{Address, Name};

/// Source of a device without an address.
const NO_ADDRESS: u8 = 254;
const ADDRESSES: u8 = 252;
const PRODUCT_INFORMATION: u32 = 126_996;
const HEARTBEAT: u32 = 126_993;
/// Interval of the heartbeat, milliseconds.
const HEARTBEAT_MS: u16 = 60_000;
/// Version of the standard, thousandths.
const STANDARD_VERSION: u16 = 2_100;
const TEXT_BYTES: usize = 32;

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
        const FUNCTION_HEADING: u64 = 140;
        const CLASS_NAVIGATION: u64 = 60;
        const MARINE: u64 = 4;
        const ANY_ADDRESS: u64 = 1;
        Name::from_number(
            u64::from(self.unique_number & 0x1f_ffff)
                | (u64::from(self.manufacturer & 0x7ff) << 21)
                | (FUNCTION_HEADING << 40)
                | (CLASS_NAVIGATION << 49)
                | (MARINE << 60)
                | (ANY_ADDRESS << 63),
        )
    }

    /// Returns the product information, to all.
    pub fn product_information(&self, source: Address) -> Message {
        let mut data = STANDARD_VERSION.to_le_bytes().to_vec();
        data.extend([0, 0]);
        for text in [&self.model, &self.software, "", &self.serial].map(|text| text as &str) {
            let bytes = text.bytes().filter(u8::is_ascii).take(TEXT_BYTES);
            let from = data.len();
            data.extend(bytes);
            data.resize(from + TEXT_BYTES, 0xff);
        }
        // Certification level unknown; the bus need not power it.
        data.extend([0, 0]);
        to_all(6, PRODUCT_INFORMATION, source.number(), data)
    }

    /// Returns the heartbeat, to all.
    pub fn heartbeat(source: Address, sequence: u8) -> Message {
        let [low, high] = HEARTBEAT_MS.to_le_bytes();
        let data = vec![low, high, sequence % 253, 0xff, 0xff, 0xff, 0xff, 0xff];
        to_all(7, HEARTBEAT, source.number(), data)
    }
}

/// State of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimState {
    /// It has not stood for long enough.
    Claiming,
    /// The address is the device's.
    Claimed(Address),
    /// Other devices have all addresses.
    Lost,
}

/// Claim of an address.
#[derive(Clone, Debug)]
pub struct AddressClaim {
    device: Device,
    address: u8,
    /// Addresses that other devices claimed.
    taken: [bool; ADDRESSES as usize],
    state: ClaimState,
}

impl AddressClaim {
    /// Begins with an address. Returns the claim to send as well.
    pub fn begin(device: Device, preferred: Address) -> (AddressClaim, Message) {
        let claim = AddressClaim {
            device,
            address: preferred.number(),
            taken: [false; ADDRESSES as usize],
            state: ClaimState::Claiming,
        };
        let message = claim.message();
        (claim, message)
    }

    /// The state.
    pub fn state(&self) -> ClaimState {
        self.state
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Records that the claim has stood for 250 ms.
    pub fn confirm(&mut self) {
        if self.state == ClaimState::Claiming
            && let Some(address) = Address::new(self.address)
        {
            self.state = ClaimState::Claimed(address);
        }
    }

    /// Applies a message of the bus. Returns the response to send, if any; a new claim must stand
    /// for 250 ms again.
    pub fn observe(&mut self, message: &Message) -> Option<Message> {
        let is_to_us = [ALL, self.address].contains(&message.header.destination);
        match Data::parse(message)? {
            Data::AddressClaim { name } => self.observe_claim(message.header.source, name),
            Data::Request { pgn: ADDRESS_CLAIM } if is_to_us => Some(self.message()),
            Data::Request {
                pgn: PRODUCT_INFORMATION,
            } if is_to_us => match self.state {
                ClaimState::Claimed(address) => Some(self.device.product_information(address)),
                ClaimState::Claiming | ClaimState::Lost => None,
            },
            _ => None,
        }
    }

    fn observe_claim(&mut self, source: u8, name: Name) -> Option<Message> {
        if name == self.device.name() {
            // Its own, or its echo.
            return None;
        }
        if let Some(taken) = self.taken.get_mut(usize::from(source)) {
            *taken = true;
        }
        if source != self.address || self.state == ClaimState::Lost {
            return None;
        }
        if self.device.name() < name {
            self.taken[usize::from(source)] = false;
            return Some(self.message());
        }
        let first = usize::from(self.address);
        let all = usize::from(ADDRESSES);
        let next = (0..all).map(|step| (first + step) % all);
        let free = next.into_iter().find(|address| !self.taken[*address]);
        self.address = free.map_or(NO_ADDRESS, |address| address as u8);
        self.state = match free {
            Some(_) => ClaimState::Claiming,
            None => ClaimState::Lost,
        };
        Some(self.message())
    }

    fn message(&self) -> Message {
        let name = self.device.name().number().to_le_bytes().to_vec();
        to_all(6, ADDRESS_CLAIM, self.address, name)
    }
}

/// Returns the request that all devices claim their addresses.
pub fn request_claims() -> Message {
    let [low, middle, high, _] = ADDRESS_CLAIM.to_le_bytes();
    to_all(6, REQUEST, NO_ADDRESS, vec![low, middle, high])
}

fn to_all(priority: u8, pgn: u32, source: u8, data: Vec<u8>) -> Message {
    Message {
        header: Header {
            priority,
            pgn,
            source,
            destination: ALL,
        },
        data,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device() -> Device {
        Device {
            unique_number: 42,
            manufacturer: 2046,
            model: "Binnacle".to_owned(),
            software: "0.1.0".to_owned(),
            serial: "42".to_owned(),
        }
    }

    fn claim_by(name: u64, address: u8) -> Message {
        to_all(6, ADDRESS_CLAIM, address, name.to_le_bytes().to_vec())
    }

    fn begun() -> AddressClaim {
        AddressClaim::begin(device(), Address::new(35).unwrap()).0
    }

    #[test]
    fn a_claim_that_nobody_contests_stands() {
        let (mut claim, message) = AddressClaim::begin(device(), Address::new(35).unwrap());
        assert_eq!(
            (message.header.pgn, message.header.source),
            (ADDRESS_CLAIM, 35)
        );
        assert_eq!(claim.observe(&claim_by(1, 4)), None);
        assert_eq!(claim.state(), ClaimState::Claiming);
        claim.confirm();
        assert_eq!(
            claim.state(),
            ClaimState::Claimed(Address::new(35).unwrap())
        );
    }

    #[test]
    fn the_lower_name_keeps_the_address() {
        let mut claim = begun();
        claim.confirm();
        let ours = claim.observe(&claim_by(u64::MAX, 35)).unwrap();
        assert_eq!(ours.header.source, 35);
        claim.observe(&claim_by(1, 36));
        let next = claim.observe(&claim_by(2, 35)).unwrap();
        assert_eq!(
            (next.header.source, claim.state()),
            (37, ClaimState::Claiming)
        );
        // Its own echo contests nothing.
        assert_eq!(claim.observe(&next), None);
    }

    #[test]
    fn a_full_bus_leaves_no_address() {
        let mut claim = begun();
        for address in (0..ADDRESSES).filter(|address| *address != 35) {
            claim.observe(&claim_by(u64::from(address), address));
        }
        let lost = claim.observe(&claim_by(0, 35)).unwrap();
        assert_eq!(
            (lost.header.source, claim.state()),
            (NO_ADDRESS, ClaimState::Lost)
        );
        claim.confirm();
        assert_eq!(claim.state(), ClaimState::Lost);
    }

    #[test]
    fn requests_are_met_as_far_as_the_claim_allows() {
        let mut claim = begun();
        let request = |pgn: u32, destination| {
            let [low, middle, high, _] = pgn.to_le_bytes();
            let mut message = to_all(6, REQUEST, 4, vec![low, middle, high]);
            message.header.destination = destination;
            message
        };
        assert!(claim.observe(&request(ADDRESS_CLAIM, ALL)).is_some());
        assert_eq!(claim.observe(&request(PRODUCT_INFORMATION, 35)), None);
        claim.confirm();
        let product = claim.observe(&request(PRODUCT_INFORMATION, 35)).unwrap();
        assert_eq!(product.data.len(), 134);
        assert_eq!(&product.data[4..12], b"Binnacle");
        assert_eq!(claim.observe(&request(PRODUCT_INFORMATION, 7)), None);
    }
}
