//! Result of a second reading.

use crate::adjust::diagnosis::{CardCheck, Misreading, Refusal, Refused};
use crate::adjust::inputs::{Limits, Water};
use crate::adjust::instructions::Step;
use crate::adjust::limit_violations::first_violation;
use crate::adjust::planning::Outcome;
use crate::adjust::prediction::PredictedTable;
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::model::Model;
use serde::{Deserialize, Serialize};

/// A completed step.
#[derive(Clone, Debug, PartialEq)]
pub struct CompletedStep {
    /// Step of the plan.
    pub step: Step,
    /// Observed turn of the compass, degrees, if read.
    pub turned_deg: Option<f64>,
}

/// Result of a second reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PostCheck {
    /// Parts forward, to starboard and, if measured both times, down.
    pub parts: Vec<FieldComponent>,
    /// Comparison of the compass with the field, if read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub card: Option<CardCheck>,
    /// Verdict on the reading.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// One component of the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = SecondReadingPart))]
pub struct FieldComponent {
    /// Predicted field, nT.
    pub expected_nt: f64,
    /// Measured field, nT.
    pub read_nt: f64,
    /// Standard error of the difference, nT.
    pub standard_error_nt: f64,
}

/// Verdict on a second reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// The correctors have the planned effect.
    AsPlanned {
        /// Updated prediction.
        #[serde(rename = "learnt")]
        updated: Box<UpdatedPrediction>,
    },
    /// The correctors have the planned effect, but the updated prediction violates the
    /// limits: there is a plan from there.
    Replan {
        /// Updated prediction.
        #[serde(rename = "learnt")]
        updated: Box<UpdatedPrediction>,
        /// Violations of the limits.
        refusals: Vec<Refused>,
        /// Binnacle with the present setting.
        binnacle: Box<Binnacle>,
        /// Plan from there.
        outcome: Box<Outcome>,
    },
    /// A step was probably done differently: check it.
    Slip {
        /// Number of the step among the completed ones, from 1.
        step: u32,
        /// Suspected slip.
        slip: Slip,
        /// Posterior probability that its corrector is not as believed, 0 to 1.
        share: f64,
        /// Resulting setting.
        setting: Setting,
        /// Plan from there.
        outcome: Box<Outcome>,
    },
    /// Nothing explains the reading: read again.
    Unexplained {
        /// Single misreadings that explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
}

/// Slip of the hand in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "slip", rename_all = "snake_case")]
pub enum Slip {
    /// Magnets with the wrong end.
    WrongEnd,
    /// Another hole or position.
    OtherHole {
        /// Number of the hole or position.
        hole: u16,
    },
    /// Step not done.
    NotDone,
}

/// Prediction after the second reading, or after the steps without one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UpdatedPrediction {
    /// Model that applies from now on, with covariance.
    pub model_after: Model,
    /// Residuals at the berth and in the waters.
    pub after: Vec<PredictedTable>,
    /// Greatest residual in any of them, degrees.
    pub worst_residual_deg: f64,
    /// Widest 95 % band in any of them, degrees.
    pub widest_band_deg: f64,
}

impl UpdatedPrediction {
    /// Checks the prediction against limits in these waters.
    #[must_use]
    pub fn limit_violation(&self, limits: &Limits, waters: &[Water]) -> Option<Refused> {
        first_violation(&self.after, &self.model_after, limits, waters).map(Refusal::with_cures)
    }
}
