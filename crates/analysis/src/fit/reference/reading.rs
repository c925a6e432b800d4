//! Heading readings and the trust in their references.

use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// Headings read at one time, with the earth's field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingReading {
    /// Time of the reading; none when the source did not give it.
    pub time: Option<Timestamp>,
    /// Position; none when the source gave the field instead.
    pub position: Option<Position>,
    /// Raw compass heading.
    pub compass: CompassHeading,
    /// Gyro heading, corrected for speed error.
    pub gyro: Option<TrueHeading>,
    /// Heading of the satellite compass.
    pub satellite: Option<TrueHeading>,
    /// True heading of unknown origin, in the absence of the other two.
    pub unnamed: Option<TrueHeading>,
    /// Variation of the earth's field there and then.
    pub variation: Variation,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Speed over ground, knots.
    pub sog_kn: Option<f64>,
    /// Number of ten-second windows in the reading, at least 1.
    pub windows: u16,
    /// Standard deviation of compass less reference among the windows, degrees.
    pub spread_deg: Option<f64>,
    /// Weight beside the other readings; 1 where none is given.
    pub weight: f64,
}

impl HeadingReading {
    pub(super) fn has_reference(&self) -> bool {
        self.gyro.or(self.satellite).or(self.unnamed).is_some()
    }

    pub(super) fn may_observe(&self, trust: Trust) -> bool {
        let (gyro, satellite) = self.trusted(trust);
        let named = self.gyro.or(self.satellite);
        gyro.or(satellite).is_some() || named.is_none()
    }

    pub(super) fn trusted(&self, trust: Trust) -> (Option<TrueHeading>, Option<TrueHeading>) {
        (
            self.gyro.filter(|_| trust.gyro),
            self.satellite.filter(|_| trust.satellite),
        )
    }
}

/// Trust in each reference of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Trust {
    pub(super) gyro: bool,
    pub(super) satellite: bool,
}
