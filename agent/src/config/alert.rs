//! `[alert]`: when the agent says that compass and gyro have parted.

use super::limits::PositiveSeconds;
use serde::Deserialize;

/// When the agent raises its own alert.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AlertConfig {
    /// What the ship's gyro may usually err, at the equator.
    pub(crate) gyro_error_deg: GyroError,
    /// So long they must be apart, counted in settled windows.
    pub(crate) settled_s: PositiveSeconds,
}

impl Default for AlertConfig {
    fn default() -> AlertConfig {
        AlertConfig {
            gyro_error_deg: GyroError(2.5),
            settled_s: PositiveSeconds(300.0),
        }
    }
}

/// Degrees, from a half to thirty.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct GyroError(pub(crate) f64);

impl TryFrom<f64> for GyroError {
    type Error = String;
    fn try_from(degrees: f64) -> Result<GyroError, String> {
        if (0.5..=30.0).contains(&degrees) {
            Ok(GyroError(degrees))
        } else {
            Err(format!("{degrees} is not from 0.5 to 30 degrees"))
        }
    }
}
