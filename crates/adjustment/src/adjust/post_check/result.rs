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

/// A step that was done.
#[derive(Clone, Debug, PartialEq)]
pub struct CompletedStep {
    /// The step.
    pub step: Step,
    /// By how much the compass turned, degrees, where it was read.
    pub turned_deg: Option<f64>,
}

/// What the second reading came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PostCheck {
    /// Forward, to starboard and, where it was read both times, down.
    pub parts: Vec<FieldComponent>,
    /// The compass held against the field, where it was read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub card: Option<CardCheck>,
    /// What to make of it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// One part of the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldComponent {
    /// What was foretold, nT.
    pub expected_nt: f64,
    /// What was read, nT.
    pub read_nt: f64,
    /// Standard error of the difference, nT.
    pub standard_error_nt: f64,
}

/// What to make of a second reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// The correctors do what they were to do.
    AsPlanned {
        /// What is foretold now.
        #[serde(rename = "learnt")]
        updated: Box<UpdatedPrediction>,
    },
    /// They do, but what is foretold now is beyond the limits: there is a plan from here.
    Replan {
        /// What is foretold now.
        #[serde(rename = "learnt")]
        updated: Box<UpdatedPrediction>,
        /// What of it is beyond the limits.
        refusals: Vec<Refused>,
        /// The binnacle with its correctors as they stand.
        binnacle: Box<Binnacle>,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// A step was done otherwise: look at it.
    Slip {
        /// Its place among those that were done, from 1.
        step: u32,
        /// What is suspected.
        slip: Slip,
        /// Belief in that step's slip, 0 to 1.
        share: f64,
        /// How the correctors would stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// Nothing explains it: read again.
    Unexplained {
        /// Mistakes each of which alone would explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
}

/// How a step was done instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "slip", rename_all = "snake_case")]
pub enum Slip {
    /// The magnets went in with the wrong end.
    WrongEnd,
    /// They went into another hole or position.
    OtherHole {
        /// Its number.
        hole: u16,
    },
    /// It was not done.
    NotDone,
}

/// What is foretold after the second reading, or after the steps without one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UpdatedPrediction {
    /// The model that holds from now on, with covariance.
    pub model_after: Model,
    /// Residuals at the berth and in the waters.
    pub after: Vec<PredictedTable>,
    /// The greatest residual in any of them, degrees.
    pub worst_residual_deg: f64,
    /// The widest 95 % band in any of them, degrees.
    pub widest_band_deg: f64,
}

impl UpdatedPrediction {
    /// Which of these limits it breaks in these waters, with what would cure that.
    #[must_use]
    pub fn limit_violation(&self, limits: &Limits, waters: &[Water]) -> Option<Refused> {
        first_violation(&self.after, &self.model_after, limits, waters).map(Refusal::with_cures)
    }
}
