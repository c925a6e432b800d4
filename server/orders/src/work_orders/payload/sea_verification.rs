//! Verification of an adjustment by headings at sea.

use binnacle_adjustment::adjust::Verification;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What the headings at sea say.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = OrderVerification)]
pub(crate) struct SeaVerification {
    /// The verdict with its figures: `passed`, `more_needed` or `alarm`.
    #[schema(value_type = crate::work_orders::schema::SeaVerdictSchema)]
    pub verification: Verification,
    /// The same in words.
    pub words: String,
    /// How many samples it rests on.
    pub samples: usize,
    /// The time of the last of them.
    pub until: Time,
}

impl SeaVerification {
    /// Whether headings at sea bear out what was foretold.
    pub(crate) fn has_passed(&self) -> bool {
        matches!(self.verification, Verification::Passed { .. })
    }
}
