//! Address claim of a device, and its responses to requests (ISO 11783-5, ISO 11783-3).
//!
//! Of two devices that claim an address, the one with the lower NAME keeps it; the other claims the
//! next free one, or says that it cannot claim one. A device sends nothing else before its claim
//! has stood for [`CLAIM_TIME`].

use super::data::Data;
use super::device::{
    ACKNOWLEDGEMENT, Device, GROUP_LIST, HEARTBEAT, PRODUCT_INFORMATION, group_bytes, group_lists,
    heartbeat, refusal, to,
};
use super::frame::{ADDRESS_CLAIM, ALL, Message, REQUEST};
use super::identity::{Address, Name};
use std::time::Duration;

/// Time for which a claim must stand (ISO 11783-5: 250 ms).
pub const CLAIM_TIME: Duration = Duration::from_millis(250);
/// Source of a device without an address.
const NO_ADDRESS: u8 = 254;
const ADDRESSES: u8 = 252;

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
    heartbeats: u8,
}

impl AddressClaim {
    /// Begins with an address. Returns the messages to send as well: the claim, and the request that
    /// all devices claim theirs.
    pub fn begin(device: Device, preferred: Address) -> (AddressClaim, [Message; 2]) {
        let claim = AddressClaim {
            device,
            address: preferred.number(),
            taken: [false; ADDRESSES as usize],
            state: ClaimState::Claiming,
            heartbeats: 0,
        };
        let others = group_bytes(ADDRESS_CLAIM).to_vec();
        let others = to(ALL, 6, REQUEST, NO_ADDRESS, others);
        let own = claim.claim_message();
        (claim, [own, others])
    }

    /// Returns the state.
    pub fn state(&self) -> ClaimState {
        self.state
    }

    /// Returns the address while it is the device's.
    pub fn address(&self) -> Option<Address> {
        match self.state {
            ClaimState::Claimed(address) => Some(address),
            ClaimState::Claiming | ClaimState::Lost => None,
        }
    }

    /// Records that the claim has stood for [`CLAIM_TIME`].
    pub fn confirm(&mut self) {
        if self.state == ClaimState::Claiming
            && let Some(address) = Address::new(self.address)
        {
            self.state = ClaimState::Claimed(address);
        }
    }

    /// Returns the next heartbeat; none without an address.
    pub fn next_heartbeat(&mut self) -> Option<Message> {
        let message = heartbeat(self.address()?, self.heartbeats);
        self.heartbeats = self.heartbeats.wrapping_add(1) % 253;
        Some(message)
    }

    /// Applies a message of the bus. Returns the responses to send. A claim of another address is
    /// one of them, and must stand for [`CLAIM_TIME`] again.
    pub fn observe(&mut self, message: &Message) -> Vec<Message> {
        let header = message.header;
        match Data::parse(message) {
            Some(Data::AddressClaim { name }) => self
                .observe_claim(header.source, name)
                .into_iter()
                .collect(),
            Some(Data::Request { pgn }) if [ALL, self.address].contains(&header.destination) => {
                self.respond(pgn, header.source, header.destination != ALL)
            }
            _ => Vec::new(),
        }
    }

    /// Returns the responses to a request. Only one that was sent to the device alone is refused.
    fn respond(&mut self, pgn: u32, requester: u8, is_alone: bool) -> Vec<Message> {
        if pgn == ADDRESS_CLAIM {
            return vec![self.claim_message()];
        }
        let Some(address) = self.address() else {
            return Vec::new();
        };
        let source = address.number();
        match pgn {
            PRODUCT_INFORMATION => {
                vec![to(ALL, 6, pgn, source, self.device.product_information())]
            }
            GROUP_LIST => group_lists()
                .map(|list| to(requester, 6, pgn, source, list))
                .into(),
            HEARTBEAT => self.next_heartbeat().into_iter().collect(),
            _ if is_alone => vec![to(requester, 6, ACKNOWLEDGEMENT, source, refusal(pgn))],
            _ => Vec::new(),
        }
    }

    fn observe_claim(&mut self, source: u8, name: Name) -> Option<Message> {
        if name == self.device.name() {
            // Its own, or its echo.
            return None;
        }
        *self.taken.get_mut(usize::from(source))? = true;
        if source != self.address {
            return None;
        }
        if self.device.name() < name {
            self.taken[usize::from(source)] = false;
            return Some(self.claim_message());
        }
        let first = usize::from(self.address);
        let all = usize::from(ADDRESSES);
        let mut next = (0..all).map(|step| (first + step) % all);
        let free = next.find(|address| !self.taken[*address]);
        self.address = free.map_or(NO_ADDRESS, |address| address as u8);
        self.state = match free {
            Some(_) => ClaimState::Claiming,
            None => ClaimState::Lost,
        };
        Some(self.claim_message())
    }

