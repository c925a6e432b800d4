//! Identity of the agent on a bus, which outlives a restart: other devices know it by its NAME, and
//! it claims the address again that it had.

use binnacle_nmea::n2k::{Address, Device};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::{fs, io};
use uuid::Uuid;

/// Manufacturer's code that is assigned to nobody.
const NO_MANUFACTURER: u16 = 2046;
/// Address to claim first, in the range of navigation sensors on most ships.
const FIRST_ADDRESS: u8 = 35;
/// Bits of a unique number.
const UNIQUE_NUMBER_BITS: u32 = 0x1f_ffff;

/// Identity on one bus.
#[derive(Clone, Debug)]
pub(super) struct Identity {
    path: PathBuf,
    stored: Stored,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Stored {
    unique_number: u32,
    address: u8,
}

impl Identity {
    /// Reads the identity on an input's bus; another one where there is none that can be read.
    pub(super) fn load(data_dir: &Path, input: &str) -> Identity {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let name: String = input.chars().map(plain).collect();
        let path = data_dir.join(format!("n2k-{name}.json"));
        let text = fs::read_to_string(&path).ok();
        let stored = text.and_then(|text| serde_json::from_str(&text).ok());
        if let Some(stored) = stored {
            return Identity { path, stored };
        }
        let unique_number = Uuid::new_v4().as_u128() as u32 & UNIQUE_NUMBER_BITS;
        let stored = Stored {
            unique_number,
            address: FIRST_ADDRESS,
        };
        let identity = Identity { path, stored };
        identity.store();
        identity
    }

    /// Returns the device.
    pub(super) fn device(&self) -> Device {
        Device {
            unique_number: self.stored.unique_number,
            manufacturer: NO_MANUFACTURER,
            model: "Binnacle compass agent".to_owned(),
            software: env!("CARGO_PKG_VERSION").to_owned(),
            serial: self.stored.unique_number.to_string(),
        }
    }

    /// Returns the address to claim.
    pub(super) fn address(&self) -> Option<Address> {
        Address::new(self.stored.address).or(Address::new(FIRST_ADDRESS))
    }

    /// Keeps an address that was claimed.
    pub(super) fn keep(&mut self, address: Address) {
        if self.stored.address != address.number() {
            self.stored.address = address.number();
            self.store();
        }
    }

    fn store(&self) {
        let stored = || -> io::Result<()> {
            // A partial file never looks complete.
            let partial = self.path.with_extension("partial");
            fs::write(&partial, serde_json::to_vec(&self.stored)?)?;
            fs::rename(&partial, &self.path)
        };
        if let Err(error) = stored() {
            tracing::warn!(%error, path = %self.path.display(), "an address cannot be stored");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_keeps_its_name_and_its_address() {
        let folder = tempfile::tempdir().unwrap();
        let mut first = Identity::load(folder.path(), "bus 1");
        assert_eq!(first.address(), Address::new(FIRST_ADDRESS));
        first.keep(Address::new(77).unwrap());
        let again = Identity::load(folder.path(), "bus 1");
        assert_eq!(again.stored, first.stored);
        assert_eq!(again.address(), Address::new(77));
        fs::write(folder.path().join("n2k-bus_1.json"), "{").unwrap();
        assert!(Identity::load(folder.path(), "bus 1").address().is_some());
    }
}
