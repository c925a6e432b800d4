//! Questions about values that are possible and unlikely.
//!
//! A compass struck by lightning, or a gyro that has failed, shows such values in earnest,
//! so they are accepted once the observer confirms them.

use super::error::AzimuthError;
use super::readings::{Bearing, Readings, Target};
use super::result::AzimuthResult;
use crate::angle::wrap_180;

/// Greatest usual deviation, degrees. A compass adjusted at all stays within it.
const USUAL_DEVIATION_DEG: f64 = 20.0;
/// Greatest usual gyro error, degrees, north-speed error in high latitudes included.
const USUAL_GYRO_ERROR_DEG: f64 = 10.0;
/// Greatest usual difference between two relative bearings of one object, degrees.
const USUAL_BEARINGS_APART_DEG: f64 = 3.0;
/// Difference at which two typed angles are one, degrees.
const SAME_DEG: f64 = 1e-6;

/// Asks about unlikely values.
pub(super) fn check(readings: &Readings, result: &AzimuthResult) -> Result<(), AzimuthError> {
    if let Some((instrument, indicated)) = repeated_true_bearing(readings, result) {
        return Err(AzimuthError::question(format!(
            "the true bearing is the {instrument}'s own, {indicated:05.1}°, to the last digit"
        )));
    }
    let deviation = result.deviation_deg;
    if deviation.degrees_east().abs() > USUAL_DEVIATION_DEG {
        return Err(AzimuthError::question(format!(
            "the true bearing {} and the variation {} make a deviation of {deviation}",
            result.true_bearing_deg, result.variation_deg
        )));
    }
    if let Some(gyro) = result.gyro_error_deg
        && gyro.degrees_east().abs() > USUAL_GYRO_ERROR_DEG
    {
        let bearing = result.true_bearing_deg;
        return Err(AzimuthError::question(format!(
            "the true bearing {bearing} makes a gyro error of {gyro}"
        )));
    }
    check_relative_bearings(readings)
}

/// Returns the instrument whose value is also the typed true one, and the value.
fn repeated_true_bearing(
    readings: &Readings,
    result: &AzimuthResult,
) -> Option<(&'static str, f64)> {
    if let Target::SunAzimuth | Target::SunAmplitude { .. } = readings.target {
        return None;
    }
    let (by_compass_deg, by_gyro_deg) = match readings.bearing {
        Bearing::Compass(compass) => (Some(compass.degrees()), None),
        Bearing::Gyro(gyro, _) => (None, Some(gyro.degrees())),
        Bearing::Both(compass, gyro) => (Some(compass.degrees()), Some(gyro.degrees())),
        // A gyro alongside may well show the quay's direction.
        Bearing::Ahead => (Some(readings.compass_heading.degrees()), None),
    };
    let indicated = [("compass", by_compass_deg), ("gyro", by_gyro_deg)];
    let mut indicated = indicated
        .into_iter()
        .filter_map(|(instrument, degrees)| Some((instrument, degrees?)));
    indicated.find(|(_, indicated_deg)| {
        let apart_deg = wrap_180(result.true_bearing_deg.degrees() - indicated_deg);
        apart_deg.abs() < SAME_DEG
    })
}

/// Compares the angle from the bow by compass with the one by gyro.
fn check_relative_bearings(readings: &Readings) -> Result<(), AzimuthError> {
    let Bearing::Both(compass, gyro) = readings.bearing else {
        return Ok(());
    };
    let Some(gyro_heading) = readings.gyro_heading else {
        return Ok(());
    };
    let by_compass_deg = compass.degrees() - readings.compass_heading.degrees();
    let by_gyro_deg = gyro.degrees() - gyro_heading.degrees();
    let apart_deg = wrap_180(by_compass_deg - by_gyro_deg).abs();
    if apart_deg > USUAL_BEARINGS_APART_DEG {
        return Err(AzimuthError::question(format!(
            "bearing and heading by compass and by gyro differ by {apart_deg:.1}° in the angle \
             from the bow"
        )));
    }
    Ok(())
}
