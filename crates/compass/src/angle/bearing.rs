//! Bearings of objects, and the errors of compass and gyro that they show.
//!
//! An error is true less indicated, east positive: `TrueBearing − CompassBearing =
//! CompassError`, `CompassError − Variation = Deviation`, and an instrument's heading plus
//! its error is the true heading.

use super::{
    AngleError, CompassHeading, Deviation, TrueHeading, Variation, difference, heading, wrap_180,
    wrap_360,
};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::{Add, Sub};

heading!(TrueBearing, "Bearing of an object from true north.");
heading!(
    CompassBearing,
    "Bearing of an object as read with the magnetic compass."
);
heading!(
    GyroBearing,
    "Bearing of an object as read with a gyro repeater."
);
heading!(GyroHeading, "Heading as the gyro gave it.");

difference!(
    CompassError,
    "Angle from compass north to true north: true less compass, deviation plus variation."
);
difference!(GyroError, "Error of the gyro: true less gyro.");

impl TrueBearing {
    /// Heading of a vessel whose bow points at the object.
    pub fn ahead(self) -> TrueHeading {
        TrueHeading(self.0)
    }
}

impl Sub<CompassBearing> for TrueBearing {
    type Output = CompassError;
    fn sub(self, compass: CompassBearing) -> CompassError {
        CompassError(wrap_180(self.0 - compass.0))
    }
}

impl Sub<GyroBearing> for TrueBearing {
    type Output = GyroError;
    fn sub(self, gyro: GyroBearing) -> GyroError {
        GyroError(wrap_180(self.0 - gyro.0))
    }
}

impl Sub<CompassHeading> for TrueHeading {
    type Output = CompassError;
    fn sub(self, compass: CompassHeading) -> CompassError {
        CompassError(wrap_180(self.0 - compass.0))
    }
}

impl Sub<GyroHeading> for TrueHeading {
    type Output = GyroError;
    fn sub(self, gyro: GyroHeading) -> GyroError {
        GyroError(wrap_180(self.0 - gyro.0))
    }
}

impl Add<CompassError> for CompassHeading {
    type Output = TrueHeading;
    fn add(self, error: CompassError) -> TrueHeading {
        TrueHeading(wrap_360(self.0 + error.0))
    }
}

impl Add<GyroError> for GyroHeading {
    type Output = TrueHeading;
    fn add(self, error: GyroError) -> TrueHeading {
        TrueHeading(wrap_360(self.0 + error.0))
    }
}

impl Sub<Variation> for CompassError {
    type Output = Deviation;
    fn sub(self, variation: Variation) -> Deviation {
        Deviation(wrap_180(self.0 - variation.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_true_less_indicated_on_every_side() {
        for bearing in [0.0, 0.4, 90.0, 179.8, 180.0, 270.0, 359.7] {
            for error in [-179.0, -25.0, -0.5, 0.0, 0.5, 25.0, 179.0] {
                let compass = CompassBearing::new(bearing).unwrap();
                let seen = TrueBearing::new(bearing + error).unwrap() - compass;
                assert!((seen.degrees_east() - error).abs() < 1e-9);
                let gyro = GyroBearing::new(bearing).unwrap();
                let seen = TrueBearing::new(bearing + error).unwrap() - gyro;
                assert!((seen.degrees_east() - error).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn heading_plus_error_is_the_true_heading_and_back() {
        for heading in [0.0, 0.4, 90.0, 180.0, 359.7] {
            for error in [-30.0, -0.5, 0.0, 0.5, 30.0] {
                let compass = CompassHeading::new(heading).unwrap();
                let true_heading = compass + CompassError::new(error).unwrap();
                assert!(((true_heading - compass).degrees_east() - error).abs() < 1e-9);
                let gyro = GyroHeading::new(heading).unwrap();
                let true_heading = gyro + GyroError::new(error).unwrap();
                assert!(((true_heading - gyro).degrees_east() - error).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn compass_error_less_variation_is_deviation() {
        let error = CompassError::new(-12.5).unwrap();
        let deviation = error - Variation::new(-15.0).unwrap();
        assert_eq!(deviation.to_string(), "2.5° E");
        let across = CompassError::new(170.0).unwrap() - Variation::new(-170.0).unwrap();
        assert_eq!(across.to_string(), "20.0° W");
    }
}
