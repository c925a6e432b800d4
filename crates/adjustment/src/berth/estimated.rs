//! A number with its standard error.

use serde::{Deserialize, Serialize};

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// Estimate.
    pub value: f64,
    /// Standard error in the same unit; `None` for a model without a covariance.
    pub standard_error: Option<f64>,
}
