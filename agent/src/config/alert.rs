//! `[alert]`: thresholds of the alert that compass and gyro disagree, and of the heading-difference
//! alarm.

use binnacle_instruments::config::PositiveSeconds;
use serde::Deserialize;

/// Thresholds of the agent's own alerts.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AlertConfig {
    /// Usual error of the vessel's gyro, at the equator.
    pub(crate) gyro_error_deg: GyroError,
    /// Duration of the disagreement that raises the alert, counted in settled windows.
    pub(crate) settled_s: PositiveSeconds,
    /// Difference between corrected heading and gyro that raises the heading-difference alarm.
    pub(crate) difference_deg: DifferenceLimit,
    /// Duration of that difference.
    pub(crate) difference_s: PositiveSeconds,
}

impl Default for AlertConfig {
    fn default() -> AlertConfig {
        AlertConfig {
            gyro_error_deg: GyroError(2.5),
            settled_s: PositiveSeconds(300.0),
            difference_deg: DifferenceLimit(10.0),
            // With the ten seconds of its mean, the alarm comes within a minute.
            difference_s: PositiveSeconds(45.0),
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

/// Limit of a difference of headings in degrees, from 1 to 90.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct DifferenceLimit(pub(crate) f64);

impl TryFrom<f64> for DifferenceLimit {
    type Error = String;
    fn try_from(degrees: f64) -> Result<DifferenceLimit, String> {
        if (1.0..=90.0).contains(&degrees) {
            Ok(DifferenceLimit(degrees))
        } else {
            Err(format!("{degrees} is not from 1 to 90 degrees"))
        }
    }
}
