//! Result of a step at the binnacle.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What became of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepResult {
    /// The step's number in its plan.
    pub number: u32,
    /// What the compass read before.
    pub before_deg: f64,
    /// What it read after.
    pub after_deg: f64,
    /// By how much it should have turned.
    pub expected_change_deg: f64,
    /// How far off that may be.
    pub tolerance_deg: f64,
    /// In a word.
    pub verdict: StepVerdict,
    /// In words.
    pub words: String,
}

/// What became of a step, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = StepVerdict)]
pub(crate) enum StepVerdict {
    /// It did what was expected.
    Confirmed,
    /// On this heading the compass does not show it, and showed nothing.
    NotSeen,
    /// The magnets are in with the wrong end; there is a new plan.
    WrongEnd,
    /// The corrector is of another strength than was taken; there is a new plan.
    OtherStrength,
    /// Nothing explains it: read again.
    Unexplained,
}

impl StepResult {
    /// Whether the next step may follow.
    pub(crate) fn is_confirmed(&self) -> bool {
        matches!(self.verdict, StepVerdict::Confirmed | StepVerdict::NotSeen)
    }
}

/// What became of a step.
#[derive(ToSchema)]
#[schema(as = StepSaid)]
#[allow(dead_code, reason = "describes StepSaid")]
pub(crate) struct VerdictSchema {
    /// The step's number in its plan.
    number: u32,
    before_deg: f64,
    after_deg: f64,
    /// By how much the compass should have turned.
    expected_change_deg: f64,
    /// How far off that may be.
    tolerance_deg: f64,
    /// In a word.
    verdict: StepVerdict,
    /// In words.
    words: String,
}
