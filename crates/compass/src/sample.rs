//! Sample of one settled heading: the agent's record and the estimator's input.

use crate::angle::{CompassHeading, TrueHeading};
use crate::position::Position;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

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
}
