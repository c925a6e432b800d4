//! An analysis of one compass as it is printed, stored and shown.

use super::change::{Cause, Change};
use super::diagnostic::SampleDiagnostic;
use super::noise::NoiseLevels;
use super::references::ReferenceCheck;
use super::refusal::FitError;
use crate::coverage::Coverage;
use crate::logbook::LogbookKind;
use crate::model::Model;
use crate::position::Position;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// The name of the estimator behind an analysis, to be kept with its models.
/// It changes whenever the same input may lead to another model.
pub const ESTIMATOR: &str = "state-space-28";

/// What an analysis found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Analysis {
    /// [`ESTIMATOR`] of the version that did it.
    pub estimator: String,
    /// The intervals of constant magnetism in order of time; at least one.
    pub epochs: Vec<Epoch>,
    /// What changed the ship's magnetism, or seemed to, in order of time.
    #[serde(default)]
    pub changes: Vec<Change>,
    /// What the logbook does to the samples that people should know, a sentence each.
    #[serde(default)]
    pub notices: Vec<String>,
    /// Every distinct sample in order of time, with what became of it.
    pub samples: Vec<SampleDiagnostic>,
    /// Headings and magnetic latitudes of the samples with a deviation.
    pub coverage: Coverage,
    /// Time of the first sample.
    pub data_from: Option<Timestamp>,
    /// Time of the last sample.
    pub data_until: Option<Timestamp>,
    /// Where the last sample was taken, and the earth's field there and then.
    pub last_place: Option<LastPlace>,
}

impl Analysis {
    /// The last epoch: the one the ship sails in now.
    pub fn current_epoch(&self) -> Option<&Epoch> {
        self.epochs.last()
    }
}

/// Where and when the last sample was taken, and the earth's field there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastPlace {
    /// When.
    pub time: Timestamp,
    /// Where.
    #[serde(flatten)]
    pub position: Position,
    /// Variation, degrees, east positive.
    pub variation_deg: f64,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
}

/// An interval in which the ship's magnetism is taken for constant, but for
/// slow drift.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// Its beginning; none for the first, which reaches back without end.
    pub from: Option<Timestamp>,
    /// Its end; none for the last, which goes on.
    pub to: Option<Timestamp>,
    /// The entry of the logbook that ended the epoch before; none for the first,
    /// and where a change ended it that the samples show.
    pub begun_by: Option<LogbookKind>,
    /// The likeliest cause of the change by which it began, where the samples show
    /// one; also where that change was over.
    #[serde(default)]
    pub begun_by_change: Option<Cause>,
    /// The place in the list of the earlier epoch whose magnetism it is again.
    #[serde(default)]
    pub resumes: Option<usize>,
    /// Time of its first sample.
    pub data_from: Option<Timestamp>,
    /// Time of its last sample.
    pub data_until: Option<Timestamp>,
    /// How gyro and satellite compass compare.
    pub references: Option<ReferenceCheck>,
    /// How large each kind of noise was found to be.
    pub noise: Option<NoiseLevels>,
    /// The fit; exactly one of `model` and `refusal` is present.
    pub model: Option<Model>,
    /// Why there is no model.
    pub refusal: Option<FitError>,
}
