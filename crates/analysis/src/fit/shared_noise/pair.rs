//! Pair of compass and reference heading, read at one time.

use crate::fit::reference::HeadingReading;
use crate::gyro_speed_error::northerly_speed_error_deg;
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// Compass and reference heading read at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingPair {
    /// Time of the pair; none when the source did not give it.
    pub time: Option<Timestamp>,
    /// Position; none when the source did not give it.
    pub position: Option<Position>,
    /// Raw compass heading.
    pub compass: CompassHeading,
    /// True heading by the reference.
    pub reference: TrueHeading,
    /// Variation of the earth's field there and then.
    pub variation: Variation,
    /// Speed over ground, knots.
    pub sog_kn: Option<f64>,
}

impl HeadingPair {
    /// Makes the pair of a reading's compass and one of its references.
    pub fn of_reading(reading: &HeadingReading, reference: TrueHeading) -> HeadingPair {
        HeadingPair {
            time: reading.time,
            position: reading.position,
            compass: reading.compass,
            reference,
            variation: reading.variation,
            sog_kn: reading.sog_kn,
        }
    }

    pub(super) fn compass_deg(&self) -> f64 {
        self.compass.degrees()
    }

    pub(super) fn reference_deg(&self) -> f64 {
        self.reference.degrees()
    }

    pub(super) fn variation_deg(&self) -> f64 {
        self.variation.degrees_east()
    }

    /// Returns reference less variation less compass, degrees.
    pub(super) fn difference_deg(&self) -> f64 {
        wrap_180(self.reference_deg() - self.variation_deg() - self.compass_deg())
    }

    /// Returns a gyro's speed error here on this heading, degrees: what was subtracted from a
    /// reading that never had it.
    pub(super) fn speed_error_deg(&self) -> f64 {
        match (self.sog_kn, self.position) {
            (Some(sog_kn), Some(position)) => {
                northerly_speed_error_deg(sog_kn, position.lat_deg())
                    * self.reference.radians().cos()
            }
            _ => 0.0,
        }
    }

    /// Returns the reference before the correction of a gyro's speed error, if there was one.
    pub(super) fn raw_reference_deg(&self) -> f64 {
        let (Some(sog_kn), Some(position)) = (self.sog_kn, self.position) else {
            return self.reference_deg();
        };
        // The correction was computed on the raw heading, which two rounds find again.
        let mut raw = self.reference;
        for _ in 0..3 {
            let error =
                crate::gyro_speed_error::gyro_speed_error_deg(raw, sog_kn, position.lat_deg());
            raw = TrueHeading::new(self.reference_deg() + error).unwrap_or(raw);
        }
        raw.degrees()
    }
}
