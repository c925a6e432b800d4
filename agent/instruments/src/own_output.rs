//! The agent's own headings, heard again: over a shared line, or from a server that they were sent
//! to.
//!
//! On an NMEA 2000 bus it is known by its NAME and its address, at a Signal K server by its `$source`.
//!
//! Its own HDG is known by its content: the raw reading together with the deviation of the model
//! and the variation of the field. A compass comes before what the agent makes of it. A source
//! whose changes have all been sent shortly before is therefore the agent's own.

use binnacle_compass::angle::{CompassHeading, Deviation, Variation, wrap_180};
use binnacle_observation::{Observation, Reading, Source};
use binnacle_output::OwnDevice;
use std::collections::{HashMap, VecDeque};
use std::time::Duration;
use tokio::time::Instant;

/// Talker of the agent's own sentences by default. Sources without a configured talker never match
/// its headings.
pub const AGENT_TALKER: [u8; 2] = *b"II";

/// Time after which a heading comes back no more: the compass has fallen silent by then.
const ECHO_TIME: Duration = Duration::from_secs(2);
/// Headings that are remembered; they are sent up to a hundred times a second.
const MAX_SENT: usize = 256;
/// Half a digit of what is sent, and the rounding of radians.
const SAME_DEG: f64 = 0.051;
/// Changes that must all have been sent before. An independent compass shows one of the few
/// readings of the last two seconds, with the model's deviation, by chance in one of two changes
/// at most, and ten times in a row in one of a thousand runs of ten. It has seldom any deviation.
const CHANGES: u32 = 10;
/// Limit on sources that are watched.
const MAX_SOURCES: usize = 1_000;

/// Raw heading with deviation and variation, as HDG has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SentHeading {
    /// Compass heading.
    pub raw: CompassHeading,
    /// Its deviation.
    pub deviation: Deviation,
    /// Variation there.
    pub variation: Variation,
}

impl SentHeading {
    fn is_same(&self, other: &SentHeading) -> bool {
        let is_near = |degrees: f64| degrees.abs() <= SAME_DEG;
        is_near(wrap_180(self.raw.degrees() - other.raw.degrees()))
            && is_near(self.deviation.degrees_east() - other.deviation.degrees_east())
            && is_near(self.variation.degrees_east() - other.variation.degrees_east())
    }
}

/// Headings that the agent sends, by what their receivers know them by.
#[derive(Debug)]
pub struct OwnHeadings {
    /// Talker and sentence.
    pub sentences: Vec<([u8; 2], [u8; 3])>,
    /// Devices on NMEA 2000 that the agent itself is.
    pub devices: Vec<OwnDevice>,
    /// Signal K: `$source`.
    pub labels: Vec<String>,
}

impl Default for OwnHeadings {
    fn default() -> OwnHeadings {
        OwnHeadings {
            sentences: vec![(AGENT_TALKER, *b"HDG")],
            devices: Vec::new(),
            labels: Vec::new(),
        }
    }
}

impl OwnHeadings {
    /// Returns whether a source is one under which the agent itself sends.
    fn names(&self, source: &Source) -> bool {
        let signalk = source.signalk.as_deref();
        let is_label = signalk.is_some_and(|own| self.labels.iter().any(|label| label == own));
        is_label || self.devices.iter().any(|device| is_own(device, source))
    }

    fn has_talker(&self, talker: [u8; 2]) -> bool {
        self.sentences.iter().any(|(own, _)| *own == talker)
    }
}

/// Returns whether a source is a device that the agent itself is. An address says so on the device's
/// own bus alone; a server that reads buses is taken to read that one.
fn is_own(device: &OwnDevice, source: &Source) -> bool {
    if let Some(name) = source.n2k_name {
        return name == device.name;
    }
    let is_same_bus = *source.input == *device.input || source.signalk.is_some();
    is_same_bus && source.n2k_address.is_some() && source.n2k_address == *device.address.borrow()
}

/// Headings that the agent has sent, and the sources that repeat them.
#[derive(Debug)]
pub struct OwnOutput {
    own: OwnHeadings,
    sent: VecDeque<(Instant, SentHeading)>,
    repeats: HashMap<Source, Repeats>,
}

/// Changes of a source in a row that had all been sent before.
#[derive(Clone, Copy, Debug)]
struct Repeats {
    last: SentHeading,
    changes: u32,
}

impl OwnOutput {
    /// Creates the memory of an output.
    pub fn new(own: OwnHeadings) -> OwnOutput {
        OwnOutput {
            own,
            sent: VecDeque::new(),
            repeats: HashMap::new(),
        }
    }

    /// Records a heading as it is sent.
    pub fn note_sent(&mut self, heading: SentHeading, now: Instant) {
        if self.sent.len() >= MAX_SENT {
            self.sent.pop_front();
        }
        self.sent.push_back((now, heading));
    }

    /// Returns whether an observation is the agent's own output.
    pub fn is_echo(&mut self, seen: &Observation, now: Instant) -> bool {
        if self.own.names(&seen.source) {
            return true;
        }
        let Some(heading) = whole_heading(&seen.reading) else {
            return self.is_repeater(&seen.source);
        };
        while self
            .sent
            .front()
            .is_some_and(|(at, _)| now.saturating_duration_since(*at) > ECHO_TIME)
        {
            self.sent.pop_front();
        }
        let was_sent = self.sent.iter().any(|(_, sent)| sent.is_same(&heading));
        self.note_repeat(&seen.source, heading, was_sent);
        (was_sent && self.own.has_talker(seen.source.talker)) || self.is_repeater(&seen.source)
    }

