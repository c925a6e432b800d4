//! Samples taken alongside, and what the quay's steel does to them.
//!
//! What always holds: a ship that lies still on one heading tells nothing of herself alone,
//! so that such samples are of no model and no change is dated among them; what was astray
//! there and is gone when she has sailed is told as the berth's.

use super::reading::{Reading, heading_reading};
use crate::change::{Circumstances, EventKind, causes};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Model;
use binnacle_compass::result::{Cause, Change, Epoch, SampleReason};
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// A ship that makes no more way than this lies somewhere, knots.
const LIES_KN: f64 = 1.0;
/// She lies alongside if she stays within this of where she came to lie, nautical miles, and
/// heads no further from her heading then, degrees: at anchor she swings.
const STAYS_NM: f64 = 0.1;
const STAYS_DEG: f64 = 3.0;
/// For so long at least, seconds, and so many samples.
const STAYS_S: f64 = 3600.0;
const STAYS_SAMPLES: usize = 4;
/// How far the mean of one stay is off where there is no steel, standard deviation in
/// degrees: slow errors of the references, and the chart's variation among harbours' iron.
const USUAL_DEG: f64 = 0.7;
/// What is off by more, in standard errors, is told.
const TOLD_SD: f64 = 3.0;
/// Where H is this, degrees are told as they are.
const USUAL_H_NT: f64 = 24_000.0;

/// Marks the samples that were taken alongside; each stay.
pub(super) fn mark_alongside(readings: &mut [Reading]) -> Vec<Range<usize>> {
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

/// How many readings from the first on are of a ship that lies as she lay then.
fn staying(readings: &[Reading]) -> usize {
    let lies = |reading: &Reading| {
        let sog_kn = reading.sample().sog_kn;
        let is_said = reading.diagnostic.reason == Some(SampleReason::Berth);
        is_said || sog_kn.is_some_and(|kn| kn < LIES_KN)
    };
    let left = |reading: &Reading| {
        !lies(reading)
            || miles(&readings[0], reading) > STAYS_NM
            || turned_deg(&readings[0], reading).is_none_or(|deg| deg > STAYS_DEG)
    };
    readings.iter().position(left).unwrap_or(readings.len())
}

fn is_stay(readings: &[Reading]) -> bool {
    let times = readings.first().zip(readings.last());
    let lasted_s = times.map_or(0.0, |(a, b)| b.sample().time.seconds_since(a.sample().time));
    readings.len() >= STAYS_SAMPLES && lasted_s >= STAYS_S
}

/// Nearly, for places that are not far apart.
fn miles(a: &Reading, b: &Reading) -> f64 {
    let (a, b) = (a.sample().position, b.sample().position);
    let north = a.lat_deg() - b.lat_deg();
    let east = wrap_180(a.lon_deg() - b.lon_deg()) * a.lat_deg().to_radians().cos();
    60.0 * north.hypot(east)
}

/// By a reference that was read both times.
fn turned_deg(a: &Reading, b: &Reading) -> Option<f64> {
    let (a, b) = (a.sample(), b.sample());
    let pair = a.satellite.zip(b.satellite).or(a.gyro.zip(b.gyro));
    pair.map(|(a, b)| wrap_180(b.degrees() - a.degrees()).abs())
}

/// What each stay shows of its berth, held against the ship before and after.
pub(super) fn berths(
    stays: &[Range<usize>],
    readings: &[Reading],
    epochs: &[Epoch],
    changes: &mut Vec<Change>,
) {
    let told = stays.iter().filter_map(|stay| {
        let off = least_off(stay, readings, epochs)?;
        (off.sd > TOLD_SD).then(|| tell(stay, readings, &off))
    });
    changes.extend(told);
}

/// How far a stay's samples are off.
struct Off {
    mean_deg: f64,
    usual_deg: f64,
    sd: f64,
    samples: usize,
}

/// From the ship before or after, whichever is the nearer: what changed in port is hers.
fn least_off(stay: &Range<usize>, readings: &[Reading], epochs: &[Epoch]) -> Option<Off> {
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
    let offs = models
        .into_iter()
        .map(|model| off(&readings[stay.clone()], model));
    let offs: Vec<Off> = offs.collect::<Option<_>>()?;
    offs.into_iter().min_by(|a, b| a.sd.total_cmp(&b.sd))
}

fn model_at(epochs: &[Epoch], time: Timestamp) -> Option<&Model> {
    let mut begun = epochs.iter().rev();
    let epoch = begun.find(|epoch| epoch.from.is_none_or(|from| from <= time))?;
    epoch.model.as_ref()
}

fn off(readings: &[Reading], model: &Model) -> Option<Off> {
    let each = readings.iter().filter_map(|reading| {
        let measured_deg = reading.diagnostic.deviation_deg?;
        let earth = reading.earth?;
        let told = model.deviation(reading.sample().compass, earth).ok()?;
        let off_deg = wrap_180(measured_deg - told.deviation.degrees_east());
        Some((off_deg, told.standard_error_deg?, earth.h_nt))
    });
    let each: Vec<(f64, f64, f64)> = each.collect();
    let samples = each.len();
    if samples < STAYS_SAMPLES {
        return None;
    }
    let mean = |of: fn(&(f64, f64, f64)) -> f64| each.iter().map(of).sum::<f64>() / samples as f64;
    let mean_deg = mean(|x| x.0);
    Some(Off {
        mean_deg,
        usual_deg: (mean_deg * mean(|x| x.2) / USUAL_H_NT).abs(),
        sd: mean_deg.abs() / USUAL_DEG.hypot(mean(|x| x.1)),
        samples,
    })
}

fn tell(stay: &Range<usize>, readings: &[Reading], off: &Off) -> Change {
    let time = |row: usize| readings[row].sample().time;
    let (from, last) = (time(stay.start), time(stay.end - 1));
    let own = &readings[stay.clone()];
    let has_both = |r: &Reading| r.gyro.is_some() && r.sample().satellite.is_some();
    let is_over = stay.end < readings.len();
    let nats = off.sd.powi(2) / 2.0;
    let known = Circumstances {
        // Until she has sailed it may as well be what was done to her there.
        leads: [if is_over { 0.0 } else { nats }, 0.0, nats, 0.0],
        at_port: Some(true),
        transient_s: Some(last.seconds_since(from)),
        is_over,
        alongside: true,
        disturbance_deg: Some(off.usual_deg),
        one_reference: !own.iter().any(has_both),
        ..Circumstances::default()
    };
    let causes = causes(EventKind::Transient, &known);
    let mut evidence = vec![format!(
        "alongside, the compass was off by {:.1} degrees in the mean of {} samples on one heading",
        off.mean_deg.abs(),
        off.samples
    )];
    evidence.push(if is_over {
        "before and after the ship was herself: it came with the berth and was left there"
            .to_owned()
    } else {
        "whether it is the berth's or hers will show when she has sailed".to_owned()
    });
    let referred = own
        .iter()
        .filter(|reading| heading_reading(reading).is_some());
    let told = referred
        .map(|reading| reading.sample().time)
        .nth(STAYS_SAMPLES - 1);
    Change {
        from,
        from_earliest: time(stay.start.saturating_sub(1)),
        from_latest: from,
        detected_at: told.unwrap_or(last),
        confirmed: is_over,
        withdrawn: false,
        cause: causes.first().map_or(Cause::BerthSteel, |c| c.cause),
        causes,
        evidence,
        deviation_change_deg: None,
        step: None,
        ended: is_over.then_some(last),
    }
}
