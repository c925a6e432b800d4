//! The contents of a sentence, with units and signs settled.
//!
//! Directions are degrees in [0, 360); differences are positive to the east.

use crate::time::{Date, TimeOfDay, unix_micros};

/// A sentence that was read, or is to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sentence {
    /// The talker: `HC` a magnetic compass, `HE` a gyro, `GP` a receiver … Two
    /// capital letters or digits.
    pub talker: [u8; 2],
    /// The sentence's data.
    pub data: Data,
}

/// The data of the sentences that this crate knows.
///
/// `None` in a variant with an `Option` means that the sentence declares its
/// own values not valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Data {
    /// Heading sensor reading, deviation, variation.
    Hdg(Hdg),
    /// Magnetic heading.
    Hdm(Hdm),
    /// True heading, without a status.
    Hdt(Hdt),
    /// True heading and its mode.
    Ths(Ths),
    /// Water speed and heading.
    Vhw(Vhw),
    /// Rate of turn.
    Rot(Rot),
    /// Position, course, speed, date and time.
    Rmc(Option<Rmc>),
    /// Position and quality of the fix.
    Gga(Option<Gga>),
    /// Position.
    Gll(Option<Gll>),
    /// Date and time.
    Zda(Zda),
    /// Course and speed over the ground.
    Vtg(Option<Vtg>),
    /// Transducers: roll, pitch and temperature of the air.
    Xdr(Xdr),
    /// Temperature of the air.
    Mta(Mta),
    /// Heartbeat.
    Hbt(Hbt),
    /// Command to an alert.
    Acn(Acn),
}

/// HDG: the sensor's reading before deviation, and its own deviation and
/// variation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hdg {
    /// The raw reading: no deviation applied.
    pub reading_deg: Option<f64>,
    /// Magnetic heading less reading; in [−180, 180].
    pub deviation_deg_east: Option<f64>,
    /// True heading less magnetic heading; in [−180, 180].
    pub variation_deg_east: Option<f64>,
}

/// HDM. Only the installation knows if deviation was applied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hdm {
    /// Heading from magnetic north.
    pub heading_deg_magnetic: Option<f64>,
}

/// HDT.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hdt {
    /// Heading from true north.
    pub heading_deg_true: Option<f64>,
}

/// THS. Use [`Ths::valid_heading_deg_true`] unless the mode is checked too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ths {
    /// Heading from true north, valid or not.
    pub heading_deg_true: Option<f64>,
    /// The instrument's own statement of validity.
    pub mode: ThsMode,
}

impl Ths {
    /// The heading in mode A, the only valid one.
    pub fn valid_heading_deg_true(&self) -> Option<f64> {
        self.heading_deg_true
            .filter(|_| self.mode == ThsMode::Autonomous)
    }
}

/// The mode of a THS sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThsMode {
    /// A: the only valid one.
    Autonomous,
    /// E: dead reckoning.
    Estimated,
    /// M: entered by hand.
    Manual,
    /// S: a simulator's.
    Simulator,
    /// V: not valid, or standing by.
    NotValid,
}

impl ThsMode {
    /// The mode a letter stands for.
    pub fn from_letter(letter: u8) -> Option<ThsMode> {
        Some(match letter {
            b'A' => ThsMode::Autonomous,
            b'E' => ThsMode::Estimated,
            b'M' => ThsMode::Manual,
            b'S' => ThsMode::Simulator,
            b'V' => ThsMode::NotValid,
            _ => return None,
        })
    }

    /// The letter in the sentence.
    pub fn letter(self) -> u8 {
        match self {
            ThsMode::Autonomous => b'A',
            ThsMode::Estimated => b'E',
            ThsMode::Manual => b'M',
            ThsMode::Simulator => b'S',
            ThsMode::NotValid => b'V',
        }
    }
}

/// VHW.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vhw {
    /// Heading from true north.
    pub heading_deg_true: Option<f64>,
    /// Heading from magnetic north.
    pub heading_deg_magnetic: Option<f64>,
    /// Speed through the water.
    pub water_speed_kn: Option<f64>,
}

/// ROT.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rot {
    /// Degrees a minute, bow to starboard positive; `None` with status V.
    pub rate_deg_min_starboard: Option<f64>,
}

/// A place: degrees north in [−90, 90], degrees east in [−180, 180).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Degrees north of the equator.
    pub lat_deg_north: f64,
    /// Degrees east of Greenwich.
    pub lon_deg_east: f64,
}

