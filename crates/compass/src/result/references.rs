//! Comparison of gyro and satellite compass.

use serde::{Deserialize, Serialize};

/// Upper limit of [`ReferenceCheck::failed_beyond_deg`], degrees.
pub const MAX_FAILURE_THRESHOLD_DEG: f64 = 5.0;

/// Comparison of a vessel's two references over all samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = References))]
pub struct ReferenceCheck {
    /// Number of samples with both references.
    pub pairs: u64,
    /// Usual value of gyro less satellite compass, degrees; none without enough pairs.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub offset_deg: Option<f64>,
    /// Failure threshold: greatest departure of the difference from its usual value before
    /// one reference counts as failed, degrees.
    #[serde(default = "widest_deg")]
    #[cfg_attr(feature = "openapi", schema(required))]
    pub failed_beyond_deg: f64,
    /// Standard deviation of the reference's remaining constant error, degrees.
    pub constant_sd_deg: f64,
    /// Number of samples whose gyro heading was dropped.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    pub gyro_dropped: u64,
    /// Number of samples whose satellite heading was dropped.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    pub satellite_dropped: u64,
}

fn widest_deg() -> f64 {
    MAX_FAILURE_THRESHOLD_DEG
}
