//! `[alert]`: thresholds of the alert that compass and gyro disagree.

use super::limits::PositiveSeconds;
use serde::Deserialize;

/// Thresholds of the agent's own alert.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AlertConfig {
    /// Usual error of the vessel's gyro, at the equator.
    pub(crate) gyro_error_deg: GyroError,
    /// Duration of the disagreement that raises the alert, counted in settled windows.
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

/// Usual error of a gyro in degrees, from 0.5 to 30.
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