    /// Returns the claim; without an address, the message that it cannot claim one.
    fn claim_message(&self) -> Message {
        let name = self.device.name().number().to_le_bytes().to_vec();
        to(ALL, 6, ADDRESS_CLAIM, self.address, name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
        to(ALL, 6, ADDRESS_CLAIM, address, name.to_le_bytes().to_vec())
    }

    fn request(pgn: u32, destination: u8) -> Message {
        to(destination, 6, REQUEST, 4, group_bytes(pgn).to_vec())
    }

    fn begun() -> AddressClaim {
        AddressClaim::begin(device(), Address::new(35).unwrap()).0
    }

    #[test]
    fn a_claim_that_nobody_contests_stands() {
        let preferred = Address::new(35).unwrap();
        let (mut claim, [own, others]) = AddressClaim::begin(device(), preferred);
        assert_eq!((own.header.pgn, own.header.source), (ADDRESS_CLAIM, 35));
        assert_eq!(
            (others.header.pgn, others.header.source),
            (REQUEST, NO_ADDRESS)
        );
        assert_eq!(claim.observe(&claim_by(1, 4)), []);
        assert_eq!(
            (claim.state(), claim.address()),
            (ClaimState::Claiming, None)
        );
        claim.confirm();
        assert_eq!(claim.address(), Some(preferred));
    }

    #[test]
    fn the_lower_name_keeps_the_address() {
        let mut claim = begun();
        claim.confirm();
        let ours = claim.observe(&claim_by(u64::MAX, 35));
        assert_eq!(ours[0].header.source, 35);
        assert_eq!(claim.address().map(Address::number), Some(35));
        claim.observe(&claim_by(1, 36));
        let next = claim.observe(&claim_by(2, 35));
        assert_eq!(
            (next[0].header.source, claim.state()),
            (37, ClaimState::Claiming)
        );
        // Its own echo contests nothing.
        assert_eq!(claim.observe(&next[0]), []);
    }

    #[test]
    fn a_full_bus_leaves_no_address() {
        let mut claim = begun();
        for address in (0..ADDRESSES).filter(|address| *address != 35) {
            claim.observe(&claim_by(u64::from(address), address));
        }
        let lost = claim.observe(&claim_by(0, 35));
        assert_eq!(
            (lost[0].header.source, claim.state()),
            (NO_ADDRESS, ClaimState::Lost)
        );
        claim.confirm();
        assert_eq!(claim.state(), ClaimState::Lost);
        assert_eq!(claim.observe(&request(ADDRESS_CLAIM, ALL)), lost);
        assert_eq!(claim.observe(&request(PRODUCT_INFORMATION, ALL)), []);
        assert_eq!(claim.next_heartbeat(), None);
    }

    #[test]
    fn requests_are_met_as_far_as_the_claim_allows() {
        let mut claim = begun();
        assert_eq!(claim.observe(&request(ADDRESS_CLAIM, ALL)).len(), 1);
        assert_eq!(claim.observe(&request(PRODUCT_INFORMATION, 35)), []);
        claim.confirm();
        let product = claim.observe(&request(PRODUCT_INFORMATION, 35));
        assert_eq!(product[0].data.len(), 134);
        assert_eq!(&product[0].data[4..12], b"Binnacle");
        assert_eq!(claim.observe(&request(PRODUCT_INFORMATION, 7)), []);
        let lists = claim.observe(&request(GROUP_LIST, 35));
        let [sent, acted_on] = &lists[..] else {
            panic!("{lists:?}");
        };
        assert_eq!((sent.header.destination, sent.data[0]), (4, 0));
        assert_eq!(acted_on.data, [1, 0x00, 0xea, 0x00, 0x00, 0xee, 0x00]);
        let beat = claim.observe(&request(HEARTBEAT, ALL));
        assert_eq!((beat[0].header.pgn, beat[0].data[2]), (HEARTBEAT, 0));
        assert_eq!(claim.next_heartbeat().unwrap().data[2], 1);
    }

    #[test]
    fn only_a_request_to_the_device_alone_is_refused() {
        let mut claim = begun();
        claim.confirm();
        let refused = claim.observe(&request(126_998, 35));
        assert_eq!(
            (refused[0].header.pgn, refused[0].header.destination),
            (59_392, 4)
        );
        assert_eq!(claim.observe(&request(126_998, ALL)), []);
    }

    proptest! {
        /// Whatever the bus sends, an address that is used is one whose last claim was its own, or
        /// was by a greater NAME.
        #[test]
        fn no_address_is_used_that_a_lower_name_has(
            seen in prop::collection::vec((any::<u8>(), 0..5_u64, any::<bool>()), 0..400),
        ) {
            let mut claim = begun();
            let ours = device().name().number();
            let mut lower = [false; 256];
            for (address, name, waits) in seen {
                let name = if name == 4 { u64::MAX } else { ours - 1 - name };
                let address = if waits { claim.address } else { address };
                lower[usize::from(address)] = name < ours;
                claim.observe(&claim_by(name, address));
                claim.confirm();
                if let Some(address) = claim.address() {
                    prop_assert!(!lower[usize::from(address.number())]);
                }
            }
        }

        #[test]
        fn no_message_is_answered_with_more_than_two(
            pgn in prop::sample::select(vec![ADDRESS_CLAIM, REQUEST, HEARTBEAT]),
            (source, destination) in any::<(u8, u8)>(),
            data in prop::collection::vec(any::<u8>(), 0..12),
        ) {
            let mut claim = begun();
            claim.confirm();
            let message = to(destination, 6, pgn, source, data);
            let responses = claim.observe(&message);
            prop_assert!(responses.len() <= 2);
            for response in responses {
                prop_assert!(response.data.len() <= 223);
            }
        }
    }
}
