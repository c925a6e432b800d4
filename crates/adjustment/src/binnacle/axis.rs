//! Directions of magnets: axis and red end.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Axis of magnets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Along the keel.
    ForeAndAft,
    /// Across the keel.
    Athwartship,
}

/// Direction of the red, north-seeking end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = RedEnd))]
#[serde(rename_all = "snake_case")]
pub enum Red {
    /// To the bow.
    Forward,
    /// To the stern.
    Aft,
    /// To starboard.
    Starboard,
    /// To port.
    Port,
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

impl Axis {
    /// Both axes, in the order of setting.
    pub const BOTH: [Axis; 2] = [Axis::ForeAndAft, Axis::Athwartship];

    /// Returns the red end's direction: forward or to starboard if positive, else aft or to
    /// port.
    pub fn red(self, positive: bool) -> Red {
        match (self, positive) {
            (Axis::ForeAndAft, true) => Red::Forward,
            (Axis::ForeAndAft, false) => Red::Aft,
            (Axis::Athwartship, true) => Red::Starboard,
            (Axis::Athwartship, false) => Red::Port,
        }
    }
}

impl Red {
    /// Returns the sign along the ship's axes: forward, starboard and down are positive.
    pub fn sign(self) -> f64 {
        match self {
            Red::Forward | Red::Starboard | Red::Down => 1.0,
            Red::Aft | Red::Port | Red::Up => -1.0,
        }
    }

    /// Returns the opposite direction.
    pub fn reversed(self) -> Red {
        match self {
            Red::Forward => Red::Aft,
            Red::Aft => Red::Forward,
            Red::Starboard => Red::Port,
            Red::Port => Red::Starboard,
            Red::Up => Red::Down,
            Red::Down => Red::Up,
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Axis::ForeAndAft => "fore_and_aft",
            Axis::Athwartship => "athwartship",
        })
    }
}

impl fmt::Display for Red {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Red::Forward => "forward",
            Red::Aft => "aft",
            Red::Starboard => "starboard",
            Red::Port => "port",
            Red::Up => "up",
            Red::Down => "down",
        })
    }
}
