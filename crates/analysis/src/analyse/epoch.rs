//! Epochs of constant magnetism, and their fits.

use super::reading::Reading;
use super::reading::heading_reading;
use super::single_heading::widen_along_needle;
use crate::estimate::{Prior, unseen_sd_nt};
use crate::fit::{
    HeadingReading, Observation, REJECTED_BELOW, RobustFit, RobustOptions, fit_known_ship,
    fit_robust, observe_readings,
};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::Model;
use binnacle_compass::result::{Cause, Epoch, FitError, ReferenceCheck, SampleReason};
use binnacle_compass::ship::PARAMETERS;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Ratio of the unseen to the seen part of a step, at most, where no strike was reported.
const BEYOND_SEEN: f64 = 1.2;
/// Rounds in which a prior is widened to its model: the first may be far too narrow.
const WIDENINGS: usize = 2;
/// Standard deviation of an alignment change, degrees.
const ZERO_MOVED_DEG: f64 = 5.0;
/// Standard deviation of bx and by of a step that may go with it unseen, nT: few headings
/// are sailed by the time of detection.
const BESIDE_ZERO_NT: f64 = 300.0;

/// Returns the epochs of the logbook, in order of time and without gaps.
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

/// Returns the prior of an epoch by the one before: none of its knowledge after correctors
/// or the compass itself were moved, because everything may have changed.
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
            let reference_sd_deg = before.references.as_ref()?.constant_sd_deg;
            let model = before.model.as_ref()?;
            let mut widened = Prior::after_jump(model, reference_sd_deg)?;
            if epoch.begun_by_change == Some(Cause::Alignment) {
                // The vessel is the same, but for a small step that would pass for part of
                // it.
                let constant = widened.covariance[PARAMETERS][PARAMETERS];
                widened.covariance = model.covariance?;
                for j in [0, 2] {
                    widened.covariance[j][j] += BESIDE_ZERO_NT.powi(2);
                }
                widened.covariance[PARAMETERS][PARAMETERS] = constant + ZERO_MOVED_DEG.powi(2);
            }
            Some(widened)
        })
        .unwrap_or_else(|| Prior::population(reference_constant_sd_deg))
}

/// Readings of one epoch of the logbook compared with their references, once. Parts of the
/// epoch share the reference, so that a change between them is the vessel's.
pub(super) struct Reference {
    /// Observation of each reading of the epoch, in order; none without a trusted
    /// reference.
    pub(super) observations: Vec<Option<Observation>>,
    pub(super) check: ReferenceCheck,
}

/// Compares readings with their references.
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
    let referred = observe_readings(&known, one_constant_sd_deg)?;
    let mut observed = referred.observations.into_iter();
    let observations = readings
        .iter()
        .map(|reading| heading_reading(reading).and_then(|_| observed.next().flatten()));
    Ok(Reference {
        observations: observations.collect(),
        check: referred.check,
    })
}

/// Marks every reading with a reference as unable to carry a model.
pub(super) fn refuse_epoch(epoch: &mut Epoch, readings: &mut [Reading], refusal: FitError) {
    epoch.data_from = readings.first().map(|r| r.sample().time);
    epoch.data_until = readings.last().map(|r| r.sample().time);
    let referred = readings.iter_mut().filter(|r| heading_reading(r).is_some());
    for reading in referred {
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.or(Some(SampleReason::ReferenceFailed));
    }
    epoch.refusal = Some(refusal);
}

/// Input of an epoch's fit: places among the readings of one epoch of the logbook.
pub(super) struct FitInput<'a> {
    /// Readings of earlier epochs with the same state.
    pub(super) earlier: Vec<Range<usize>>,
    pub(super) own: Range<usize>,
    pub(super) prior: Prior,
    /// True if the prior is of this very vessel.
    pub(super) is_known: bool,
    /// True if lightning struck it since: only the courses that show it give the size.
    pub(super) has_strike: bool,
    /// True if the compass's alignment changed.
    pub(super) is_alignment_changed: bool,
    pub(super) reference: &'a Reference,
}