/// A valid RMC.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rmc {
    /// Time of the fix, UTC.
    pub time: Option<TimeOfDay>,
    /// Date of the fix, UTC; two-digit years 80 to 99 lie in the 1900s.
    pub date: Option<Date>,
    /// Position of the fix.
    pub position: Option<Position>,
    /// Speed over the ground.
    pub sog_kn: Option<f64>,
    /// Course over the ground: never a heading.
    pub cog_deg_true: Option<f64>,
    /// The receiver's own value of the variation.
    pub variation_deg_east: Option<f64>,
}

impl Rmc {
    /// Microseconds since 1970 UTC, when both date and time are given.
    pub fn unix_micros(&self) -> Option<i64> {
        Some(unix_micros(self.date?, self.time?))
    }
}

/// A valid GGA.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gga {
    /// Time of the fix, UTC.
    pub time: Option<TimeOfDay>,
    /// Position of the fix.
    pub position: Option<Position>,
    /// 1 to 5: a fix by satellites (2 differential, 4 and 5 real-time kinematic).
    pub quality: u8,
    /// Satellites in use.
    pub satellites: Option<u8>,
    /// Horizontal dilution of precision.
    pub hdop: Option<f64>,
    /// Antenna above mean sea level.
    pub altitude_m: Option<f64>,
    /// Mean sea level above the ellipsoid.
    pub geoid_separation_m: Option<f64>,
}

/// A valid GLL.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gll {
    /// Position of the fix.
    pub position: Option<Position>,
    /// Time of the fix, UTC.
    pub time: Option<TimeOfDay>,
}

/// ZDA.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Zda {
    /// Time of day, UTC.
    pub time: Option<TimeOfDay>,
    /// Date, UTC; `None` when any part of it is empty.
    pub date: Option<Date>,
}

impl Zda {
    /// Microseconds since 1970 UTC, when both date and time are given.
    pub fn unix_micros(&self) -> Option<i64> {
        Some(unix_micros(self.date?, self.time?))
    }
}

/// A valid VTG.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vtg {
    /// Course over the ground from true north: never a heading.
    pub cog_deg_true: Option<f64>,
    /// Course over the ground from magnetic north.
    pub cog_deg_magnetic: Option<f64>,
    /// Speed over the ground.
    pub sog_kn: Option<f64>,
}

/// XDR: only roll and pitch are read (`A,x,D,ROLL` and `A,x,D,PTCH`), and the temperature
/// of the air (`C,x,C,TempAir`, or one of the other usual names).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Xdr {
    /// Roll, positive starboard down.
    pub roll_deg_starboard_down: Option<f64>,
    /// Pitch, positive bow up.
    pub pitch_deg_bow_up: Option<f64>,
    /// Temperature of the air, degrees Celsius.
    pub air_temperature_c: Option<f64>,
}

/// MTA.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mta {
    /// Temperature of the air, degrees Celsius.
    pub air_temperature_c: Option<f64>,
}

/// HBT.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hbt {
    /// Time between heartbeats.
    pub interval_s: Option<f64>,
    /// Status A: the equipment works normally.
    pub normal: bool,
    /// Sequence number, counting 0 to 9.
    pub sequence: Option<u8>,
}

/// ACN with status flag C: without it the sentence is no command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Acn {
    /// Time at which the command was sent, UTC.
    pub time: Option<TimeOfDay>,
    /// Alert that it is for.
    pub alert: AlertId,
    /// Command.
    pub command: AlertCommand,
}

/// Identity of an alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AlertId {
    /// Mnemonic of the manufacturer; `None` for an alert that the standards define.
    pub manufacturer: Option<[u8; 3]>,
    /// Alert identifier, at most 9,999,999; manufacturers' own begin at 10,000.
    pub number: u32,
    /// Instance, 1 to 999,999; `None` where there is only one.
    pub instance: Option<u32>,
}

/// Command to an alert, or refused command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlertCommand {
    /// A: acknowledges.
    Acknowledge,
    /// Q: requests the alert's sentences again.
    Request,
    /// O: takes over the responsibility.
    Transfer,
    /// S: silences for a while.
    Silence,
}

impl AlertCommand {
    /// The command that a letter stands for.
    pub fn from_letter(letter: u8) -> Option<AlertCommand> {
        Some(match letter {
            b'A' => AlertCommand::Acknowledge,
            b'Q' => AlertCommand::Request,
            b'O' => AlertCommand::Transfer,
            b'S' => AlertCommand::Silence,
            _ => return None,
        })
    }

