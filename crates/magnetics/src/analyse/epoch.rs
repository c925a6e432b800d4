//! Intervals of constant magnetism, and the fit of each.

use super::logbook::{LogbookEntry, LogbookKind};
use super::reading::Reading;
use super::reading::heading_reading;
use super::settings::AnalysisSettings;
use super::{Epoch, SampleReason};
use crate::estimate::Prior;
use crate::fit::{
    HeadingReading, REJECTED_BELOW, RobustFit, RobustOptions, fit_known_ship, fit_robust, refer,
};
use crate::model::Model;
use crate::time::Timestamp;
use std::ops::Range;

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
    before: Option<&Model>,
    reference_constant_sd_deg: f64,
) -> Prior {
    let leaves_the_iron = match epoch.begun_by {
        Some(kind) => kind.leaves_the_iron(),
        None => epoch.begun_by_change.is_some(),
    };
    before
        .filter(|_| leaves_the_iron)
        .and_then(|model| Prior::after_upset(model, reference_constant_sd_deg))
        .unwrap_or_else(|| Prior::population(reference_constant_sd_deg))
}

/// Fits an epoch's model to the readings in `own`, and those in `earlier` in which
/// the ship was the same, and notes in each of its own what became of it; `before`
/// is the model of the epoch before.
pub(super) fn fit_epoch(
    epoch: &mut Epoch,
    before: Option<&Model>,
    readings: &mut [Reading],
    (earlier, own): (&[Range<usize>], Range<usize>),
    settings: &AnalysisSettings,
) {
    epoch.data_from = readings[own.clone()].first().map(|r| r.sample.time);
    epoch.data_until = readings[own.clone()].last().map(|r| r.sample.time);
    let all = earlier.iter().cloned().flatten().chain(own.clone());
    let (indices, heading_readings): (Vec<usize>, Vec<HeadingReading>) = all
        .filter_map(|index| Some((index, heading_reading(&readings[index])?)))
        .unzip();
    let referred = match refer(&heading_readings, settings.reference_constant_sd_deg) {
        Ok(referred) => referred,
        Err(refusal) => {
            for index in indices.into_iter().filter(|index| own.contains(index)) {
                let reason = &mut readings[index].diagnostic.reason;
                *reason = reason.or(Some(SampleReason::ReferenceFailed));
            }
            epoch.refusal = Some(refusal);
            return;
        }
    };
    let constant_sd_deg = referred.check.constant_sd_deg;
    epoch.references = Some(referred.check);

    let mut taken = Vec::new();
    let mut observations = Vec::new();
    for (index, observation) in indices.into_iter().zip(referred.observations) {
        let diagnostic = &mut readings[index].diagnostic;
        if !own.contains(&index) {
            // An earlier fit may have doubted it; this one judges for itself.
            let usable = matches!(diagnostic.reason, None | Some(SampleReason::Outlier));
            if let Some(observation) = observation.filter(|_| usable) {
                taken.push(index);
                observations.push(observation);
            }
            continue;
        }
        let Some(observation) = observation else {
            diagnostic.reason = diagnostic.reason.or(Some(SampleReason::ReferenceFailed));
            continue;
        };
        diagnostic.deviation_deg = Some(observation.deviation.degrees_east());
        if diagnostic.reason.is_none() {
            taken.push(index);
            observations.push(observation);
        }
    }
    let options = RobustOptions {
        prior: prior(epoch, before, constant_sd_deg),
        reference_constant_sd_deg: constant_sd_deg,
    };
    let fitted = if epoch.begun_by_change.is_some() && before.is_some() {
        fit_known_ship(&observations, &options)
    } else {
        fit_robust(&observations, &options)
    };
    match fitted {
        Ok(fit) => {
            note(&fit, &taken, &own, readings);
            let mut model = fit.model;
            let offered = earlier.iter().map(ExactSizeIterator::len).sum::<usize>() + own.len();
            model.samples_rejected = offered as u64 - model.samples_used;
            epoch.model = Some(model);
            epoch.noise = Some(fit.noise);
        }
        Err(refusal) => {
            for index in taken.into_iter().filter(|index| own.contains(index)) {
                readings[index].diagnostic.reason = Some(SampleReason::NoModel);
            }
            epoch.refusal = Some(refusal);
        }
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
