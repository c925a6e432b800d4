//! `[alert]`: when the agent says that compass and gyro have parted.

use super::limits::PositiveSeconds;
use crate::sampler::WINDOW_S;
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

impl AlertConfig {
    /// Windows that [`AlertConfig::settled_s`] stands for: a minute's at least, a
    /// day's at most.
    pub(crate) fn settled_windows(&self) -> usize {
        let windows = self.settled_s.0 / WINDOW_S as f64;
        windows.round().clamp(6.0, 8640.0) as usize
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
