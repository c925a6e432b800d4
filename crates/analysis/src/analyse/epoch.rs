//! Intervals of constant magnetism, and the fit of each.

use super::one_course::open_along;
use super::reading::Reading;
use super::reading::heading_reading;
use crate::estimate::{Prior, unseen_sd_nt};
use crate::fit::{
    HeadingReading, Observation, REJECTED_BELOW, RobustFit, RobustOptions, fit_known_ship,
    fit_robust, refer,
};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::Model;
use binnacle_compass::result::{Cause, Epoch, FitError, ReferenceCheck, SampleReason};
use binnacle_compass::ship::PARAMETERS;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// As many times as large as what has been seen a step that was no strike may be in what has
/// not been.
const BEYOND_SEEN: f64 = 1.2;
/// Rounds in which a prior is widened to what its model says: the first may be far too
/// narrow.
const WIDENINGS: usize = 2;
/// By how much a compass's zero may have moved, standard deviation in degrees.
const ZERO_MOVED_DEG: f64 = 5.0;
/// And what of a step may go with it unseen, standard deviation of bx and by in nT: the
/// headings sailed by when it is told are few.
const BESIDE_ZERO_NT: f64 = 300.0;

/// The epochs that the logbook tells of, in order of time and without gaps.
pub(super) fn epochs(logbook: &[LogbookEntry]) -> Vec<Epoch> {
    let mut boundaries: Vec<(Timestamp, LogbookKind)> = logbook
        .iter()
        .filter(|entry| entry.kind.ends_an_epoch())
        .map(|entry| (entry.from, entry.kind))
        .collect();
    boundaries.sort_unstable();
    boundaries.dedup_by_key(|(time, _)| *time);
    let mut epochs = vec![empty_epoch(None, None)];
    for (time, kind) in boundaries {
        if let Some(last) = epochs.last_mut() {
            last.to = Some(time);
        }
        epochs.push(empty_epoch(Some(time), Some(kind)));
    }
    epochs
}

pub(super) fn empty_epoch(from: Option<Timestamp>, begun_by: Option<LogbookKind>) -> Epoch {
    Epoch {
        from,
        to: None,
        begun_by,
        begun_by_change: None,
        resumes: None,
        data_from: None,
        data_until: None,
        references: None,
        noise: None,
        model: None,
        refusal: None,
    }
}

/// What the epoch before tells of this one: nothing after correctors or the
/// compass itself were moved, for then everything may be another.
pub(super) fn prior(
    epoch: &Epoch,
    before: Option<&Epoch>,
    reference_constant_sd_deg: f64,
) -> Prior {
    let preserves_soft_iron = match epoch.begun_by {
        Some(kind) => kind.preserves_soft_iron(),
        None => epoch.begun_by_change.is_some(),
    };
    before
        .filter(|_| preserves_soft_iron)
        .and_then(|before| {
            let stood_in_it = before.references.as_ref()?.constant_sd_deg;
            let model = before.model.as_ref()?;
            let mut upset = Prior::after_upset(model, stood_in_it)?;
            if epoch.begun_by_change == Some(Cause::Alignment) {
                // The ship is the magnet that she was, but for the small step that would
                // pass for part of it.
                let constant = upset.covariance[PARAMETERS][PARAMETERS];
                upset.covariance = model.covariance?;
                for j in [0, 2] {
                    upset.covariance[j][j] += BESIDE_ZERO_NT.powi(2);
                }
                upset.covariance[PARAMETERS][PARAMETERS] = constant + ZERO_MOVED_DEG.powi(2);
            }
            Some(upset)
        })
        .unwrap_or_else(|| Prior::population(reference_constant_sd_deg))
}

/// The readings of one epoch of the logbook held against their references, once:
/// parts of it have the same reference, so that a change between them is the ship's.
pub(super) struct Reference {
    /// For each reading of the epoch, in order; none where there was no reference
    /// or none to be believed.
    pub(super) observations: Vec<Option<Observation>>,
    pub(super) check: ReferenceCheck,
}

/// Holds readings against their references.
pub(super) fn reference(
    readings: &[Reading],
    one_constant_sd_deg: f64,
) -> Result<Reference, FitError> {
    let has_reference = |r: &Reading| r.sample().gyro.or(r.sample().satellite).is_some();
    if !readings.is_empty() && !readings.iter().any(has_reference) {
        return Err(FitError::NoReference {
            readings: readings.len() as u64,
        });
    }
    let mut known: Vec<HeadingReading> = Vec::with_capacity(readings.len());
    known.extend(readings.iter().filter_map(heading_reading));
    let referred = refer(&known, one_constant_sd_deg)?;
    let mut observed = referred.observations.into_iter();
    let observations = readings
        .iter()
        .map(|reading| heading_reading(reading).and_then(|_| observed.next().flatten()));
    Ok(Reference {
        observations: observations.collect(),
        check: referred.check,
    })
}

/// Says of every reading with a reference that no model can be had of it.
pub(super) fn refuse(epoch: &mut Epoch, readings: &mut [Reading], refusal: FitError) {
    epoch.data_from = readings.first().map(|r| r.sample().time);
    epoch.data_until = readings.last().map(|r| r.sample().time);
    let referred = readings.iter_mut().filter(|r| heading_reading(r).is_some());
    for reading in referred {
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.or(Some(SampleReason::ReferenceFailed));
    }
    epoch.refusal = Some(refusal);
}

/// What an epoch's model is fitted to: places among the readings of one epoch of
/// the logbook.
pub(super) struct Stretch<'a> {
    /// Those of earlier epochs in which the ship was the same.
    pub(super) earlier: Vec<Range<usize>>,
    pub(super) own: Range<usize>,
    pub(super) prior: Prior,
    /// Whether the prior is of this very ship.
    pub(super) is_known: bool,
    /// Whether she was struck since: by what size, only the courses that show it tell.
    pub(super) is_struck: bool,
    /// Whether her compass's zero moved.
    pub(super) is_turned: bool,
    pub(super) reference: &'a Reference,
}

