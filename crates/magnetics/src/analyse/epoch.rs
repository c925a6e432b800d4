//! Intervals of constant magnetism, and the fit of each.

use super::logbook::{LogbookEntry, LogbookKind};
use super::reading::Reading;
use super::settings::AnalysisSettings;
use super::{Epoch, SampleReason};
use crate::estimate::Prior;
use crate::fit::{HeadingReading, REJECTED_BELOW, RobustFit, RobustOptions, fit_robust, refer};
use crate::model::Model;
use crate::time::Timestamp;

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

fn empty_epoch(from: Option<Timestamp>, begun_by: Option<LogbookKind>) -> Epoch {
    Epoch {
        from,
        to: None,
        begun_by,
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
fn prior(epoch: &Epoch, before: Option<&Model>, reference_constant_sd_deg: f64) -> Prior {
    let upset = match epoch.begun_by {
        Some(kind) if kind.leaves_the_iron() => {
            before.and_then(|model| Prior::after_upset(model, reference_constant_sd_deg))
        }
        _ => None,
    };
    upset.unwrap_or_else(|| Prior::population(reference_constant_sd_deg))
}

/// Fits an epoch's model to its readings and notes in each what became of it;
/// `before` is the model of the epoch before.
pub(super) fn fit_epoch(
    epoch: &mut Epoch,
    before: Option<&Model>,
    readings: &mut [Reading],
    settings: &AnalysisSettings,
) {
    epoch.data_from = readings.first().map(|r| r.sample.time);
    epoch.data_until = readings.last().map(|r| r.sample.time);
    let (indices, heading_readings): (Vec<usize>, Vec<HeadingReading>) = readings
        .iter()
        .enumerate()
        .filter_map(|(index, reading)| Some((index, heading_reading(reading)?)))
        .unzip();
    let referred = match refer(&heading_readings, settings.reference_constant_sd_deg) {
        Ok(referred) => referred,
        Err(refusal) => {
            for index in indices {
                let reason = &mut readings[index].diagnostic.reason;
                *reason = reason.or(Some(SampleReason::ReferenceFailed));
            }
            epoch.refusal = Some(refusal);
            return;
        }
    };
    epoch.references = Some(referred.check);

    let mut taken = Vec::new();
    let mut observations = Vec::new();
    for (index, observation) in indices.into_iter().zip(referred.observations) {
        let diagnostic = &mut readings[index].diagnostic;
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
        prior: prior(epoch, before, referred.check.constant_sd_deg),
        reference_constant_sd_deg: referred.check.constant_sd_deg,
    };
    match fit_robust(&observations, &options) {
        Ok(fit) => {
            note(&fit, &taken, readings);
            let mut model = fit.model;
            model.samples_rejected = readings.len() as u64 - model.samples_used;
            epoch.model = Some(model);
            epoch.noise = Some(fit.noise);
        }
        Err(refusal) => {
            for index in taken {
                readings[index].diagnostic.reason = Some(SampleReason::NoModel);
            }
            epoch.refusal = Some(refusal);
        }
    }
}

/// What the reading says of headings; none without a reference or a field.
fn heading_reading(reading: &Reading) -> Option<HeadingReading> {
    let sample = &reading.sample;
    let (variation, earth) = reading.variation.zip(reading.earth)?;
    if reading.gyro.is_none() && sample.satellite.is_none() {
        return None;
    }
    Some(HeadingReading {
        time: Some(sample.time),
        position: Some(sample.position),
        compass: sample.compass,
        gyro: reading.gyro,
        satellite: sample.satellite,
        unnamed: None,
        variation,
        h_nt: earth.h_nt,
        z_nt: earth.z_nt,
        sog_kn: sample.sog_kn,
        windows: sample.windows,
        weight: 1.0,
    })
}

fn note(fit: &RobustFit, taken: &[usize], readings: &mut [Reading]) {
    for (&index, row) in taken.iter().zip(&fit.rows) {
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
