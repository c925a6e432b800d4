//! Sample of one settled heading: the agent's record and the estimator's input.

use crate::angle::{CompassHeading, CourseOverGround, TrueHeading};
use crate::position::Position;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::ops::RangeInclusive;

/// Rate of turn that a sample may have, degrees a minute.
pub const RATE_OF_TURN_RANGE_DEG_MIN: RangeInclusive<f64> = -3600.0..=3600.0;
/// Mean roll that a sample may have, degrees.
pub const ROLL_RANGE_DEG: RangeInclusive<f64> = -90.0..=90.0;
/// Standard deviation of roll that a sample may have, degrees.
pub const ROLL_SPREAD_RANGE_DEG: RangeInclusive<f64> = 0.0..=90.0;
/// Temperature that a sample may have, degrees Celsius.
pub const TEMPERATURE_RANGE_C: RangeInclusive<f64> = -100.0..=100.0;

/// The mean of up to ten minutes of settled ten-second windows on one heading.
///
/// The compass heading is the raw reading: no deviation has been applied. A
/// missing reference is `None`, never zero. At least one of `gyro` and
/// `satellite` is present in what the agent keeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = SettledSample))]
pub struct Sample {
    /// The middle of the stretch, UTC.
    pub time: Timestamp,
    /// Position at the middle of the stretch.
    #[serde(flatten)]
    #[cfg_attr(feature = "openapi", schema(inline))]
    pub position: Position,
    /// Mean raw compass heading.
    #[serde(rename = "compass_deg")]
    #[cfg_attr(feature = "openapi", schema(value_type = f64))]
    pub compass: CompassHeading,
    /// Mean gyro heading, as the gyro gave it.
    #[serde(rename = "gyro_deg")]
    #[cfg_attr(feature = "openapi", schema(required, value_type = Option<f64>))]
    pub gyro: Option<TrueHeading>,
    /// Mean satellite-compass heading.
    #[serde(rename = "satellite_deg")]
    #[cfg_attr(feature = "openapi", schema(required, value_type = Option<f64>))]
    pub satellite: Option<TrueHeading>,
    /// Speed over ground in knots.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub sog_kn: Option<f64>,
    /// Mean rate of turn in degrees a minute, starboard positive.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub rate_of_turn_deg_min: Option<f64>,
    /// Standard deviation, in degrees, of compass less reference among the windows.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub spread_deg: Option<f64>,
    /// Number of settled ten-second windows in the means; at least 1.
    pub windows: u16,
    /// Mean course over ground.
    #[serde(rename = "cog_deg", default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<f64>))]
    pub cog: Option<CourseOverGround>,
    /// Mean roll in degrees, starboard side down positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_deg: Option<f64>,
    /// Standard deviation of roll in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_spread_deg: Option<f64>,
    /// Mean temperature at the compass or around it, in degrees Celsius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_c: Option<f64>,
    /// Instrument that gave the gyro heading.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<u16>))]
    pub gyro_source: Option<SourceId>,
    /// Instrument that gave the satellite-compass heading.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<u16>))]
    pub satellite_source: Option<SourceId>,
    /// True if the position is by dead reckoning, because the receivers of satellites were
    /// disturbed. No estimate uses such a sample.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[cfg_attr(feature = "openapi", schema(default = false))]
    pub position_reckoned: bool,
}

impl Sample {
    /// Makes a sample of one window with nothing but the compass heading at a time and place.
    pub fn new(time: Timestamp, position: Position, compass: CompassHeading) -> Sample {
        Sample {
            time,
            position,
            compass,
            gyro: None,
            satellite: None,
            sog_kn: None,
            rate_of_turn_deg_min: None,
            spread_deg: None,
            windows: 1,
            cog: None,
            roll_deg: None,
            roll_spread_deg: None,
            temperature_c: None,
            gyro_source: None,
            satellite_source: None,
            position_reckoned: false,
        }
    }
}

/// Puts samples in order of time and then of everything else, and drops repetitions: the order in
/// which they arrived changes nothing.
pub fn sort_distinct(samples: &mut Vec<Sample>) {
    samples.sort_by(in_order);
    samples.dedup_by(|a, b| in_order(a, b) == Ordering::Equal);
}