/// Fits an epoch's model, and notes in each of its own readings what became of it.
pub(super) fn fit_epoch(epoch: &mut Epoch, readings: &mut [Reading], stretch: &Stretch<'_>) {
    let reference = stretch.reference;
    let own = &stretch.own;
    epoch.references = Some(reference.check);
    epoch.data_from = readings[own.clone()].first().map(|r| r.sample().time);
    epoch.data_until = readings[own.clone()].last().map(|r| r.sample().time);
    for index in own.clone() {
        let is_referred = heading_reading(&readings[index]).is_some();
        let diagnostic = &mut readings[index].diagnostic;
        match &reference.observations[index] {
            Some(observation) => {
                diagnostic.deviation_deg = Some(observation.deviation.degrees_east());
            }
            None if is_referred => {
                diagnostic.reason = diagnostic.reason.or(Some(SampleReason::ReferenceFailed));
            }
            None => {}
        }
    }
    let (taken, fitted) = stretch.fit(readings);
    match fitted {
        Ok(fit) => {
            note(&fit, &taken, own, readings);
            epoch.noise = Some(fit.noise);
            epoch.model = Some(stretch.count(fit.model));
        }
        Err(refusal) => {
            for index in taken.into_iter().filter(|index| own.contains(index)) {
                readings[index].diagnostic.reason = Some(SampleReason::NoModel);
            }
            epoch.refusal = Some(refusal);
        }
    }
}

impl Stretch<'_> {
    /// The fit, and the places of what it was given.
    fn fit(&self, readings: &[Reading]) -> (Vec<usize>, Result<RobustFit, FitError>) {
        let (taken, observations) = self.taken(readings);
        let mut options = RobustOptions {
            prior: self.prior.clone(),
            reference_constant_sd_deg: self.reference.check.constant_sd_deg,
        };
        if !self.is_known {
            return (taken, fit_robust(&observations, &options));
        }
        let mut fitted = fit_known_ship(&observations, &options);
        // A ship that was struck so hard as the headings so far show may have been struck as
        // hard in what they do not show.
        for _ in 0..WIDENINGS {
            let Some(wider) = fitted.as_ref().ok().and_then(|f| self.wider(&f.model)) else {
                break;
            };
            options.prior = wider;
            fitted = fit_known_ship(&observations, &options);
        }
        if let Ok(fit) = &mut fitted
            && self.is_struck
        {
            let known = options.prior.covariance;
            let unseen_nt = known[0][0].max(known[2][2]).sqrt();
            open_along(fit, &observations, unseen_nt);
        }
        (taken, fitted)
    }

    /// A prior that allows for a step of bx and by as large as the model has, each, or, of a
    /// strike, as large as it may yet be, of a compass turned as far as that has it; none
    /// where the stretch's own does.
    fn wider(&self, model: &Model) -> Option<Prior> {
        let mut prior = self.prior.clone();
        if self.is_turned {
            prior = prior.by_turned_compass(model.constant_deg - prior.mean[PARAMETERS]);
        }
        let now = model.parameters_over_lambda.to_array();
        let moved = |j: usize| now[j] - prior.mean[j];
        let seen = moved(0).hypot(moved(2));
        let size = if self.is_struck {
            unseen_sd_nt(seen)
        } else {
            BEYOND_SEEN * seen
        };
        let mut is_new = self.is_turned;
        for j in [0, 2] {
            let variance = &mut prior.covariance[j][j];
            is_new |= size * size > *variance;
            *variance = variance.max(size * size);
        }
        is_new.then_some(prior)
    }

    /// The model alone.
    pub(super) fn model(&self, readings: &[Reading]) -> Option<Model> {
        let (_, fitted) = self.fit(readings);
        fitted.ok().map(|fit| self.count(fit.model))
    }

    /// Samples that were not offered to the fit are rejected, too.
    fn count(&self, mut model: Model) -> Model {
        let earlier = self.earlier.iter().map(ExactSizeIterator::len);
        let offered = earlier.sum::<usize>() + self.own.len();
        model.samples_rejected = offered as u64 - model.samples_used;
        model
    }

    /// The places and observations of the readings that a fit may take.
    fn taken(&self, readings: &[Reading]) -> (Vec<usize>, Vec<Observation>) {
        let all = self.earlier.iter().cloned().flatten();
        all.chain(self.own.clone())
            .filter_map(|index| {
                let usable = match readings[index].diagnostic.reason {
                    None => true,
                    // An earlier fit may have doubted it; this one judges for itself.
                    Some(SampleReason::Outlier) => !self.own.contains(&index),
                    Some(_) => false,
                };
                let observation = self.reference.observations[index].filter(|_| usable)?;
                Some((index, observation))
            })
            .unzip()
    }
}

fn note(fit: &RobustFit, taken: &[usize], own: &Range<usize>, readings: &mut [Reading]) {
    for (&index, row) in taken.iter().zip(&fit.rows) {
        if !own.contains(&index) {
            continue;
        }
        let diagnostic = &mut readings[index].diagnostic;
        diagnostic.residual_deg = row.residual_deg;
        diagnostic.predicted_deg = diagnostic
            .deviation_deg
            .zip(row.residual_deg)
            .map(|(measured, residual)| measured - residual);
        diagnostic.weight = row.weight;
        diagnostic.used = row.weight >= REJECTED_BELOW;
        if !diagnostic.used {
            diagnostic.reason = Some(SampleReason::Outlier);
        }
    }
}
