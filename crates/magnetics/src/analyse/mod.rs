//! The whole analysis of one compass: from its samples and the ship's logbook
//! to epochs and their models.
//!
//! What always holds: [`analyse`] is a pure function. The order of the samples
//! and repeated samples change nothing, to the last bit; no sample is lost
//! without a reason; and a set of samples that does not carry a model yields a
//! refusal that says what is missing.

mod changes;
mod either;
mod epoch;
mod logbook;
mod reading;
mod settings;
mod stuck;

pub use crate::fit::GyroSpeedError;
pub use logbook::{Cargo, LogbookEntry, LogbookError, LogbookKind};
pub use settings::AnalysisSettings;

use crate::change::{Cause, CauseProbability, Change};
use crate::coverage::{Coverage, coverage};
use crate::estimate::NoiseLevels;
use crate::fit::{FitError, ReferenceCheck};
use crate::model::Model;
use crate::position::Position;
use crate::sample::Sample;
use crate::time::Timestamp;
use changes::{Begun, Ended, Found, Known, find, sharpen};
use either::either;
use epoch::{Reference, Stretch, empty_epoch, epochs, fit_epoch, prior, reference, refuse};
use reading::{Reading, readings};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use stuck::mark_stuck;

/// The name of the estimator behind [`analyse`], to be kept with its models.
/// It changes whenever the same input may lead to another model.
pub const ESTIMATOR: &str = "state-space-16";

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
    /// Taken alongside.
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
    let mut course = Course {
        changes: mark_stuck(&mut readings),
        ..Course::default()
    };
    let mut begun = None;
    for epoch in epochs(logbook) {
        let from = begun.or(epoch.from);
        begun = course.follow(Epoch { from, ..epoch }, &mut readings, logbook, settings);
    }
    let Course {
        epochs,
        mut changes,
        ..
    } = course;
    changes.sort_by_key(|change| (change.from, change.detected_at));
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
        samples: readings.into_iter().map(|r| r.diagnostic).collect(),
    }
}

/// Whether an epoch is one of the ship with her cargo on board: it began with the cargo, or
/// with something else while she was laden and has been so for the most of it. Without
/// these readings nothing would be known of her as she sails.
fn is_laden(epoch: &Epoch, own: &[Reading]) -> bool {
    if epoch.resumes.is_some() {
        return false;
    }
    if epoch.begun_by_change == Some(Cause::MagneticCargo) {
        return true;
    }
    let with_reason = |reason: Option<SampleReason>| {
        let such = own.iter().filter(|r| r.diagnostic.reason == reason);
        such.count()
    };
    epoch.begun_by_change.is_some()
        && with_reason(Some(SampleReason::MagneticCargo)) > with_reason(None)
}

/// The epochs so far, with the readings of each.
#[derive(Default)]
struct Course {
    epochs: Vec<Epoch>,
    /// Places among those of the epoch of the logbook.
    ranges: Vec<Range<usize>>,
    changes: Vec<Change>,
}

impl Course {
    /// One epoch of the logbook, with the changes that its samples show. Where the samples
    /// show that it ended earlier than the logbook says, that time.
    fn follow(
        &mut self,
        epoch: Epoch,
        readings: &mut [Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let place = |time: Timestamp| readings.partition_point(|r| r.sample().time < time);
        let begin = epoch.from.map_or(0, place);
        let end = epoch.to.map_or(readings.len(), place);
        let one_sd_deg = settings.reference_constant_sd_deg;
        let expected = self.expect(&epoch, begin, end);
        let first = self.epochs.len();
        let own = &mut readings[begin..end];
        match reference(own, one_sd_deg) {
            Ok(reference) => {
                let before = self.epochs.last();
                let known = Known {
                    prior: &prior(&epoch, before, one_sd_deg),
                    levels: before.and_then(|before| before.noise.as_ref()),
                };
                let found = find(own, &reference, logbook, &known);
                let late = epoch.to.and_then(|said| found.reported_late(said));
                if let Some(at) = late.filter(|at| epoch.from.is_none_or(|from| from < *at)) {
                    let to = Some(at);
                    let earlier = self.follow(Epoch { to, ..epoch }, readings, logbook, settings);
                    return earlier.or(late);
                }
                self.split(epoch, found, own, &reference);
            }
            Err(refusal) => {
                let mut epoch = epoch;
                refuse(&mut epoch, own, refusal);
                self.push(epoch, 0..own.len());
            }
        }
        if let Some(mut change) = expected {
            let sides = first.checked_sub(1).map(|i| &self.epochs[i]);
            if let Some((old, new)) = sides.zip(self.epochs.get(first)) {
                sharpen(&mut change, old, new, readings);
            }
            self.changes.push(change);
        }
        None
    }

    /// Fits the parts into which changes divide an epoch of the logbook.
    fn split(
        &mut self,
        mut epoch: Epoch,
        mut found: Found,
        readings: &mut [Reading],
        reference: &Reference,
    ) {
        let until = epoch.to;
        let boundaries = std::mem::take(&mut found.boundaries);
        // The epoch in which each change happened.
        let mut happened_in = vec![None; found.changes.len()];
        let mut from = 0;
        for boundary in boundaries {
            let at = boundary.at;
            let is_later = epoch.from.is_none_or(|begun| begun < at);
            if !is_later || until.is_some_and(|until| until <= at) {
                continue;
            }
            let to = readings.partition_point(|r| r.sample().time < at).max(from);
            let mut next = empty_epoch(Some(at), None);
            next.begun_by_change = Some(found.changes[boundary.change].cause);
            epoch.to = Some(at);
            self.add(epoch, from..to, readings, reference);
            if boundary.resumes {
                next.resumes = happened_in[boundary.change];
            } else {
                happened_in[boundary.change] = Some(self.epochs.len() - 1);
            }
            (epoch, from) = (next, to);
        }
        epoch.to = until;
        self.add(epoch, from..readings.len(), readings, reference);
        if let Some(ended) = &found.perhaps {
            let base = happened_in[ended.change];
            self.allow_for_end(ended, base, readings, reference);
        }
        for (change, happened_in) in found.changes.iter_mut().zip(happened_in) {
            let sides = happened_in.and_then(|i| self.epochs.get(i).zip(self.epochs.get(i + 1)));
            if let Some((old, new)) = sides {
                sharpen(change, old, new, readings);
            }
        }
        if let Some(begun) = found.unnoticed.as_ref().filter(|_| until.is_none()) {
            self.allow_for_change(begun, readings, reference);
        }
        self.changes.append(&mut found.changes);
    }

    /// Fits one more epoch, together with the one that it resumes.
    fn add(
        &mut self,
        mut epoch: Epoch,
        own: Range<usize>,
        readings: &mut [Reading],
        reference: &Reference,
    ) {
        if is_laden(&epoch, &readings[own.clone()]) {
            // They tell of nothing but the ship with her cargo: of this epoch.
            for reading in &mut readings[own.clone()] {
                let reason = &mut reading.diagnostic.reason;
                *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo);
            }
        }
        let stretch = self.stretch(&epoch, own.clone(), reference);
        fit_epoch(&mut epoch, readings, &stretch);
        self.push(epoch, own);
    }