    /// The letter in the sentence.
    pub fn letter(self) -> u8 {
        match self {
            AlertCommand::Acknowledge => b'A',
            AlertCommand::Request => b'Q',
            AlertCommand::Transfer => b'O',
            AlertCommand::Silence => b'S',
        }
    }
}

/// The kind of a sentence: its three letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "each is named after its sentence, see Data")]
pub enum Kind {
    Hdg,
    Hdm,
    Hdt,
    Ths,
    Vhw,
    Rot,
    Rmc,
    Gga,
    Gll,
    Zda,
    Vtg,
    Xdr,
    Mta,
    Hbt,
    Acn,
}

impl Kind {
    /// All kinds, in the order of their declaration.
    pub const ALL: [Kind; 15] = [
        Kind::Hdg,
        Kind::Hdm,
        Kind::Hdt,
        Kind::Ths,
        Kind::Vhw,
        Kind::Rot,
        Kind::Rmc,
        Kind::Gga,
        Kind::Gll,
        Kind::Zda,
        Kind::Vtg,
        Kind::Xdr,
        Kind::Mta,
        Kind::Hbt,
        Kind::Acn,
    ];

    /// The kind that three letters name.
    pub fn from_code(code: [u8; 3]) -> Option<Kind> {
        Some(match &code {
            b"HDG" => Kind::Hdg,
            b"HDM" => Kind::Hdm,
            b"HDT" => Kind::Hdt,
            b"THS" => Kind::Ths,
            b"VHW" => Kind::Vhw,
            b"ROT" => Kind::Rot,
            b"RMC" => Kind::Rmc,
            b"GGA" => Kind::Gga,
            b"GLL" => Kind::Gll,
            b"ZDA" => Kind::Zda,
            b"VTG" => Kind::Vtg,
            b"XDR" => Kind::Xdr,
            b"MTA" => Kind::Mta,
            b"HBT" => Kind::Hbt,
            b"ACN" => Kind::Acn,
            _ => return None,
        })
    }

    /// The three letters as text.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Hdg => "HDG",
            Kind::Hdm => "HDM",
            Kind::Hdt => "HDT",
            Kind::Ths => "THS",
            Kind::Vhw => "VHW",
            Kind::Rot => "ROT",
            Kind::Rmc => "RMC",
            Kind::Gga => "GGA",
            Kind::Gll => "GLL",
            Kind::Zda => "ZDA",
            Kind::Vtg => "VTG",
            Kind::Xdr => "XDR",
            Kind::Mta => "MTA",
            Kind::Hbt => "HBT",
            Kind::Acn => "ACN",
        }
    }

    /// The three letters.
    pub fn code(self) -> [u8; 3] {
        let name = self.name().as_bytes();
        [name[0], name[1], name[2]]
    }
}

impl Data {
    /// The kind of this sentence.
    pub fn kind(&self) -> Kind {
        match self {
            Data::Hdg(_) => Kind::Hdg,
            Data::Hdm(_) => Kind::Hdm,
            Data::Hdt(_) => Kind::Hdt,
            Data::Ths(_) => Kind::Ths,
            Data::Vhw(_) => Kind::Vhw,
            Data::Rot(_) => Kind::Rot,
            Data::Rmc(_) => Kind::Rmc,
            Data::Gga(_) => Kind::Gga,
            Data::Gll(_) => Kind::Gll,
            Data::Zda(_) => Kind::Zda,
            Data::Vtg(_) => Kind::Vtg,
            Data::Xdr(_) => Kind::Xdr,
            Data::Mta(_) => Kind::Mta,
            Data::Hbt(_) => Kind::Hbt,
            Data::Acn(_) => Kind::Acn,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_found_by_its_letters() {
        for (index, kind) in Kind::ALL.into_iter().enumerate() {
            assert_eq!(Kind::from_code(kind.code()), Some(kind));
            assert_eq!(kind as usize, index);
        }
        assert_eq!(Kind::from_code(*b"VDM"), None);
    }

    #[test]
    fn a_true_heading_is_valid_in_mode_a_alone() {
        for letter in b'A'..=b'Z' {
            let Some(mode) = ThsMode::from_letter(letter) else {
                continue;
            };
            assert_eq!(mode.letter(), letter);
            let ths = Ths {
                heading_deg_true: Some(77.0),
                mode,
            };
            let expected = (letter == b'A').then_some(77.0);
            assert_eq!(ths.valid_heading_deg_true(), expected);
        }
    }
}
