//! Which of two references has failed: the magnetic compass has the third vote.

use super::{HeadingReading, ReferenceCheck, Trust, differences, observe};
use crate::angle::wrap_180;
use crate::deviation::Coefficients;
use crate::fit::{Observation, RobustFit, RobustOptions, fit_robust};
use crate::ship::EarthField;

/// Failures closer in time than this are one.
const SPELL_S: f64 = 6.0 * 3600.0;
/// The failed reference must be so many times further off than the sound one.
const FURTHER: f64 = 2.0;
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
        failed[index] = check.failed(difference);
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
        if let (Some(gyro), Some(satellite)) = check.centred(reading.gyro, reading.satellite) {
            off.0.push(wrap_180(gyro.degrees() - by_compass).abs());
            off.1.push(wrap_180(satellite.degrees() - by_compass).abs());
        }
    }
    let (Some(gyro), Some(satellite)) = (middle(off.0), middle(off.1)) else {
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

fn middle(mut sizes: Vec<f64>) -> Option<f64> {
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied()
}
