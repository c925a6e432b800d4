//! Samples taken alongside, and the influence of the quay's steel on them.
//!
//! A vessel at rest on one heading shows nothing of its own magnetism alone. Such samples
//! are in no model, and no change is dated among them. A disturbance there that is gone
//! after sailing is attributed to the berth.

use super::reading::{Reading, heading_reading};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Model;
use binnacle_compass::result::{Cause, CauseProbability, Change, Epoch, SampleReason};
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Speed below which a vessel is at rest, knots.
const AT_REST_KN: f64 = 1.0;
/// Greatest distance from the first position, nautical miles, and from the first heading,
/// degrees, of a vessel alongside: at anchor it swings.
const STAY_MAX_NM: f64 = 0.1;
const STAY_MAX_DEG: f64 = 3.0;
/// Least duration of a stay, seconds, and least number of samples.
const STAY_MIN_S: f64 = 3600.0;
const STAY_MIN_SAMPLES: usize = 4;
/// Standard deviation of a stay's mean error without steel, degrees: slow errors of the
/// references, and the chart's variation among harbours' iron.
const USUAL_ERROR_DEG: f64 = 0.7;
/// Mean error from which a stay is reported, standard errors.
const REPORTED_SD: f64 = 3.0;
/// Share of the errors alongside that are the berth's and not of cargo just loaded: quays of
/// steel are many, cargo that moves a compass is rare.
const BY_BERTH: f64 = 0.85;

/// Marks the samples taken alongside, and returns each stay.
pub fn mark_alongside(readings: &mut [Reading]) -> Vec<Range<usize>> {
    let mut stays = Vec::new();
    let mut from = 0;
    while from < readings.len() {
        let stay = from..from + staying(&readings[from..]);
        from = stay.end.max(from + 1);
        if !is_stay(&readings[stay.clone()]) {
            continue;
        }
        for reading in &mut readings[stay.clone()] {
            let reason = &mut reading.diagnostic.reason;
            *reason = reason.or(Some(SampleReason::Berth));
        }
        stays.push(stay);
    }
    stays
}

/// Returns the number of readings, from the first on, of a vessel that stays at rest.
fn staying(readings: &[Reading]) -> usize {
    let is_at_rest = |reading: &Reading| {
        let sog_kn = reading.sample().sog_kn;
        let is_logged = reading.diagnostic.reason == Some(SampleReason::Berth);
        is_logged || sog_kn.is_some_and(|kn| kn < AT_REST_KN)
    };
    let has_left = |reading: &Reading| {
        !is_at_rest(reading)
            || miles(&readings[0], reading) > STAY_MAX_NM
            || turned_deg(&readings[0], reading).is_none_or(|deg| deg > STAY_MAX_DEG)
    };
    readings.iter().position(has_left).unwrap_or(readings.len())
}

fn is_stay(readings: &[Reading]) -> bool {
    let times = readings.first().zip(readings.last());
    let lasted_s = times.map_or(0.0, |(a, b)| b.sample().time.seconds_since(a.sample().time));
    readings.len() >= STAY_MIN_SAMPLES && lasted_s >= STAY_MIN_S
}

/// Returns the distance in nautical miles, nearly, for places close together.
fn miles(a: &Reading, b: &Reading) -> f64 {
    let (a, b) = (a.sample().position, b.sample().position);
    let north = a.lat_deg() - b.lat_deg();
    let east = wrap_180(a.lon_deg() - b.lon_deg()) * a.lat_deg().to_radians().cos();
    60.0 * north.hypot(east)
}

/// Returns the turn in degrees by a reference that was read both times.
fn turned_deg(a: &Reading, b: &Reading) -> Option<f64> {
    let (a, b) = (a.sample(), b.sample());
    let pair = a.satellite.zip(b.satellite).or(a.gyro.zip(b.gyro));
    pair.map(|(a, b)| wrap_180(b.degrees() - a.degrees()).abs())
}

/// Adds the changes by berths that the stays show against the vessel before and after.
pub fn add_berth_changes(
    stays: &[Range<usize>],
    readings: &[Reading],
    epochs: &[Epoch],
    changes: &mut Vec<Change>,
) {
    let berth_changes = stays.iter().filter_map(|stay| {
        let error = smallest_error(stay, readings, epochs)?;
        (error.sd > REPORTED_SD).then(|| berth_change(stay, readings, &error))
    });
    changes.extend(berth_changes);
}

