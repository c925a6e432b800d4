//! Headings, deviation and variation as types that combine only in the right way.
//!
//! `CompassHeading + Deviation = MagneticHeading` and
//! `MagneticHeading + Variation = TrueHeading`; nothing else compiles. Headings
//! are always in [0°, 360°), deviation and variation in (−180°, 180°], east
//! positive. Bearings and the errors of instruments follow the same rules.

mod bearing;

pub use bearing::{CompassBearing, CompassError, GyroBearing, GyroError, GyroHeading, TrueBearing};

use crate::number::CompactNumber;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::{Add, Sub};

/// Wraps a finite angle into [0°, 360°).
pub fn wrap_360(degrees: f64) -> f64 {
    let wrapped = degrees.rem_euclid(360.0);
    // A tiny negative angle wraps to exactly 360, which is 0.
    if wrapped < 360.0 { wrapped } else { 0.0 }
}

/// Wraps a finite angle into (−180°, 180°].
pub fn wrap_180(degrees: f64) -> f64 {
    let wrapped = wrap_360(degrees);
    if wrapped > 180.0 {
        wrapped - 360.0
    } else {
        wrapped
    }
}

/// Error of a number that is not a valid angle.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AngleError {
    /// The number is NaN or infinite.
    #[error("{0} is not a finite angle")]
    NotFinite(f64),
    /// The number lies outside the range that the outside world may send.
    #[error("{} degrees is outside {low} to {high}", CompactNumber(*value))]
    OutOfRange {
        /// Value as received.
        value: f64,
        /// Least accepted value.
        low: f64,
        /// Greatest accepted value.
        high: f64,
    },
}

macro_rules! heading {
    ($name:ident, $doc:literal) => {
        #[doc = $doc]
        ///
        /// Degrees clockwise from north, in [0°, 360°). In JSON a number of
        /// degrees from 0 to 360.
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name(f64);

        impl $name {
            /// Wraps any finite angle; `None` for NaN or infinity.
            pub fn new(degrees: f64) -> Option<Self> {
                degrees.is_finite().then(|| Self(wrap_360(degrees)))
            }

            /// The direction in degrees, in [0°, 360°).
            pub fn degrees(self) -> f64 {
                self.0
            }

            /// The direction in radians, in [0, 2π).
            pub fn radians(self) -> f64 {
                self.0.to_radians()
            }
        }

        impl TryFrom<f64> for $name {
            type Error = AngleError;

            /// Accepts the range that instruments and users send: 0 to 360 degrees.
            fn try_from(degrees: f64) -> Result<Self, AngleError> {
                if !degrees.is_finite() {
                    return Err(AngleError::NotFinite(degrees));
                }
                if !(0.0..=360.0).contains(&degrees) {
                    return Err(AngleError::OutOfRange {
                        value: degrees,
                        low: 0.0,
                        high: 360.0,
                    });
                }
                Ok(Self(wrap_360(degrees)))
            }
        }

        impl From<$name> for f64 {
            fn from(heading: $name) -> f64 {
                heading.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{:05.1}°", self.0)
            }
        }
    };
}

use heading;

heading!(
    CompassHeading,
    "Heading read from the magnetic compass, before deviation."
);
heading!(
    MagneticHeading,
    "Heading from magnetic north: compass heading with deviation applied."
);
heading!(
    TrueHeading,
    "Heading from true north: magnetic heading with variation applied."
);

heading!(
    CourseOverGround,
    "Direction in which the ship moves over the ground, from true north: never a heading."
);

macro_rules! difference {
    ($name:ident, $doc:literal) => {
        #[doc = $doc]
        ///
        /// Degrees in (−180°, 180°], east positive. In JSON a number of degrees
        /// from −180 to 180.
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name(f64);

        impl $name {
            /// Zero degrees.
            pub const ZERO: Self = Self(0.0);

            /// Wraps any finite angle; `None` for NaN or infinity.
            pub fn new(degrees_east: f64) -> Option<Self> {
                degrees_east
                    .is_finite()
                    .then(|| Self(wrap_180(degrees_east)))
            }

            /// Degrees, east positive, in (−180°, 180°].
            pub fn degrees_east(self) -> f64 {
                self.0
            }
        }

        impl TryFrom<f64> for $name {
            type Error = AngleError;

            fn try_from(degrees: f64) -> Result<Self, AngleError> {
                if !degrees.is_finite() {
                    return Err(AngleError::NotFinite(degrees));
                }
                if !(-180.0..=180.0).contains(&degrees) {
                    return Err(AngleError::OutOfRange {
                        value: degrees,
                        low: -180.0,
                        high: 180.0,
                    });
                }
                Ok(Self(wrap_180(degrees)))
            }
        }

        impl From<$name> for f64 {
            fn from(difference: $name) -> f64 {
                difference.0
            }
        }

        impl fmt::Display for $name {
            /// Formats as on a nautical chart: `3.4° W`.
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let side = if self.0 < 0.0 { "W" } else { "E" };
                write!(f, "{:.1}° {side}", self.0.abs())
            }
        }
    };
}

