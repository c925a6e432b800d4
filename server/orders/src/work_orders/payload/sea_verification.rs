//! Verification of an adjustment by headings at sea.

use binnacle_adjustment::adjust::Verification;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Verification of an adjustment by headings at sea.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = OrderVerification)]
pub(crate) struct SeaVerification {
    /// The verdict with its figures: `passed`, `more_needed` or `alarm`.
    pub verification: Verification,
    /// The verdict in words.
    pub words: String,
    /// Number of samples.
    pub samples: usize,
    /// Time of the last sample.
    pub until: Time,
}

impl SeaVerification {
    /// Returns whether headings at sea confirmed the prediction.
    pub(crate) fn has_passed(&self) -> bool {
        matches!(self.verification, Verification::Passed { .. })
    }
}
