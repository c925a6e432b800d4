//! A number with its standard error.

use serde::{Deserialize, Serialize};

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// Its standard error in the same unit; `None` when the model came without
    /// a covariance.
    pub standard_error: Option<f64>,
}
