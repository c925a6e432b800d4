//! Majority vote on which of two references has failed: the magnetic compass has the third
//! vote.

use super::check::{has_failed, without_usual_difference};
use super::observe::{differences, observe};
use super::reading::{HeadingReading, Trust};
use crate::fit::{RobustFit, RobustOptions, fit_robust};
use crate::observation::Observation;
use crate::robust_scale::median;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::result::ReferenceCheck;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;

/// Time between failures up to which they are one.
const FAILURE_GAP_S: f64 = 6.0 * 3600.0;
/// Least ratio of the failed reference's error to the sound one's.
const ERROR_RATIO: f64 = 2.0;
/// Least ratio over days, in which transient errors average out.
const ERROR_RATIO_OVER_DAYS: f64 = 1.5;
/// Time before and after a stretch of days from which the vessel's model is taken.
const NEARBY_S: f64 = 30.0 * 86_400.0;
/// Length of the stretch's beginning that counts: the vessel itself does not stay the same.
const STRETCH_BEGINNING_S: f64 = 15.0 * 86_400.0;
/// Number of observations beyond which the third vote gets no better.
const ENOUGH: usize = 2000;

/// Withdraws trust from the references that failed; `order` is that of time.
pub(super) fn vote_on_failures(
    readings: &[HeadingReading],
    order: &[usize],
    check: &ReferenceCheck,
    trust: &mut [Trust],
) {
    let mut failed = vec![false; readings.len()];
    for (index, difference) in differences(readings, trust) {
        failed[index] = has_failed(check, difference);
    }
    let failures: Vec<usize> = order.iter().copied().filter(|&i| failed[i]).collect();
    if failures.is_empty() {
        return;
    }
    let sound = order.iter().copied().filter(|&i| !failed[i]);
    let every = (readings.len() - failures.len()).div_ceil(ENOUGH).max(1);
    let sound: Vec<Observation> = sound
        .step_by(every)
        .filter_map(|i| observe(&readings[i], trust[i], check))
        .collect();
    let third = fit_robust(&sound, &RobustOptions::default()).ok();
    let spells = failures.chunk_by(|&a, &b| match (readings[a].time, readings[b].time) {
        (Some(a), Some(b)) => b.seconds_since(a) < FAILURE_GAP_S,
        _ => false,
    });
    for spell in spells {
        let decision = third
            .as_ref()
            .map_or(NEITHER, |third| vote(readings, spell, check, third));
        for &index in spell {
            trust[index] = decision;
        }
    }
}

/// Withdraws trust from the reference that failed in each of these stretches of days.
pub(super) fn vote_on_stretches(
    readings: &[HeadingReading],
    order: &[usize],
    check: &ReferenceCheck,
    stretches: &[Vec<usize>],
    trust: &mut [Trust],
) {
    let mut is_apart = vec![false; readings.len()];
    for &index in stretches.iter().flatten() {
        is_apart[index] = true;
    }
    let sound: Vec<usize> = order.iter().copied().filter(|&i| !is_apart[i]).collect();
    for stretch in stretches {
        let decision = nearby(readings, stretch, &sound)
            .find_map(|places| {
                let every = places.len().div_ceil(ENOUGH).max(1);
                let near = places.iter().step_by(every);
                let near = near.filter_map(|&i| observe(&readings[i], trust[i], check));
                fit_robust(&near.collect::<Vec<_>>(), &RobustOptions::default()).ok()
            })
            .map_or(NEITHER, |third| {
                vote_on_stretch(readings, stretch, check, &third)
            });
        for &index in stretch {
            trust[index] = decision;
        }
    }
}

/// Returns the sound readings for the model of a stretch, in order of time: those of weeks
/// before, of weeks after, and all.
fn nearby<'a>(
    readings: &[HeadingReading],
    stretch: &[usize],
    sound: &'a [usize],
) -> impl Iterator<Item = &'a [usize]> + use<'a> {
    let time = |place: usize| readings[place].time;
    let ends = stretch.first().zip(stretch.last());
    let [before, after] = match ends.map(|(&first, &last)| (time(first), time(last))) {
        Some((Some(first), Some(last))) => {
            let since = |from: Timestamp| sound.partition_point(|&i| time(i) < Some(from));
            [
                since(first.plus_seconds(-NEARBY_S))..since(first),
                since(last)..since(last.plus_seconds(NEARBY_S)),
            ]
        }
        _ => [0..0, 0..0],
    };
    [&sound[before], &sound[after], sound].into_iter()
}

/// Returns trust in the reference that kept its difference from the compass as the stretch
/// began.
fn vote_on_stretch(
    readings: &[HeadingReading],
    stretch: &[usize],
    check: &ReferenceCheck,
    third: &RobustFit,
) -> Trust {
    let begun = stretch.first().and_then(|&i| readings[i].time);
    let is_early = |reading: &&HeadingReading| match (begun, reading.time) {
        (Some(begun), Some(time)) => time.seconds_since(begun) < STRETCH_BEGINNING_S,
        _ => true,
    };
    let mut off = (Vec::new(), Vec::new());
    for reading in stretch.iter().map(|&i| &readings[i]).filter(is_early) {
        let Some(by_compass) = heading_by_compass(reading, third) else {
            continue;
        };
        if let (Some(gyro), Some(satellite)) =
            without_usual_difference(check, reading.gyro, reading.satellite)
        {
            off.0.push(wrap_180(gyro.degrees() - by_compass));
            off.1.push(wrap_180(satellite.degrees() - by_compass));
        }
    }
    let (Some(gyro), Some(satellite)) = (median(off.0), median(off.1)) else {
        return NEITHER;
    };
    Trust {
        gyro: gyro.abs() * ERROR_RATIO_OVER_DAYS < satellite.abs(),
        satellite: satellite.abs() * ERROR_RATIO_OVER_DAYS < gyro.abs(),
    }
}

const NEITHER: Trust = Trust {
    gyro: false,
    satellite: false,
};

/// Returns trust in the reference that is near the compass's heading.
fn vote(
    readings: &[HeadingReading],
    spell: &[usize],
    check: &ReferenceCheck,
    third: &RobustFit,
) -> Trust {
    let mut off = (Vec::new(), Vec::new());
    for reading in spell.iter().map(|&i| &readings[i]) {
        let Some(by_compass) = heading_by_compass(reading, third) else {
            continue;
        };
        if let (Some(gyro), Some(satellite)) =
            without_usual_difference(check, reading.gyro, reading.satellite)
        {
            off.0.push(wrap_180(gyro.degrees() - by_compass).abs());
            off.1.push(wrap_180(satellite.degrees() - by_compass).abs());
        }
    }
    let (Some(gyro), Some(satellite)) = (median(off.0), median(off.1)) else {
        return NEITHER;
    };
    Trust {
        gyro: gyro * ERROR_RATIO < satellite,
        satellite: satellite * ERROR_RATIO < gyro,
    }
}

/// Returns the true heading by compass and model, degrees.
fn heading_by_compass(reading: &HeadingReading, third: &RobustFit) -> Option<f64> {
    let earth = EarthField {
        h_nt: reading.h_nt,
        z_nt: reading.z_nt,
    };
    let coefficients = Coefficients::new(&third.model.parameters_over_lambda, earth).ok()?;
    let deviation = coefficients.deviation_at_compass_rad(reading.compass.radians())?;
    let magnetic = reading.compass.degrees() + deviation.to_degrees() + third.model.constant_deg;
    Some(magnetic + reading.variation.degrees_east())
}
