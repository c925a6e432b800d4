//! Checked times of the configuration.

use serde::Deserialize;
use std::time::Duration;

/// Seconds, from a hundredth to a year.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Deserialize)]
#[serde(try_from = "f64")]
pub struct PositiveSeconds(pub f64);

impl PositiveSeconds {
    /// Converts to a duration of the standard library.
    pub fn duration(self) -> Duration {
        Duration::from_secs_f64(self.0)
    }
}

impl TryFrom<f64> for PositiveSeconds {
    type Error = String;
    fn try_from(seconds: f64) -> Result<PositiveSeconds, String> {
        if (0.01..=31_557_600.0).contains(&seconds) {
            Ok(PositiveSeconds(seconds))
        } else {
            Err(format!("{seconds} is not from 0.01 to 31557600 seconds"))
        }
    }
}
