//! Result of the analysis of one compass, as printed, stored and displayed.

use super::change::{Cause, Change};
use super::diagnostic::SampleDiagnostic;
use super::noise::NoiseLevels;
use super::prediction::PredictionCoverage;
use super::references::ReferenceCheck;
use super::refusal::FitError;
use crate::coverage::Coverage;
use crate::logbook::LogbookKind;
use crate::model::Model;
use crate::position::Position;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Name of the estimator, kept with its models. It changes whenever the same input may lead
/// to another model.
pub const ESTIMATOR: &str = "hypotheses-4";

/// Number of the form in which the state of an analysis is kept. It changes whenever the state has
/// other fields: one of another form is not read.
pub const STATE_FORM: u32 = 1;

/// Result of an analysis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Analysis {
    /// [`ESTIMATOR`] of the version that made the analysis.
    pub estimator: String,
    /// Intervals of constant magnetism in order of time; at least one.
    pub epochs: Vec<Epoch>,
    /// Actual and suspected changes of the ship's magnetism, in order of time.
    #[serde(default)]
    pub changes: Vec<Change>,
    /// Notable effects of the logbook on the samples, a sentence each.
    #[serde(default)]
    pub notices: Vec<String>,
    /// Every distinct sample in order of time, with its diagnosis.
    pub samples: Vec<SampleDiagnostic>,
    /// Headings and magnetic latitudes of the samples with a deviation.
    pub coverage: Coverage,
    /// Check by the analysis's own predictions; none where the estimator makes none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predictions: Option<PredictionCoverage>,
    /// Time of the first sample.
    pub data_from: Option<Timestamp>,
    /// Time of the last sample.
    pub data_until: Option<Timestamp>,
    /// Position of the last sample, with the earth's field at that place and time.
    pub last_place: Option<LastPlace>,
}

impl Analysis {
    /// Returns the last epoch, which is the present one.
    pub fn current_epoch(&self) -> Option<&Epoch> {
        self.epochs.last()
    }
}

/// Position and time of the last sample, with the earth's field there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastPlace {
    /// Time of the sample.
    pub time: Timestamp,
    /// Position of the sample.
    #[serde(flatten)]
    pub position: Position,
    /// Variation, degrees, east positive.
    pub variation_deg: f64,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
}

/// An interval of constant ship's magnetism, except for slow drift.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// Beginning; none for the first epoch, which reaches back without end.
    pub from: Option<Timestamp>,
    /// End; none for the last epoch, which continues.
    pub to: Option<Timestamp>,
    /// Logbook entry that ended the previous epoch; none for the first epoch, and where a
    /// detected change ended it.
    pub begun_by: Option<LogbookKind>,
    /// Likeliest cause of the detected change that began it; also set where that change
    /// ended.
    #[serde(default)]
    pub begun_by_change: Option<Cause>,
    /// Index of the earlier epoch with the same magnetism.
    #[serde(default)]
    pub resumes: Option<usize>,
    /// Time of its first sample.
    pub data_from: Option<Timestamp>,
    /// Time of its last sample.
    pub data_until: Option<Timestamp>,
    /// Samples that are left out because of magnetic cargo.
    #[serde(default)]
    pub left_out_laden: u64,
    /// Samples that are left out because of a berth.
    #[serde(default)]
    pub left_out_alongside: u64,
    /// Comparison of gyro and satellite compass.
    pub references: Option<ReferenceCheck>,
    /// Estimated standard deviation of each kind of noise.
    pub noise: Option<NoiseLevels>,
    /// Fitted model; exactly one of `model` and `refusal` is present.
    pub model: Option<Model>,
    /// Reason for the absence of a model.
    pub refusal: Option<FitError>,
}
