//! Observations of NMEA 2000 messages.
//!
//! A message says who sent it by its address, and its sender's NAME is known once it has claimed
//! the address. The roles know parameter groups by the sentence of the same meaning: 127250 is
//! `HDG` or, from true north, `HDT`, 127251 `ROT`, 127257 `XDR`, 128259 `VHW`, 129025 `GLL`,
//! 129026 `VTG`, 129029 `RMC`, 126992 `ZDA`; the talker is `N2`.

use crate::signalk::DeltaCounts;
use crate::{Observation, Reading, Source, timestamp};
use binnacle_compass::angle::{
    CompassHeading, CourseOverGround, Deviation, TrueHeading, Variation,
};
use binnacle_compass::position::Position;
use binnacle_nmea::n2k::{Address, Assembler, Data, FixMethod, Frame, Message, Name, Reference};
use std::net::IpAddr;
use std::sync::Arc;

const TALKER: [u8; 2] = *b"N2";
/// Number of addresses that a device can claim.
const ADDRESSES: usize = 252;

/// Reader of the messages of one bus.
#[derive(Debug)]
pub struct N2kReader {
    input: Arc<str>,
    sender: Option<IpAddr>,
    assembler: Assembler,
    names: Vec<Option<Name>>,
}

impl N2kReader {
    /// Creates the reader of an input.
    pub fn new(input: Arc<str>) -> N2kReader {
        N2kReader {
            input,
            sender: None,
            assembler: Assembler::default(),
            names: vec![None; ADDRESSES],
        }
    }

    /// Sets the sender of the datagrams that follow.
    pub fn set_sender(&mut self, sender: IpAddr) {
        self.sender = Some(sender);
    }

    /// Passes the observations of the message that a frame completes to `each`.
    pub fn frame(
        &mut self,
        frame: &Frame,
        counts: &mut DeltaCounts,
        each: impl FnMut(Observation),
    ) {
        if let Some(message) = self.assembler.add(frame) {
            self.message(&message, counts, each);
        }
    }

    /// Passes the observations of a message to `each`: up to two.
    pub fn message(
        &mut self,
        message: &Message,
        counts: &mut DeltaCounts,
        mut each: impl FnMut(Observation),
    ) {
        let Some(data) = Data::parse(message) else {
            counts.count_value(group_name(message.header.pgn));
            return;
        };
        let address = Address::new(message.header.source);
        if let Data::AddressClaim { name } = data {
            if let Some(known) = self.names.get_mut(usize::from(message.header.source)) {
                *known = Some(name);
            }
            counts.count_value("PGN 60928");
            return;
        }
        let name = self.names.get(usize::from(message.header.source));
        let source = |sentence| Source {
            sender: self.sender,
            n2k_address: address,
            n2k_name: name.copied().flatten(),
            ..Source::of_sentence(Arc::clone(&self.input), TALKER, sentence)
        };
        readings(&data, |sentence, reading| {
            each(Observation::now(source(*sentence), reading));
        });
        counts.count_value(group_name(message.header.pgn));
    }
}

/// Returns the name under which a group's messages are counted.
fn group_name(pgn: u32) -> &'static str {
    match pgn {
        127_250 => "PGN 127250",
        127_251 => "PGN 127251",
        127_257 => "PGN 127257",
        127_258 => "PGN 127258",
        128_259 => "PGN 128259",
        129_025 => "PGN 129025",
        129_026 => "PGN 129026",
        129_029 => "PGN 129029",
        126_992 => "PGN 126992",
        _ => "other PGN",
    }
}

