//! Diagnosis of each sample: its deviation, the reason against its use, and the outcome by its
//! epoch's model.

use super::faults::{Faults, Trust};
use super::kept::TrackedRow;
use super::references::References;
use crate::state_space::states::USUAL_H_NT;
use binnacle_analysis::estimate::weight;
use binnacle_analysis::fit::{Observation, REJECTED_BELOW};
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::angle::{Deviation, wrap_180};
use binnacle_compass::model::Model;
use binnacle_compass::result::{NoiseLevels, SampleReason};

/// Records in each reading its deviation, and the reason of a fault that spoils it.
pub(super) fn record_faults(readings: &mut [Reading], references: &References, faults: &Faults) {
    for (place, reading) in readings.iter_mut().enumerate() {
        let trust: Trust = faults.trust(reading.sample().time);
        let deviation_deg = references.deviation_deg(place, reading, trust);
        reading.diagnostic.deviation_deg = deviation_deg;
        if deviation_deg.is_some() && reading.diagnostic.reason.is_none() {
            reading.diagnostic.reason = faults.reason(reading);
        }
    }
}

/// Returns a reading with a deviation as an observation.
pub(super) fn observation(reading: &Reading) -> Option<Observation> {
    let sample = reading.sample();
    let (variation, earth) = reading.variation.zip(reading.earth)?;
    Some(Observation {
        time: Some(sample.time),
        position: Some(sample.position),
        compass: sample.compass,
        deviation: Deviation::new(reading.diagnostic.deviation_deg?)?,
        variation,
        h_nt: earth.h_nt,
        z_nt: earth.z_nt,
        gyro_share: f64::from(u8::from(reading.gyro.is_some())),
        gyro_less_satellite_deg: reading
            .gyro
            .zip(sample.satellite)
            .map(|(gyro, satellite)| wrap_180(gyro.degrees() - satellite.degrees())),
        sog_kn: sample.sog_kn,
        windows: sample.windows,
        spread_deg: sample.spread_deg,
        weight: 1.0,
    })
}

/// Records the outcome of a row by its epoch's model.
///
/// A reading is an outlier only where both the filter of its time and the later model say so:
/// the filter did not know yet of an event that was dated back, and the model does not follow
/// the slow errors of its time.
pub(super) fn record_outcome(
    reading: &mut Reading,
    row: &TrackedRow,
    model: &Model,
    noise: &NoiseLevels,
) {
    let compass = reading.sample().compass;
    let predicted = reading
        .earth
        .and_then(|earth| Some((model.deviation(compass, earth).ok()?, earth)));
    let Some(((predicted, earth), measured_deg)) = predicted.zip(reading.diagnostic.deviation_deg)
    else {
        reading.diagnostic.reason = Some(SampleReason::Outlier);
        return;
    };
    let predicted_deg = predicted.deviation.degrees_east();
    let residual_deg = wrap_180(measured_deg - predicted_deg);
    let band = predicted.standard_error_deg.unwrap_or(0.0);
    let by_h = USUAL_H_NT / earth.h_nt;
    let variance = band * band + noise.row_variance() * by_h.max(1.0).powi(2);
    let weight = weight(f64::from(row.z_squared).min(residual_deg * residual_deg / variance));
    let diagnostic = &mut reading.diagnostic;
    diagnostic.predicted_deg = Some(predicted_deg);
    diagnostic.residual_deg = Some(residual_deg);
    diagnostic.weight = weight;
    diagnostic.used = weight >= REJECTED_BELOW;
    if !diagnostic.used {
        diagnostic.reason = Some(SampleReason::Outlier);
    }
}
