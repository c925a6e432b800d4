//! Latest readings of the instruments.

use super::roles::{ReferenceHeading, Signal};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use std::time::Duration;
use tokio::time::Instant;

/// A reading and its receive time by the computer's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Latest<T> {
    value: T,
    heard: Instant,
}

impl<T: Copy> Latest<T> {
    /// Returns the reading, unless it is older than `age` by the computer's clock.
    ///
    /// GNSS time does not serve here: it stands still when the receiver fails, and a heading must
    /// not look alive because of it.
    pub(crate) fn within(this: Option<Latest<T>>, age: Duration, now: Instant) -> Option<T> {
        let latest = this?;
        (now.saturating_duration_since(latest.heard) <= age).then_some(latest.value)
    }
}

/// Latest readings of the instruments.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Readings {
    pub(crate) compass: Option<Latest<CompassHeading>>,
    pub(crate) gyro: Option<Latest<TrueHeading>>,
    pub(crate) satellite: Option<Latest<TrueHeading>>,
    pub(crate) position: Option<Latest<Position>>,
    pub(crate) sog_kn: Option<Latest<f64>>,
    pub(crate) rate_of_turn_deg_min: Option<Latest<f64>>,
    pub(crate) roll_deg: Option<Latest<f64>>,
}

impl Readings {
    /// Applies the signal of an instrument, heard at `heard`.
    pub(crate) fn apply(&mut self, signal: Signal, heard: Instant) {
        match signal {
            Signal::Compass(value) => self.compass = Some(Latest { value, heard }),
            Signal::Gyro(ReferenceHeading { heading: value, .. }) => {
                self.gyro = Some(Latest { value, heard });
            }
            Signal::GyroInvalid => self.gyro = None,
            Signal::Satellite(ReferenceHeading { heading: value, .. }) => {
                self.satellite = Some(Latest { value, heard });
            }
            Signal::SatelliteInvalid => self.satellite = None,
            Signal::Position(value) => self.position = Some(Latest { value, heard }),
            Signal::Speed(value) => self.sog_kn = Some(Latest { value, heard }),
            Signal::RateOfTurn(value) => {
                self.rate_of_turn_deg_min = Some(Latest { value, heard });
            }
            Signal::Roll(value) => self.roll_deg = Some(Latest { value, heard }),
            Signal::Time(_) | Signal::Jump(_) | Signal::Course(_) | Signal::Temperature(_) => {}
        }
    }
}
