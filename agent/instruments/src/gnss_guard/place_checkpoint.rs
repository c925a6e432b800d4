//! Place of the ship, saved before a restart: the first fixes afterwards are held against it.

use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Place of the ship at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlaceCheckpoint {
    /// Place by the last trusted fix and dead reckoning since.
    pub position: Position,
    /// Greatest distance of the ship from it, nautical miles.
    pub radius_nm: f64,
    /// Longest time for which a receiver has been trusted, seconds.
    pub trusted_s: f64,
    /// Ship's time, if it was known.
    pub ship: Option<Timestamp>,
    /// Computer's time.
    pub computer: Timestamp,
}
