//! The whole analysis of one compass: from its samples and the ship's logbook
//! to epochs and their models.
//!
//! What always holds: [`analyse`] is a pure function. The order of the samples
//! and repeated samples change nothing, to the last bit; no sample is lost
//! without a reason; and a set of samples that does not carry a model yields a
//! refusal that says what is missing.

mod alongside;
mod cargo;
mod changes;
mod course;
mod either;
mod epoch;
mod logbook;
mod one_course;
mod reading;
mod settings;
mod stuck;

pub use crate::fit::GyroSpeedError;
pub use logbook::{Cargo, LogbookEntry, LogbookError, LogbookKind};
pub use settings::AnalysisSettings;

use crate::change::{Cause, Change};
use crate::coverage::{Coverage, coverage};
use crate::estimate::NoiseLevels;
use crate::fit::{FitError, ReferenceCheck};
use crate::model::Model;
use crate::position::Position;
use crate::sample::Sample;
use crate::time::Timestamp;
use alongside::{berths, mark_alongside};
use cargo::notices;
use changes::merge_faults;
use course::Course;
use epoch::epochs;
use reading::{Reading, readings};
use serde::{Deserialize, Serialize};
use stuck::mark_stuck;

/// The name of the estimator behind [`analyse`], to be kept with its models.
/// It changes whenever the same input may lead to another model.
pub const ESTIMATOR: &str = "state-space-28";

/// Said where nothing can be watched for.
const UNWATCHED: &str = "so far too little is known of the ship to tell a change of her \
                         magnetism from her own: one would not be noticed. Steady courses on \
                         more headings, by gyro or satellite compass, will tell";

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

/// A sample and what became of it. Fields that could not be had are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleDiagnostic {
    /// The sample as it was.
    #[serde(flatten)]
    pub sample: Sample,
    /// The earth's variation, degrees, east positive.
    pub variation_deg: Option<f64>,
    /// Horizontal field, nT.
    pub h_nt: Option<f64>,
    /// Vertical field, nT, down positive.
    pub z_nt: Option<f64>,
    /// Reference less variation less compass, degrees.
    pub deviation_deg: Option<f64>,
    /// The model's deviation on this compass heading, here, degrees.
    pub predicted_deg: Option<f64>,
    /// Measured less predicted, degrees.
    pub residual_deg: Option<f64>,
    /// Robust weight, 0 to 1.
    pub weight: f64,
    /// Whether it carried weight in a model.
    pub used: bool,
    /// Why it was left out or doubted; none when it was taken at full weight.
    pub reason: Option<SampleReason>,
}

/// Why a sample was left out, or held to be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleReason {
    /// Neither gyro nor satellite compass.
    NoReference,
    /// Gyro and satellite compass contradict each other and neither could be
    /// shown to be right, or the only one repeated itself while the ship turned.
    ReferenceFailed,
    /// The compass repeated itself while the ship turned.
    CompassStuck,
    /// Before or after the years that the field model covers.
    OutsideFieldModel,
    /// The horizontal field is too weak for a compass.
    FieldTooWeak,
    /// Taken with magnetic cargo on board.
    MagneticCargo,
    /// Taken alongside: by the logbook, or lying still on one heading.
    Berth,
    /// Taken in a magnetic storm, over a local anomaly, or near other iron.
    Disturbance,
    /// It disagrees with the rest: its weight was lowered by more than half.
    Outlier,
    /// Its epoch has no model.
    NoModel,
}

/// Analyses all samples of one compass.
pub fn analyse(
    samples: &[Sample],
    logbook: &[LogbookEntry],
    settings: &AnalysisSettings,
) -> Analysis {
    let mut readings = readings(samples, logbook, settings);
    let mut course = Course::after(mark_stuck(&mut readings));
    let stays = mark_alongside(&mut readings);
    let mut begun = None;
    for epoch in epochs(logbook) {
        let from = begun.or(epoch.from);
        begun = course.follow(Epoch { from, ..epoch }, &mut readings, logbook, settings);
    }
    let mut notices = notices(&readings, logbook, &course);
    if course.is_unwatched {
        notices.push(UNWATCHED.to_owned());
    }
    let Course {
        epochs,
        mut changes,
        ..
    } = course;
    berths(&stays, &readings, &epochs, &mut changes);
    changes.sort_by_key(|change| (change.from, change.detected_at));
    merge_faults(&mut changes, &epochs);
    let with_deviation = readings
        .iter()
        .filter(|r| r.diagnostic.deviation_deg.is_some());
    let coverage = coverage(
        with_deviation.filter_map(|r| r.earth.map(|e| (r.sample().compass, e.h_nt, e.z_nt))),
    );
    Analysis {
        estimator: ESTIMATOR.to_owned(),
        data_from: readings.first().map(|r| r.sample().time),
        data_until: readings.last().map(|r| r.sample().time),
        last_place: readings.iter().rev().find_map(Reading::place),
        coverage,
        epochs,
        changes,
        notices,
        samples: readings.into_iter().map(|r| r.diagnostic).collect(),
    }
}
