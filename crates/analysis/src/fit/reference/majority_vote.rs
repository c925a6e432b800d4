//! Which of two references has failed: the magnetic compass has the third vote.

use super::check::{centred, has_failed, median};
use super::observe::{differences, observe};
use super::reading::{HeadingReading, Trust};
use crate::fit::{RobustFit, RobustOptions, fit_robust};
use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::result::ReferenceCheck;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;

/// Failures closer in time than this are one.
const SPELL_S: f64 = 6.0 * 3600.0;
/// The failed reference must be so many times further off than the sound one.
const FURTHER: f64 = 2.0;
/// The same over days, in which what passes evens out.
const FURTHER_FOR_LONG: f64 = 1.5;
/// What went astray for days is judged by the ship of so long before, or after.
const NEARBY_S: f64 = 30.0 * 86_400.0;
/// And by so much of it: the ship herself does not stay as she was.
const JUDGED_S: f64 = 15.0 * 86_400.0;
/// More observations than this tell the third vote no better.
const ENOUGH: usize = 2000;

/// Takes trust from the references that failed; `order` is that of time.
pub(super) fn settle(
    readings: &[HeadingReading],
    order: &[usize],
    check: &ReferenceCheck,
    trust: &mut [Trust],
) {
    let mut failed = vec![false; readings.len()];
    for (index, difference) in differences(readings, trust) {
        failed[index] = has_failed(check, difference);
    }
    let quarrels: Vec<usize> = order.iter().copied().filter(|&i| failed[i]).collect();
    if quarrels.is_empty() {
        return;
    }
    let sound = order.iter().copied().filter(|&i| !failed[i]);
    let every = (readings.len() - quarrels.len()).div_ceil(ENOUGH).max(1);
    let sound: Vec<Observation> = sound
        .step_by(every)
        .filter_map(|i| observe(&readings[i], trust[i], check))
        .collect();
    let third = fit_robust(&sound, &RobustOptions::default()).ok();
    let spells = quarrels.chunk_by(|&a, &b| match (readings[a].time, readings[b].time) {
        (Some(a), Some(b)) => b.seconds_since(a) < SPELL_S,
        _ => false,
    });
    for spell in spells {
        let verdict = third
            .as_ref()
            .map_or(NEITHER, |third| judge(readings, spell, check, third));
        for &index in spell {
            trust[index] = verdict;
        }
    }
}

/// Takes trust from the reference that went astray in each of these stretches of days.
pub(super) fn settle_stretches(
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
        let verdict = nearby(readings, stretch, &sound)
            .find_map(|places| {
                let every = places.len().div_ceil(ENOUGH).max(1);
                let near = places.iter().step_by(every);
                let near = near.filter_map(|&i| observe(&readings[i], trust[i], check));
                fit_robust(&near.collect::<Vec<_>>(), &RobustOptions::default()).ok()
            })
            .map_or(NEITHER, |third| {
                judge_stretch(readings, stretch, check, &third)
            });
        for &index in stretch {
            trust[index] = verdict;
        }
    }
}

/// Sound readings, in order of time, by whose model a stretch may be judged: those of weeks
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

/// Believes the reference that stayed as it was beside the compass, as the stretch began.
fn judge_stretch(
    readings: &[HeadingReading],
    stretch: &[usize],
    check: &ReferenceCheck,
    third: &RobustFit,
) -> Trust {
    let begun = stretch.first().and_then(|&i| readings[i].time);
    let is_early = |reading: &&HeadingReading| match (begun, reading.time) {
        (Some(begun), Some(time)) => time.seconds_since(begun) < JUDGED_S,
        _ => true,
    };
    let mut off = (Vec::new(), Vec::new());
    for reading in stretch.iter().map(|&i| &readings[i]).filter(is_early) {
        let Some(by_compass) = heading_by_compass(reading, third) else {
            continue;
        };
        if let (Some(gyro), Some(satellite)) = centred(check, reading.gyro, reading.satellite) {
            off.0.push(wrap_180(gyro.degrees() - by_compass));
            off.1.push(wrap_180(satellite.degrees() - by_compass));
        }
    }
    let (Some(gyro), Some(satellite)) = (median(off.0), median(off.1)) else {
        return NEITHER;
    };
    Trust {
        gyro: gyro.abs() * FURTHER_FOR_LONG < satellite.abs(),
        satellite: satellite.abs() * FURTHER_FOR_LONG < gyro.abs(),
    }
}

const NEITHER: Trust = Trust {
    gyro: false,
    satellite: false,
};

/// Believes the reference that is near to where the compass points.
fn judge(
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
        if let (Some(gyro), Some(satellite)) = centred(check, reading.gyro, reading.satellite) {
            off.0.push(wrap_180(gyro.degrees() - by_compass).abs());
            off.1.push(wrap_180(satellite.degrees() - by_compass).abs());
        }
    }
    let (Some(gyro), Some(satellite)) = (median(off.0), median(off.1)) else {
        return NEITHER;
    };
    Trust {
        gyro: gyro * FURTHER < satellite,
        satellite: satellite * FURTHER < gyro,
    }
}

/// The true heading, degrees, as compass and model have it.
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
