//! Result of a step at the binnacle.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Result of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = StepSaid)]
pub(crate) struct StepResult {
    /// Number of the step in its plan.
    pub number: u32,
    /// Compass reading before the step, degrees.
    pub before_deg: f64,
    /// Compass reading after the step, degrees.
    pub after_deg: f64,
    /// Expected turn, degrees.
    pub expected_change_deg: f64,
    /// Tolerance of that turn, degrees.
    pub tolerance_deg: f64,
    /// Verdict.
    pub verdict: StepVerdict,
    /// Verdict in words.
    pub words: String,
}

/// Verdict of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = StepVerdict)]
pub(crate) enum StepVerdict {
    /// The compass turned as expected.
    Confirmed,
    /// On this heading the compass does not show the step, and showed nothing.
    NotSeen,
    /// The magnets are in with the wrong end; there is a new plan.
    WrongEnd,
    /// The magnets stood with the other end before the step than recorded; there is a new
    /// plan.
    FoundOtherwise,
    /// The corrector has another strength than assumed; there is a new plan.
    OtherStrength,
    /// Nothing explains the reading: read again.
    Unexplained,
}

impl StepResult {
    /// Returns whether the next step may follow.
    pub(crate) fn is_confirmed(&self) -> bool {
        matches!(self.verdict, StepVerdict::Confirmed | StepVerdict::NotSeen)
    }
}
