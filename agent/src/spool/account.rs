//! Balance of the daily byte budget, kept over a restart.

use crate::config::Profile;
use binnacle_magnetics::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Bytes of a request and its response on an open connection, without their bodies.
/// Measured as IP bytes both ways.
pub(crate) const REQUEST_BYTES: u64 = 389;

/// What is left of a budget, as it is kept over a restart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BudgetAccount {
    pub(crate) profile: Profile,
    /// Octets a day; none: as many as it takes.
    #[serde(rename = "day_octets")]
    pub(crate) daily_bytes: Option<f64>,
    /// Less than none when overdrawn.
    #[serde(rename = "left_octets")]
    pub(crate) remaining_bytes: f64,
    /// The ship's time of all this.
    pub(crate) ship_time: Option<Timestamp>,
}
