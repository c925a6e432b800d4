//! Comparison of λ with an earlier berth.

use crate::adjust::inputs::EarlierLambda;
use serde::{Deserialize, Serialize};

/// λ compared with that of an earlier berth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LambdaComparison {
    /// Earlier λ.
    pub earlier: EarlierLambda,
    /// Present less earlier λ.
    #[serde(rename = "off")]
    pub difference: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
}

impl LambdaComparison {
    /// Summarises the difference.
    pub(crate) fn summary(&self, lambda: f64) -> String {
        format!(
            "lambda is {lambda:.3}, {:.3} {} than at this compass's berth of {} (standard error \
             {:.3})",
            self.difference.abs(),
            if self.difference > 0.0 {
                "more"
            } else {
                "less"
            },
            &self.earlier.at.to_string()[..10],
            self.standard_error
        )
    }
}