/// Mean error of a stay's samples.
struct StayError {
    mean_deg: f64,
    sd: f64,
    samples: usize,
}

/// Returns the smaller error against the models before and after: a change in port is the
/// vessel's.
fn smallest_error(
    stay: &Range<usize>,
    readings: &[Reading],
    epochs: &[Epoch],
) -> Option<StayError> {
    let before = stay.start.checked_sub(1)?;
    let sides = [
        Some(before),
        (stay.end < readings.len()).then_some(stay.end),
    ];
    let models = sides.into_iter().flatten().map(|row| {
        let time = readings[row].sample().time;
        model_at(epochs, time)
    });
    let models: Vec<&Model> = models.collect::<Option<_>>()?;
    let errors = models
        .into_iter()
        .map(|model| error(&readings[stay.clone()], model));
    let errors: Vec<StayError> = errors.collect::<Option<_>>()?;
    errors.into_iter().min_by(|a, b| a.sd.total_cmp(&b.sd))
}

fn model_at(epochs: &[Epoch], time: Timestamp) -> Option<&Model> {
    let mut begun = epochs.iter().rev();
    let epoch = begun.find(|epoch| epoch.from.is_none_or(|from| from <= time))?;
    epoch.model.as_ref()
}

fn error(readings: &[Reading], model: &Model) -> Option<StayError> {
    let errors = readings.iter().filter_map(|reading| {
        let measured_deg = reading.diagnostic.deviation_deg?;
        let earth = reading.earth?;
        let predicted = model.deviation(reading.sample().compass, earth).ok()?;
        let off_deg = wrap_180(measured_deg - predicted.deviation.degrees_east());
        Some((off_deg, predicted.standard_error_deg?))
    });
    let errors: Vec<(f64, f64)> = errors.collect();
    let samples = errors.len();
    if samples < STAY_MIN_SAMPLES {
        return None;
    }
    let mean = |of: fn(&(f64, f64)) -> f64| errors.iter().map(of).sum::<f64>() / samples as f64;
    let mean_deg = mean(|x| x.0);
    Some(StayError {
        mean_deg,
        sd: mean_deg.abs() / USUAL_ERROR_DEG.hypot(mean(|x| x.1)),
        samples,
    })
}

/// Returns the causes of an error alongside: before sailing it may as well be the vessel's.
fn causes(is_over: bool) -> Vec<CauseProbability> {
    let of_berth = if is_over { 1.0 } else { BY_BERTH };
    let causes = [
        (Cause::BerthSteel, of_berth),
        (Cause::MagneticCargo, 1.0 - of_berth),
    ];
    let likely = causes
        .into_iter()
        .filter(|(_, probability)| *probability > 0.0);
    likely
        .map(|(cause, probability)| CauseProbability { cause, probability })
        .collect()
}

fn berth_change(stay: &Range<usize>, readings: &[Reading], error: &StayError) -> Change {
    let time = |row: usize| readings[row].sample().time;
    let (from, last) = (time(stay.start), time(stay.end - 1));
    let own = &readings[stay.clone()];
    let is_over = stay.end < readings.len();
    let causes = causes(is_over);
    let mut evidence = vec![format!(
        "alongside, the compass had a mean error of {:.1} degrees in {} samples on one heading",
        error.mean_deg.abs(),
        error.samples
    )];
    evidence.push(if is_over {
        "before and after, the vessel was unchanged: the error began and ended with the berth"
            .to_owned()
    } else {
        "the samples after sailing will show whether the berth or the vessel caused it".to_owned()
    });
    let referred = own
        .iter()
        .filter(|reading| heading_reading(reading).is_some());
    let detected_at = referred
        .map(|reading| reading.sample().time)
        .nth(STAY_MIN_SAMPLES - 1);
    Change {
        from,
        from_earliest: time(stay.start.saturating_sub(1)),
        from_latest: from,
        detected_at: detected_at.unwrap_or(last),
        confirmed: is_over,
        position: None,
        disturbed_deg: None,
        withdrawn: false,
        cause: Cause::BerthSteel,
        causes,
        evidence,
        deviation_change_deg: None,
        step: None,
        ended: is_over.then_some(last),
    }
}
