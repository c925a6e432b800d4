//! Diagnosis of each sample: its deviation, the reason against its use, and the outcome by its
//! epoch's model.

use super::faults::{Faults, Trust};
use super::references::References;
use super::voyage::TrackedRow;
use binnacle_analysis::analyse::reading::{Reading, heading_reading};
use binnacle_analysis::estimate::weight;
use binnacle_analysis::fit::{Observation, REJECTED_BELOW};
use binnacle_compass::angle::{Deviation, wrap_180};
use binnacle_compass::model::Model;
use binnacle_compass::result::{NoiseLevels, SampleReason};

/// Horizontal field for which errors of the variation are given, nT.
const USUAL_H_NT: f64 = 24_000.0;

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

/// Returns a reading with a reference as an observation.
pub(super) fn observation(reading: &Reading) -> Option<Observation> {
    let read = heading_reading(reading)?;
    let gyro_share = f64::from(u8::from(read.gyro.is_some()));
    Some(Observation {
        time: read.time,
        position: read.position,
        compass: read.compass,
        deviation: Deviation::new(reading.diagnostic.deviation_deg?)?,
        variation: read.variation,
        h_nt: read.h_nt,
        z_nt: read.z_nt,
        gyro_share,
        gyro_less_satellite_deg: read
            .gyro
            .zip(read.satellite)
            .map(|(gyro, satellite)| wrap_180(gyro.degrees() - satellite.degrees())),
        sog_kn: read.sog_kn,
        windows: read.windows,
        spread_deg: read.spread_deg,
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
    let weight = weight(row.z_squared.min(residual_deg * residual_deg / variance));
    let diagnostic = &mut reading.diagnostic;
    diagnostic.predicted_deg = Some(predicted_deg);
    diagnostic.residual_deg = Some(residual_deg);
    diagnostic.weight = weight;
    diagnostic.used = weight >= REJECTED_BELOW;
    if !diagnostic.used {
        diagnostic.reason = Some(SampleReason::Outlier);
    }
}
