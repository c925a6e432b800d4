//! Source of an observation, as far as its path names it.
//!
//! A serial line names a talker, a Signal K server its `$source`, an IEC 61162-450 datagram a
//! system function and a sender, NMEA 2000 an address and a NAME. Two sources are the same device
//! when all of these agree.

use binnacle_nmea::n2k::{Address, Name};
use std::cmp::Ordering;
use std::fmt;
use std::net::IpAddr;
use std::sync::Arc;

/// Talker of a magnetic compass: its true heading is made of its magnetic one.
const MAGNETIC_COMPASS_TALKER: [u8; 2] = *b"HC";
/// Talkers of satellite receivers: each satellite system, and all together.
const SATELLITE_TALKERS: [[u8; 2]; 7] = [*b"GP", *b"GN", *b"GA", *b"GB", *b"BD", *b"GL", *b"GQ"];

/// Source of an observation.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Source {
    /// Configured name of the input.
    pub input: Arc<str>,
    /// Talker (`HC`, `HE`, `GP` …); `SK` for Signal K.
    pub talker: [u8; 2],
    /// Sentence (`HDG`, `THS` …), given to Signal K values by their meaning.
    pub sentence: [u8; 3],
    /// Signal K: `$source`.
    pub signalk: Option<Arc<str>>,
    /// TAG block: `s:`, in IEC 61162-450 the system function (`HE0001`).
    pub sfi: Option<Arc<str>>,
    /// Datagrams: address of the sender.
    pub sender: Option<IpAddr>,
    /// NMEA 2000: address on the bus.
    pub n2k_address: Option<Address>,
    /// NMEA 2000: NAME of the device, which keeps it when its address changes.
    pub n2k_name: Option<Name>,
}

impl Source {
    /// Creates the source of a sentence from a line that names nothing else.
    pub fn of_sentence(input: Arc<str>, talker: [u8; 2], sentence: [u8; 3]) -> Source {
        Source {
            input,
            talker,
            sentence,
            signalk: None,
            sfi: None,
            sender: None,
            n2k_address: None,
            n2k_name: None,
        }
    }

    /// Returns whether both are one device, whatever the sentences.
    pub fn is_same_device(&self, other: &Source) -> bool {
        let is_named = self.n2k_name.is_some() && other.n2k_name.is_some();
        (is_named || self.talker == other.talker) && self.has_same_path(other)
    }

    /// Returns whether both are one satellite receiver, whose talker names the systems that it uses
    /// at the moment.
    pub fn is_same_receiver(&self, other: &Source) -> bool {
        let both_of_satellites = self.is_of_satellites() && other.is_of_satellites();
        self.is_same_device(other) || (both_of_satellites && self.has_same_path(other))
    }

    /// Returns whether its talker is a satellite receiver's.
    pub fn is_of_satellites(&self) -> bool {
        SATELLITE_TALKERS.contains(&self.talker)
    }

    /// Returns whether both come the same way, as far as it is named without a talker.
    fn has_same_path(&self, other: &Source) -> bool {
        if self.input != other.input {
            return false;
        }
        if let (Some(one), Some(another)) = (self.n2k_name, other.n2k_name) {
            // A device may claim another address at any time.
            return one == another;
        }
        self.signalk == other.signalk
            && self.sfi == other.sfi
            && self.sender == other.sender
            && self.n2k_address == other.n2k_address
    }

    /// Returns the order of two devices, the same on every start: magnetic compasses first, for
    /// others repeat them.
    pub fn device_order(&self, other: &Source) -> Ordering {
        let key = |source: &Source| {
            (
                source.talker != MAGNETIC_COMPASS_TALKER,
                source.signalk.clone(),
                source.sfi.clone(),
                source.sender,
                (source.n2k_name, source.n2k_address),
                source.talker,
                Arc::clone(&source.input),
            )
        };
        key(self).cmp(&key(other))
    }

    /// Returns whether the path names one device. A talker alone does not, for multiplexers give
    /// one to all; that of a magnetic compass does.
    pub fn names_device(&self) -> bool {
        self.signalk.is_some()
            || self.sfi.is_some()
            || self.n2k_address.is_some()
            || self.n2k_name.is_some()
            || self.talker == MAGNETIC_COMPASS_TALKER
    }

    /// Returns the sentence as text.
    pub fn sentence_text(&self) -> String {
        String::from_utf8_lossy(&self.sentence).into_owned()
    }

    /// Returns the talker as text.
    pub fn talker_text(&self) -> String {
        String::from_utf8_lossy(&self.talker).into_owned()
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ", self.input)?;
        match &self.signalk {
            Some(signalk) => write!(f, "{signalk} ")?,
            None => f.write_str(&self.talker_text())?,
        }
        f.write_str(&self.sentence_text())?;
        if let Some(sfi) = &self.sfi {
            write!(f, " of {sfi}")?;
        }
        if let Some(sender) = self.sender {
            write!(f, " from {sender}")?;
        }
        match (self.n2k_address, self.n2k_name) {
            (Some(address), Some(name)) => write!(f, " ({address}, {name})"),
            (Some(address), None) => write!(f, " ({address})"),
            (None, Some(name)) => write!(f, " ({name})"),
            (None, None) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line() -> Source {
        Source::of_sentence("bridge".into(), *b"HC", *b"HDG")
    }

    #[test]
    fn a_device_is_the_same_in_all_its_sentences_and_at_any_address() {
        let hdt = Source {
            sentence: *b"HDT",
            ..line()
        };
        assert!(line().is_same_device(&hdt));
        let named = |address: u8, name: &str| Source {
            n2k_address: Address::new(address),
            n2k_name: Name::parse(name),
            ..line()
        };
        let one = named(4, "c0788c00e7e04312");
        assert!(one.is_same_device(&named(9, "c0788c00e7e04312")));
        assert!(!one.is_same_device(&named(4, "c0788c00e7e04313")));
        assert!(!line().is_same_device(&Source {
            signalk: Some("n2k.4".into()),
            ..line()
        }));
        assert!(!line().is_same_device(&Source {
            sender: Some("10.0.0.2".parse().unwrap()),
            ..line()
        }));
    }

    #[test]
    fn a_source_is_named_by_all_that_its_path_says() {
        assert_eq!(line().to_string(), "bridge HCHDG");
        let full = Source {
            signalk: Some("can0.4".into()),
            n2k_address: Address::new(4),
            ..line()
        };
        assert_eq!(full.to_string(), "bridge can0.4 HDG (4)");
        let datagram = Source {
            sfi: Some("HC0001".into()),
            sender: Some("10.0.0.2".parse().unwrap()),
            ..line()
        };
        assert_eq!(datagram.to_string(), "bridge HCHDG of HC0001 from 10.0.0.2");
    }
}
