//! Balance of the daily byte budget, kept over a restart.

use crate::config::Profile;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Bytes of a request and its response on an open connection, without their bodies.
/// Measured as IP bytes both ways.
pub(crate) const REQUEST_BYTES: u64 = 389;

/// Balance of the budget, and what the link costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BudgetAccount {
    pub(crate) profile: Profile,
    /// Bytes per day; `None` for no limit.
    #[serde(rename = "day_octets")]
    pub(crate) daily_bytes: Option<f64>,
    /// Balance; negative when overdrawn.
    #[serde(rename = "left_octets")]
    pub(crate) remaining_bytes: f64,
    /// GNSS time of the last update.
    pub(crate) ship_time: Option<Timestamp>,
    /// Bytes of the last connection to the server without its requests, as counted at the socket.
    #[serde(default)]
    pub(crate) connection_bytes: Option<f64>,
    /// Bytes counted at the socket since the agent was installed.
    #[serde(default)]
    pub(crate) total_bytes: f64,
}
