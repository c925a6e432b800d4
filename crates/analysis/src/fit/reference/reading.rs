//! Heading readings with their references, and the references' trust.

use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// What was read at one time, with the earth's field around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingReading {
    /// When; none when the source did not say.
    pub time: Option<Timestamp>,
    /// Where; none when the source gave the field in place of the position.
    pub position: Option<Position>,
    /// The raw compass heading.
    pub compass: CompassHeading,
    /// The gyro's, its speed error taken out.
    pub gyro: Option<TrueHeading>,
    /// The satellite compass's.
    pub satellite: Option<TrueHeading>,
    /// A true heading of unknown origin, for want of the other two.
    pub unnamed: Option<TrueHeading>,
    /// The earth's variation there and then.
    pub variation: Variation,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Speed over ground, knots.
    pub sog_kn: Option<f64>,
    /// Ten-second windows behind the reading, at least 1.
    pub windows: u16,
    /// Standard deviation of compass less reference among them, degrees.
    pub spread_deg: Option<f64>,
    /// How much it counts beside the others; 1 where nothing is said.
    pub weight: f64,
}

impl HeadingReading {
    pub(super) fn has_reference(&self) -> bool {
        self.gyro.or(self.satellite).or(self.unnamed).is_some()
    }

    pub(super) fn may_observe(&self, trust: Trust) -> bool {
        let (gyro, satellite) = self.believed(trust);
        let named = self.gyro.or(self.satellite);
        gyro.or(satellite).is_some() || named.is_none()
    }

    pub(super) fn believed(&self, trust: Trust) -> (Option<TrueHeading>, Option<TrueHeading>) {
        (
            self.gyro.filter(|_| trust.gyro),
            self.satellite.filter(|_| trust.satellite),
        )
    }
}

/// Which references of a reading are believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Trust {
    pub(super) gyro: bool,
    pub(super) satellite: bool,
}
