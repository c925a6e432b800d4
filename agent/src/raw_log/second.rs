//! Readings of one second.

use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::{Latest, Readings};
use std::time::Duration;
use tokio::time::Instant;

/// Readings of one second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Second {
    pub(crate) time: Timestamp,
    pub(crate) position: Option<Position>,
    pub(crate) compass: Option<CompassHeading>,
    pub(crate) gyro: Option<TrueHeading>,
    pub(crate) satellite: Option<TrueHeading>,
    pub(crate) sog_kn: Option<f64>,
    pub(crate) rate_of_turn_deg_min: Option<f64>,
    pub(crate) roll_deg: Option<f64>,
}

impl Second {
    /// Takes the readings that are not older than `stale`.
    pub(crate) fn from_readings(
        time: Timestamp,
        readings: &Readings,
        stale: Duration,
        now: Instant,
    ) -> Self {
        Second {
            time,
            position: Latest::within(readings.position, stale, now),
            compass: Latest::within(readings.compass, stale, now),
            gyro: Latest::within(readings.gyro, stale, now),
            satellite: Latest::within(readings.satellite, stale, now),
            sog_kn: Latest::within(readings.sog_kn, stale, now),
            rate_of_turn_deg_min: Latest::within(readings.rate_of_turn_deg_min, stale, now),
            roll_deg: Latest::within(readings.roll_deg, stale, now),
        }
    }
}
