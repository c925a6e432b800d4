//! Identity of devices on a bus.

use std::fmt;

/// The last address that a device can claim (ISO 11783-5): 252 and 253 are
/// reserved, 254 is none, 255 all.
const LAST_ADDRESS: u8 = 251;
/// Hexadecimal digits of a NAME.
const NAME_DIGITS: usize = 16;

/// Address of a device, which may change at any time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Address(u8);

impl Address {
    /// Takes an address from 0 to 251; `None` for any other.
    pub fn new(address: u8) -> Option<Address> {
        (address <= LAST_ADDRESS).then_some(Address(address))
    }

    /// Reads a decimal address.
    pub fn parse(text: &str) -> Option<Address> {
        let is_plain = text.bytes().all(|byte| byte.is_ascii_digit());
        text.parse()
            .ok()
            .filter(|_| is_plain)
            .and_then(Address::new)
    }

    /// The address as a number.
    pub fn number(self) -> u8 {
        self.0
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// NAME of a device: 64 bits that no other device has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Name(u64);

impl Name {
    /// Takes the 64 bits of an address claim.
    pub fn from_number(number: u64) -> Name {
        Name(number)
    }

    /// The 64 bits.
    pub fn number(self) -> u64 {
        self.0
    }

    /// Reads 16 hexadecimal digits.
    pub fn parse(text: &str) -> Option<Name> {
        let is_hex = text.len() == NAME_DIGITS && text.bytes().all(|b| b.is_ascii_hexdigit());
        u64::from_str_radix(text, 16)
            .ok()
            .filter(|_| is_hex)
            .map(Name)
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_one_that_can_be_claimed() {
        assert_eq!(Address::new(251).map(Address::number), Some(251));
        assert_eq!(Address::new(252), None);
        assert_eq!(Address::parse("204"), Address::new(204));
        for wrong in ["", "-1", "+4", "252", "256", "x"] {
            assert_eq!(Address::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_name_reads_back() {
        let name = Name::parse("c0788C00e7e04312").unwrap();
        assert_eq!(name.to_string(), "c0788c00e7e04312");
        for wrong in [
            "",
            "c0788c00e7e0431",
            "+0788c00e7e04312",
            "c0788c00e7e0431g",
        ] {
            assert_eq!(Name::parse(wrong), None, "{wrong}");
        }
    }
}