fn in_order(a: &Sample, b: &Sample) -> Ordering {
    let numbers = |s: &Sample| {
        // A missing value sorts first.
        let or_first = |x: Option<f64>| x.unwrap_or(f64::NEG_INFINITY);
        let number = |source: SourceId| f64::from(source.number());
        [
            s.position.lat_deg(),
            s.position.lon_deg(),
            s.compass.degrees(),
            or_first(s.gyro.map(TrueHeading::degrees)),
            or_first(s.satellite.map(TrueHeading::degrees)),
            or_first(s.sog_kn),
            or_first(s.rate_of_turn_deg_min),
            or_first(s.spread_deg),
            f64::from(s.windows),
            or_first(s.cog.map(CourseOverGround::degrees)),
            or_first(s.roll_deg),
            or_first(s.roll_spread_deg),
            or_first(s.temperature_c),
            or_first(s.gyro_source.map(number)),
            or_first(s.satellite_source.map(number)),
            f64::from(u8::from(s.position_reckoned)),
        ]
    };
    let by_number = || {
        let pairs = numbers(a).into_iter().zip(numbers(b));
        pairs
            .map(|(a, b)| a.total_cmp(&b))
            .find(|o| o.is_ne())
            .unwrap_or(Ordering::Equal)
    };
    a.time.cmp(&b.time).then_with(by_number)
}

/// Identity of an instrument on board: the same number whenever the same source feeds a role.
///
/// It tells that a ship went from one gyro to another. It is a hash, so that two of the few
/// instruments of a ship share a number once in some ten thousand ships.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SourceId(u16);

impl SourceId {
    /// Takes a number that [`SourceId::number`] gave.
    pub fn new(number: u16) -> SourceId {
        SourceId(number)
    }

    /// Derives the identity from the name of a source: its FNV-1a hash, the halves of its
    /// 32 bits combined (Fowler, Noll, Vo; RFC 9923, section 2 and 3).
    pub fn from_name(name: &str) -> SourceId {
        let hash = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
            (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
        });
        SourceId(((hash >> 16) ^ (hash & 0xffff)) as u16)
    }

    /// The identity as a number.
    pub fn number(self) -> u16 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bare() -> Sample {
        let time = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        let position = Position::new(43.0, -3.0).unwrap();
        Sample::new(time, position, CompassHeading::new(91.0).unwrap())
    }

    #[test]
    fn an_absent_value_is_left_out_and_read_back_as_absent() {
        let text = serde_json::to_string(&bare()).unwrap();
        for name in [
            "cog_deg",
            "roll_deg",
            "roll_spread_deg",
            "temperature_c",
            "gyro_source",
            "satellite_source",
        ] {
            assert!(!text.contains(name), "{name} in {text}");
        }
        assert_eq!(serde_json::from_str::<Sample>(&text).unwrap(), bare());
    }

    #[test]
    fn every_value_survives_json() {
        let full = Sample {
            cog: CourseOverGround::new(92.5),
            roll_deg: Some(-1.5),
            roll_spread_deg: Some(2.25),
            temperature_c: Some(-3.0),
            gyro_source: Some(SourceId::from_name("gyro 1")),
            satellite_source: Some(SourceId::new(0)),
            ..bare()
        };
        let text = serde_json::to_string(&full).unwrap();
        assert!(text.contains(r#""cog_deg":92.5,"roll_deg":-1.5,"roll_spread_deg":2.25"#));
        assert_eq!(serde_json::from_str::<Sample>(&text).unwrap(), full);
    }

    #[test]
    fn a_source_has_one_number_and_another_source_another() {
        // Published FNV-1a 32 of "a": e40c292c (RFC 9923, appendix C).
        let a = SourceId::from_name("a");
        assert_eq!(a.number(), 0xe40c ^ 0x292c);
        assert_eq!(a, SourceId::from_name("a"));
        assert_ne!(SourceId::from_name("gyro 1"), SourceId::from_name("gyro 2"));
    }
}