fn readings(data: &Data, mut each: impl FnMut(&[u8; 3], Reading)) {
    match *data {
        Data::Heading {
            deg,
            reference: Reference::Magnetic,
            deviation_deg_east,
            variation_deg_east,
        } => {
            if let Some(raw) = CompassHeading::new(deg) {
                let reading = Reading::Compass {
                    raw,
                    deviation: deviation_deg_east.and_then(Deviation::new),
                    variation: variation_deg_east.and_then(Variation::new),
                };
                each(b"HDG", reading);
            }
        }
        Data::Heading {
            deg,
            reference: Reference::True,
            ..
        } => {
            if let Some(heading) = TrueHeading::new(deg) {
                each(b"HDT", Reading::True(heading));
            }
        }
        Data::RateOfTurn { deg_min_starboard } => {
            let deg_min = deg_min_starboard;
            each(b"ROT", Reading::RateOfTurn { deg_min });
        }
        Data::Attitude {
            pitch_deg_bow_up,
            roll_deg_starboard_down,
        } => {
            if let Some(deg) = pitch_deg_bow_up {
                each(b"XDR", Reading::Pitch { deg });
            }
            if let Some(deg) = roll_deg_starboard_down {
                each(b"XDR", Reading::Roll { deg });
            }
        }
        Data::WaterSpeed { kn } => each(b"VHW", Reading::WaterSpeed { kn }),
        Data::Position {
            lat_deg_north,
            lon_deg_east,
        } => {
            if let Ok(position) = Position::new(lat_deg_north, lon_deg_east) {
                each(b"GLL", fix(position, None));
            }
        }
        Data::CourseSpeed {
            cog_deg_true,
            sog_kn,
        } => {
            if let Some(sog_kn) = sog_kn {
                each(b"VTG", Reading::Speed { sog_kn });
            }
            if let Some(course) = cog_deg_true.and_then(CourseOverGround::new) {
                each(b"VTG", Reading::Course(course));
            }
        }
        Data::Fix {
            method,
            lat_deg_north,
            lon_deg_east,
            unix_micros,
        } => {
            let time = unix_micros.and_then(timestamp);
            let place = lat_deg_north.zip(lon_deg_east);
            let place = place.filter(|_| method == FixMethod::Satellites);
            match place.and_then(|(lat, lon)| Position::new(lat, lon).ok()) {
                Some(position) => each(b"RMC", fix(position, time)),
                None => {
                    if let Some(time) = time.filter(|_| method == FixMethod::Satellites) {
                        each(b"ZDA", Reading::Time(time));
                    }
                }
            }
        }
        Data::Time { unix_micros } => {
            if let Some(time) = timestamp(unix_micros) {
                each(b"ZDA", Reading::Time(time));
            }
        }
        Data::Variation { .. } | Data::AddressClaim { .. } | Data::Request { .. } => {}
    }
}

fn fix(position: Position, time: Option<binnacle_compass::time::Timestamp>) -> Reading {
    Reading::Fix {
        position,
        time,
        sog_kn: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_nmea::n2k::Header;

    fn message(pgn: u32, data: &[u8]) -> Message {
        Message {
            header: Header {
                priority: 2,
                pgn,
                source: 204,
                destination: 255,
            },
            data: data.to_vec(),
        }
    }

    fn read(messages: &[Message]) -> (Vec<Observation>, DeltaCounts) {
        let mut reader = N2kReader::new("bus".into());
        let (mut seen, mut counts) = (Vec::new(), DeltaCounts::default());
        for message in messages {
            reader.message(message, &mut counts, |observation| seen.push(observation));
        }
        (seen, counts)
    }

    #[test]
    fn a_magnetic_heading_is_the_raw_compass_and_a_true_one_is_not() {
        let magnetic = message(127_250, &[0, 0x10, 0x27, 0xff, 0x7f, 0xff, 0x7f, 0xfd]);
        let of_true = message(127_250, &[0, 0x10, 0x27, 0xff, 0x7f, 0xff, 0x7f, 0xfc]);
        let (seen, counts) = read(&[magnetic, of_true]);
        let [compass, reference] = &seen[..] else {
            panic!("{seen:?}");
        };
        assert_eq!(&compass.source.sentence, b"HDG");
        assert!(matches!(compass.reading, Reading::Compass { .. }));
        assert_eq!(&reference.source.sentence, b"HDT");
        assert!(matches!(reference.reading, Reading::True(_)));
        assert_eq!(counts.values["PGN 127250"], 2);
    }

    #[test]
    fn the_source_has_address_and_once_claimed_its_name() {
        let heading = message(127_250, &[0, 0x10, 0x27, 0xff, 0x7f, 0xff, 0x7f, 0xfd]);
        let claim = message(60_928, &0xc078_8c00_e7e0_4312_u64.to_le_bytes());
        let (seen, _) = read(&[heading.clone(), claim, heading]);
        assert_eq!(seen[0].source.n2k_address, Address::new(204));
        assert_eq!(seen[0].source.n2k_name, None);
        assert_eq!(seen[1].source.n2k_name, Name::parse("c0788c00e7e04312"));
        assert!(seen[0].source.names_device());
    }

    #[test]
    fn a_reckoned_position_is_no_fix() {
        let mut data = vec![0; 31];
        data.extend([0x60, 0xff]);
        let (seen, _) = read(&[message(129_029, &data)]);
        assert_eq!(seen, []);
        data[31] = 0x10;
        let (seen, _) = read(&[message(129_029, &data)]);
        assert!(matches!(seen[0].reading, Reading::Fix { .. }));
    }
}