    /// Widens the last epoch's model where the ship may be again as she was in the
    /// epoch `base`.
    fn allow_for_end(
        &mut self,
        ended: &Ended,
        base: Option<usize>,
        readings: &[Reading],
        reference: &Reference,
    ) {
        let resumed = Epoch {
            resumes: base,
            ..empty_epoch(Some(ended.at), None)
        };
        let from = readings.partition_point(|r| r.sample().time < ended.at);
        let mut stretch = self.stretch(&resumed, 0..0, reference);
        // As earlier ones: what does not fit the ship with cargo may fit her without.
        stretch.earlier.push(from..readings.len());
        let base = base.and_then(|_| stretch.model(readings));
        let laden = self.epochs.last().and_then(|epoch| epoch.model.as_ref());
        let open = base
            .zip(laden)
            .and_then(|(base, laden)| either(laden, &base, ended.probability));
        if let Some(last) = self.epochs.last_mut().filter(|_| open.is_some()) {
            last.model = open;
        }
    }

    /// Widens the last epoch's model where the ship may be another since a port call.
    fn allow_for_change(&mut self, begun: &Begun, readings: &[Reading], reference: &Reference) {
        let changed = Epoch {
            begun_by_change: Some(Cause::Unknown),
            ..empty_epoch(Some(begun.at), None)
        };
        let from = readings.partition_point(|r| r.sample().time < begun.at);
        let stretch = self.stretch(&changed, from..readings.len(), reference);
        let now = self.epochs.last().and_then(|epoch| epoch.model.as_ref());
        let open = stretch
            .model(readings)
            .zip(now)
            .and_then(|(changed, now)| either(now, &changed, begun.probability));
        if let Some(last) = self.epochs.last_mut().filter(|_| open.is_some()) {
            last.model = open;
        }
    }

    /// What an epoch that follows the last is to be fitted to.
    fn stretch<'a>(
        &self,
        epoch: &Epoch,
        own: Range<usize>,
        reference: &'a Reference,
    ) -> Stretch<'a> {
        let mut earlier = Vec::new();
        let mut root = None;
        let mut same = epoch.resumes;
        while let Some(place) = same {
            earlier.insert(0, self.ranges[place].clone());
            root = Some(place);
            same = self.epochs[place].resumes;
        }
        // What was known before the first of the epochs in which she was the same.
        let (first, before) = match root {
            Some(root) => (&self.epochs[root], root.checked_sub(1)),
            None => (epoch, self.epochs.len().checked_sub(1)),
        };
        // One that was too short for a model tells nothing; the one before it does.
        let before = before.and_then(|last| {
            let mut back = self.epochs[..=last].iter().rev();
            back.find(|epoch| epoch.model.is_some() || epoch.begun_by_change.is_none())
        });
        Stretch {
            earlier,
            own,
            prior: prior(first, before, reference.check.constant_sd_deg),
            is_known: first.begun_by_change.is_some() && before.is_some_and(|b| b.model.is_some()),
            reference,
        }
    }

    fn push(&mut self, epoch: Epoch, own: Range<usize>) {
        self.epochs.push(epoch);
        self.ranges.push(own);
    }

    /// The change that the logbook tells of where an epoch begins, if there are
    /// samples on both sides.
    fn expect(&self, epoch: &Epoch, begin: usize, end: usize) -> Option<Change> {
        let (at, kind) = (epoch.from?, epoch.begun_by?);
        let has_before = self.ranges.last().is_some_and(|range| !range.is_empty());
        (has_before && begin < end).then(|| Change {
            from: at,
            from_earliest: at,
            from_latest: at,
            detected_at: at,
            confirmed: true,
            cause: Cause::AdjustmentOrRepair,
            causes: vec![CauseProbability {
                cause: Cause::AdjustmentOrRepair,
                probability: 1.0,
            }],
            evidence: vec![format!("the logbook says so: {}", kind.in_words())],
            deviation_change_deg: None,
            step: None,
            ended: None,
        })
    }
}
