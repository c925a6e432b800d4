//! Comparison of λ with an earlier berth.

use crate::adjust::inputs::EarlierLambda;
use serde::{Deserialize, Serialize};

/// λ beside an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LambdaComparison {
    /// As it was told before.
    pub earlier: EarlierLambda,
    /// How much more it is now.
    #[serde(rename = "off")]
    pub difference: f64,
    /// Of that.
    pub standard_error: f64,
}

impl LambdaComparison {
    /// How far they are apart, in words.
    pub(crate) fn summary(&self, lambda: f64) -> String {
        format!(
            "lambda is {lambda:.3}, {:.3} {} than this compass's berth of {} told (standard error \
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
