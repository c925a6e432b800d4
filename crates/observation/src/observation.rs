//! Observations: readings of instruments, whatever input carried them. Inputs make them; roles and
//! sampler use them.
//!
//! A value that the instrument left empty is absent, never zero. The compass heading is always the
//! raw reading, before any deviation.

use super::source::Source;
use binnacle_compass::angle::{
    CompassHeading, CourseOverGround, Deviation, MagneticHeading, TrueHeading, Variation,
};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use binnacle_nmea::sentence::Acn;

/// Talker and sentence of a time that the recording gave, not an instrument.
pub const RECORDED_TIME: ([u8; 2], [u8; 3]) = (*b"--", *b"LOG");

/// Returns whether an observation is the time that a recording gives its lines.
pub fn is_recorded_time(seen: &Observation) -> bool {
    (seen.source.talker, seen.source.sentence) == RECORDED_TIME
}

/// One reading from one source.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Source.
    pub source: Source,
    /// Time at which the reading was measured, as its source states it (Signal K `timestamp`, TAG
    /// block `c:`).
    pub stated: Option<Timestamp>,
    /// Content of the sentence.
    pub reading: Reading,
}

impl Observation {
    /// Creates an observation that states no time: it was measured when it arrives.
    pub fn now(source: Source, reading: Reading) -> Observation {
        Observation {
            source,
            stated: None,
            reading,
        }
    }
}

/// Readings that the agent uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// HDG: the sensor's own reading, with its deviation and variation.
    Compass {
        /// Before deviation.
        raw: CompassHeading,
        /// As the instrument gives it; never applied.
        deviation: Option<Deviation>,
        /// As the instrument gives it; never applied.
        variation: Option<Variation>,
    },
    /// HDM: only the configuration knows whether deviation was applied.
    Magnetic {
        /// With or without deviation.
        heading: MagneticHeading,
        /// As a server gives it beside the heading; never applied.
        deviation: Option<Deviation>,
        /// As a server gives it beside the heading; never applied.
        variation: Option<Variation>,
    },
    /// HDT, or THS in mode A.
    True(TrueHeading),
    /// A true heading that the instrument itself marks as not valid (THS mode other than A).
    TrueNotValid,
    /// A valid fix; `time` when the sentence carries UTC date and time.
    Fix {
        /// Position.
        position: Position,
        /// UTC date and time of the fix.
        time: Option<Timestamp>,
        /// Speed over ground.
        sog_kn: Option<f64>,
    },
    /// ZDA: UTC date and time alone.
    Time(Timestamp),
    /// Present time of a server, as it greets.
    Greeting(Timestamp),
    /// VTG: speed over ground.
    Speed {
        /// Knots.
        sog_kn: f64,
    },
    /// VHW: speed through the water.
    WaterSpeed {
        /// Knots.
        kn: f64,
    },
    /// VTG or RMC: course over ground, which is never a heading.
    Course(CourseOverGround),
    /// ROT with status A: degrees a minute, starboard positive.
    RateOfTurn {
        /// Degrees a minute.
        deg_min: f64,
    },
    /// Roll, degrees, starboard down positive.
    Roll {
        /// Degrees.
        deg: f64,
    },
    /// Temperature of the air.
    Temperature {
        /// Degrees Celsius.
        celsius: f64,
    },
    /// ACN: a command of the bridge to an alert, its own or another equipment's.
    AlertCommand(Acn),
    /// Pitch, degrees, bow up positive.
    Pitch {
        /// Degrees.
        deg: f64,
    },
}
