//! How gyro and satellite compass compare.

use serde::{Deserialize, Serialize};

/// Two references that usually differ by more or less may depart no further from that
/// before one of them has failed, degrees.
pub const MAX_FAILURE_THRESHOLD_DEG: f64 = 5.0;

/// How a ship's two references compare over all her samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceCheck {
    /// Samples with both.
    pub pairs: u64,
    /// Gyro less satellite compass, usually, degrees; none without enough pairs.
    pub offset_deg: Option<f64>,
    /// One of the two has failed where their difference departs further than
    /// this from the usual, degrees.
    #[serde(default = "widest_deg")]
    pub failed_beyond_deg: f64,
    /// Standard deviation of the constant error that is left in the reference.
    pub constant_sd_deg: f64,
    /// Samples whose gyro was dropped.
    #[serde(default)]
    pub gyro_dropped: u64,
    /// Samples whose satellite compass was dropped.
    #[serde(default)]
    pub satellite_dropped: u64,
}

fn widest_deg() -> f64 {
    MAX_FAILURE_THRESHOLD_DEG
}
