//! Limits from which a vessel's alerts are raised.

use binnacle_platform::error::Result;
use binnacle_platform::http::degrees;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Limits of a vessel's alerts. A flag state may require others: AMSA and the Marshall Islands
/// (MN 2-011-32) have the compass adjusted above 5° on any heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default)]
pub struct AlertLimits {
    /// Greatest deviation without an alert, degrees.
    #[schema(minimum = 1, maximum = 45, example = 5.0)]
    pub deviation_deg: f64,
    /// Greatest half width of the 95 % band without an alert, degrees.
    #[schema(minimum = 0.5, maximum = 45, example = 3.0)]
    pub band95_deg: f64,
    /// Days without a batch before an alert.
    #[schema(minimum = 0.25, maximum = 365, example = 3.0)]
    pub silent_days: f64,
}

impl Default for AlertLimits {
    fn default() -> AlertLimits {
        AlertLimits {
            deviation_deg: 5.0,
            band95_deg: 3.0,
            silent_days: 3.0,
        }
    }
}

impl AlertLimits {
    /// Returns the limits, if each is within its range.
    ///
    /// # Errors
    /// Fails when one is outside its range.
    pub fn checked(self) -> Result<AlertLimits> {
        degrees("alerts.deviation_deg", self.deviation_deg, 1.0, 45.0)?;
        degrees("alerts.band95_deg", self.band95_deg, 0.5, 45.0)?;
        degrees("alerts.silent_days", self.silent_days, 0.25, 365.0)?;
        Ok(self)
    }
}