    /// Returns the sources that repeat the output.
    pub fn repeaters(&self) -> impl Iterator<Item = &Source> {
        self.repeats
            .iter()
            .filter(|(_, repeats)| repeats.changes >= CHANGES)
            .map(|(source, _)| source)
    }

    fn is_repeater(&self, source: &Source) -> bool {
        source.names_device() && self.repeaters().any(|known| known.is_same_device(source))
    }

    fn note_repeat(&mut self, source: &Source, heading: SentHeading, was_sent: bool) {
        if !was_sent {
            self.repeats.remove(source);
            return;
        }
        if let Some(repeats) = self.repeats.get_mut(source) {
            if !repeats.last.is_same(&heading) {
                repeats.changes = repeats.changes.saturating_add(1);
            }
            repeats.last = heading;
        } else if self.repeats.len() < MAX_SOURCES {
            let repeats = Repeats {
                last: heading,
                changes: 0,
            };
            self.repeats.insert(source.clone(), repeats);
        }
    }
}

fn whole_heading(reading: &Reading) -> Option<SentHeading> {
    match *reading {
        Reading::Compass {
            raw,
            deviation: Some(deviation),
            variation: Some(variation),
        } => Some(SentHeading {
            raw,
            deviation,
            variation,
        }),
        Reading::Magnetic {
            heading,
            deviation: Some(deviation),
            variation: Some(variation),
        } => Some(SentHeading {
            raw: CompassHeading::new(heading.degrees())?,
            deviation,
            variation,
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_nmea::n2k::{Address, Name};

    fn heading(raw: f64) -> SentHeading {
        SentHeading {
            raw: CompassHeading::new(raw).unwrap(),
            deviation: Deviation::new(1.4).unwrap(),
            variation: Variation::new(-3.2).unwrap(),
        }
    }

    fn seen(talker: [u8; 2], signalk: Option<&str>, heading: SentHeading) -> Observation {
        let mut source = Source::of_sentence("a".into(), talker, *b"HDG");
        source.signalk = signalk.map(Into::into);
        Observation::now(
            source,
            Reading::Compass {
                raw: heading.raw,
                deviation: Some(heading.deviation),
                variation: Some(heading.variation),
            },
        )
    }

    #[test]
    fn the_agents_own_sentence_is_known_at_once_and_for_two_seconds() {
        let start = Instant::now();
        let mut own = OwnOutput::new(OwnHeadings::default());
        own.note_sent(heading(100.0), start);
        let soon = start + Duration::from_millis(1_900);
        assert!(own.is_echo(&seen(*b"II", None, heading(100.04)), soon));
        assert!(!own.is_echo(&seen(*b"II", None, heading(100.2)), soon));
        assert!(!own.is_echo(&seen(*b"HC", None, heading(100.0)), soon));
        let later = start + Duration::from_millis(2_100);
        assert!(!own.is_echo(&seen(*b"II", None, heading(100.0)), later));
    }

    #[test]
    fn the_agents_own_device_and_label_are_known_in_all_that_they_send() {
        let (address, own_address) = tokio::sync::watch::channel(Address::new(35));
        let name = Name::parse("c0788c00ffc0002a").unwrap();
        let mut own = OwnOutput::new(OwnHeadings {
            devices: vec![OwnDevice {
                input: "bus".to_owned(),
                name,
                address: own_address,
            }],
            labels: vec!["binnacle".to_owned()],
            ..OwnHeadings::default()
        });
        let mut is_echo = |input: &str, signalk: Option<&str>, n2k: (Option<u8>, Option<Name>)| {
            let source = Source {
                signalk: signalk.map(Into::into),
                n2k_address: n2k.0.and_then(Address::new),
                n2k_name: n2k.1,
                ..Source::of_sentence(input.into(), *b"N2", *b"HDT")
            };
            own.is_echo(
                &Observation::now(source, Reading::TrueNotValid),
                Instant::now(),
            )
        };
        let other = Name::parse("c0788c00e7e04312");
        assert!(is_echo("bus", None, (Some(35), None)));
        assert!(is_echo("gateway", None, (Some(77), Some(name))));
        assert!(is_echo("server", Some("can0.35"), (Some(35), None)));
        assert!(is_echo("server", Some("binnacle"), (None, None)));
        assert!(!is_echo("bus", None, (Some(36), None)));
        assert!(!is_echo("bus", None, (Some(35), other)));
        assert!(!is_echo("second bus", None, (Some(35), None)));
        assert!(!is_echo("server", Some("binnacle.HC"), (None, None)));
        address.send_replace(None);
        assert!(!is_echo("bus", None, (Some(35), None)));
        assert!(!is_echo("bus", None, (None, None)));
    }

    #[test]
    fn a_source_that_follows_each_change_is_an_echo_in_all_its_sentences() {
        let start = Instant::now();
        let mut own = OwnOutput::new(OwnHeadings::default());
        let mut echoes = Vec::new();
        for second in 0..20_u8 {
            let now = start + Duration::from_secs(second.into());
            let compass = heading(90.0 + f64::from(second));
            // The compass itself has the same deviation and variation, but comes first.
            assert!(!own.is_echo(&seen(*b"SK", Some("n2k.4"), compass), now));
            own.note_sent(compass, now);
            echoes.push(own.is_echo(&seen(*b"SK", Some("tcp.II"), compass), now));
        }
        assert_eq!(echoes.iter().position(|echo| *echo), Some(10));
        let mut source = seen(*b"SK", Some("tcp.II"), heading(0.0)).source;
        source.sentence = *b"HDT";
        let reading = Reading::TrueNotValid;
        assert!(own.is_echo(&Observation::now(source, reading), start));
        assert_eq!(own.repeaters().count(), 1);
    }
}