use difference;

difference!(
    Deviation,
    "Angle added by the ship's own magnetism: magnetic heading less compass heading."
);
difference!(
    Variation,
    "Angle between magnetic and true north: true heading less magnetic heading."
);

impl Add<Deviation> for CompassHeading {
    type Output = MagneticHeading;
    fn add(self, deviation: Deviation) -> MagneticHeading {
        MagneticHeading(wrap_360(self.0 + deviation.0))
    }
}

impl Sub<Deviation> for MagneticHeading {
    type Output = CompassHeading;
    fn sub(self, deviation: Deviation) -> CompassHeading {
        CompassHeading(wrap_360(self.0 - deviation.0))
    }
}

impl Sub<CompassHeading> for MagneticHeading {
    type Output = Deviation;
    fn sub(self, compass: CompassHeading) -> Deviation {
        Deviation(wrap_180(self.0 - compass.0))
    }
}

impl Add<Variation> for MagneticHeading {
    type Output = TrueHeading;
    fn add(self, variation: Variation) -> TrueHeading {
        TrueHeading(wrap_360(self.0 + variation.0))
    }
}

impl Sub<Variation> for TrueHeading {
    type Output = MagneticHeading;
    fn sub(self, variation: Variation) -> MagneticHeading {
        MagneticHeading(wrap_360(self.0 - variation.0))
    }
}

impl Sub<MagneticHeading> for TrueHeading {
    type Output = Variation;
    fn sub(self, magnetic: MagneticHeading) -> Variation {
        Variation(wrap_180(self.0 - magnetic.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn east_and_west_add_up_on_both_sides_of_north_and_south() {
        for compass in [0.0, 0.5, 90.0, 179.5, 180.0, 359.5] {
            for deviation in [-20.0, -0.5, 0.0, 0.5, 20.0] {
                for variation in [-170.0, -25.0, 0.0, 25.0, 180.0] {
                    let compass_heading = CompassHeading::new(compass).unwrap();
                    let magnetic = compass_heading + Deviation::new(deviation).unwrap();
                    let true_heading = magnetic + Variation::new(variation).unwrap();
                    let expected = wrap_360(compass + deviation + variation);
                    assert!((wrap_180(true_heading.degrees() - expected)).abs() < 1e-9);
                    assert!(((magnetic - compass_heading).degrees_east() - deviation).abs() < 1e-9);
                    let back = true_heading
                        - Variation::new(variation).unwrap()
                        - Deviation::new(deviation).unwrap();
                    assert!(wrap_180(back.degrees() - compass).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn an_angle_that_is_not_finite_or_out_of_range_is_refused() {
        assert!(CompassHeading::new(f64::NAN).is_none());
        assert!(Deviation::new(f64::INFINITY).is_none());
        assert!(TrueHeading::try_from(360.1).is_err());
        assert!(TrueHeading::try_from(-0.1).is_err());
        assert!(Variation::try_from(-180.1).is_err());
        assert!(serde_json::from_str::<CompassHeading>("400").is_err());
    }

    #[test]
    #[allow(clippy::float_cmp, reason = "these wrap exactly")]
    fn a_full_circle_is_north_and_minus_180_is_180() {
        assert_eq!(CompassHeading::try_from(360.0).unwrap().degrees(), 0.0);
        assert_eq!(CompassHeading::new(-1e-20).unwrap().degrees(), 0.0);
        assert_eq!(Deviation::new(-180.0).unwrap().degrees_east(), 180.0);
    }

    #[test]
    fn west_is_shown_as_west() {
        assert_eq!(Variation::new(-3.4).unwrap().to_string(), "3.4° W");
        assert_eq!(Deviation::new(3.4).unwrap().to_string(), "3.4° E");
    }
}