/// Fits an epoch's model, and records the outcome in each of its own readings.
pub(super) fn fit_epoch(epoch: &mut Epoch, readings: &mut [Reading], fit_input: &FitInput<'_>) {
    let reference = fit_input.reference;
    let own = &fit_input.own;
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
    let (usable_observations, fitted) = fit_input.fit(readings);
    match fitted {
        Ok(fit) => {
            record_outcomes(&fit, &usable_observations, own, readings);
            epoch.noise = Some(fit.noise);
            epoch.model = Some(fit_input.count_rejected(fit.model));
        }
        Err(refusal) => {
            for index in usable_observations
                .into_iter()
                .filter(|index| own.contains(index))
            {
                readings[index].diagnostic.reason = Some(SampleReason::NoModel);
            }
            epoch.refusal = Some(refusal);
        }
    }
}

impl FitInput<'_> {
    /// Returns the fit, and the places of its readings.
    fn fit(&self, readings: &[Reading]) -> (Vec<usize>, Result<RobustFit, FitError>) {
        let (usable_observations, observations) = self.usable_observations(readings);
        let mut options = RobustOptions {
            prior: self.prior.clone(),
            reference_constant_sd_deg: self.reference.check.constant_sd_deg,
        };
        if !self.is_known {
            return (usable_observations, fit_robust(&observations, &options));
        }
        let mut fitted = fit_known_ship(&observations, &options);
        // A strike as large as the headings so far show may be as large in what they do not
        // show.
        for _ in 0..WIDENINGS {
            let Some(wider_prior) = fitted
                .as_ref()
                .ok()
                .and_then(|f| self.wider_prior(&f.model))
            else {
                break;
            };
            options.prior = wider_prior;
            fitted = fit_known_ship(&observations, &options);
        }
        if let Ok(fit) = &mut fitted
            && self.has_strike
        {
            let known = options.prior.covariance;
            let unseen_nt = known[0][0].max(known[2][2]).sqrt();
            widen_along_needle(fit, &observations, unseen_nt);
        }
        (usable_observations, fitted)
    }

    /// Returns a prior that allows for a step of bx and by as large as the model's, or, for
    /// a strike, as large as it may yet be, and for the model's alignment change; none
    /// where the own prior does.
    fn wider_prior(&self, model: &Model) -> Option<Prior> {
        let mut prior = self.prior.clone();
        if self.is_alignment_changed {
            prior = prior.with_compass_turned(model.constant_deg - prior.mean[PARAMETERS]);
        }
        let now = model.parameters_over_lambda.to_array();
        let moved = |j: usize| now[j] - prior.mean[j];
        let seen = moved(0).hypot(moved(2));
        let size = if self.has_strike {
            unseen_sd_nt(seen)
        } else {
            BEYOND_SEEN * seen
        };
        let mut is_new = self.is_alignment_changed;
        for j in [0, 2] {
            let variance = &mut prior.covariance[j][j];
            is_new |= size * size > *variance;
            *variance = variance.max(size * size);
        }
        is_new.then_some(prior)
    }

    /// Returns the model alone.
    pub(super) fn model(&self, readings: &[Reading]) -> Option<Model> {
        let (_, fitted) = self.fit(readings);
        fitted.ok().map(|fit| self.count_rejected(fit.model))
    }

    /// Counts samples that were not offered to the fit as rejected.
    fn count_rejected(&self, mut model: Model) -> Model {
        let earlier = self.earlier.iter().map(ExactSizeIterator::len);
        let offered = earlier.sum::<usize>() + self.own.len();
        model.samples_rejected = offered as u64 - model.samples_used;
        model
    }

    /// Returns the places and observations of the readings that a fit may use.
    fn usable_observations(&self, readings: &[Reading]) -> (Vec<usize>, Vec<Observation>) {
        let all = self.earlier.iter().cloned().flatten();
        all.chain(self.own.clone())
            .filter_map(|index| {
                let usable = match readings[index].diagnostic.reason {
                    None => true,
                    // An earlier fit may have rejected it: this one decides for itself.
                    Some(SampleReason::Outlier) => !self.own.contains(&index),
                    Some(_) => false,
                };
                let observation = self.reference.observations[index].filter(|_| usable)?;
                Some((index, observation))
            })
            .unzip()
    }
}

fn record_outcomes(
    fit: &RobustFit,
    usable_observations: &[usize],
    own: &Range<usize>,
    readings: &mut [Reading],
) {
    for (&index, row) in usable_observations.iter().zip(&fit.rows) {
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
