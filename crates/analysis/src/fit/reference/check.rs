//! Comparison of gyro and satellite compass, and their common heading.

use super::reading::{HeadingReading, Trust};
use crate::robust_scale::{median, robust_sd};
use binnacle_compass::angle::{TrueHeading, wrap_180};
use binnacle_compass::result::{MAX_FAILURE_THRESHOLD_DEG, ReferenceCheck};

/// Least number of pairs that show the difference.
const NEEDED_PAIRS: usize = 12;
/// Share of the gyro in the common heading. From row to row the gyro is the steadier; its
/// slower errors show in the difference, which the estimator reads beside the merged
/// heading.
const GYRO_SHARE: f64 = 0.7;
/// Largest difference of two sound references.
const SOUND_DEG: f64 = 2.5;
/// Share of the pairs with differences below [`SOUND_DEG`] from which those are the sound
/// ones.
const SOUND_SHARE: f64 = 0.25;
/// Departure from the usual difference from which one has failed: in standard deviations,
/// and within these limits.
const FAILED_SD: f64 = 6.0;
const FAILED_DEG: (f64, f64) = (2.0, MAX_FAILURE_THRESHOLD_DEG);

/// True heading by the references that were read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference {
    pub(super) heading: TrueHeading,
    /// Share of the gyro, 0 to 1.
    pub(super) gyro_share: f64,
    /// Gyro less satellite compass where both were used, without their usual difference,
    /// degrees.
    pub(super) gyro_less_satellite_deg: Option<f64>,
}

impl Reference {
    /// Makes a heading by a gyro alone.
    pub(super) fn from_gyro(heading: TrueHeading) -> Reference {
        Reference {
            heading,
            gyro_share: 1.0,
            gyro_less_satellite_deg: None,
        }
    }
}

/// Returns gyro less satellite compass, degrees.
pub(super) fn difference_deg(gyro: TrueHeading, satellite: TrueHeading) -> f64 {
    wrap_180(gyro.degrees() - satellite.degrees())
}

/// Compares references by all differences of gyro and satellite compass, degrees.
pub(super) fn check_differences(
    differences: impl Iterator<Item = f64>,
    one_constant_sd_deg: f64,
) -> ReferenceCheck {
    let all: Vec<f64> = differences.collect();
    let pairs = all.len() as u64;
    let sound: Vec<f64> = all
        .iter()
        .copied()
        .filter(|d| d.abs() < SOUND_DEG)
        .collect();
    let enough = (all.len() as f64 * SOUND_SHARE).max(NEEDED_PAIRS as f64);
    let used = if sound.len() as f64 >= enough {
        sound
    } else {
        all
    };
    ReferenceCheck {
        pairs,
        ..check_sound_differences(&used, one_constant_sd_deg)
    }
}

/// Compares references by the differences of sound ones, degrees.
pub(super) fn check_sound_differences(sound: &[f64], one_constant_sd_deg: f64) -> ReferenceCheck {
    let mut check = ReferenceCheck {
        pairs: sound.len() as u64,
        offset_deg: None,
        failed_beyond_deg: FAILED_DEG.1,
        constant_sd_deg: one_constant_sd_deg,
        gyro_dropped: 0,
        satellite_dropped: 0,
    };
    if sound.len() < NEEDED_PAIRS {
        return check;
    }
    let Some(offset) = median(sound.to_vec()) else {
        return check;
    };
    let Some(spread) = robust_sd(sound.iter().copied(), offset) else {
        return check;
    };
    check.offset_deg = Some(offset);
    check.failed_beyond_deg = (FAILED_SD * spread).clamp(FAILED_DEG.0, FAILED_DEG.1);
    // The mean of two is better than one, but no better than their difference.
    let variance = (one_constant_sd_deg.powi(2) / 2.0).max(offset.powi(2) / 4.0);
    check.constant_sd_deg = variance.sqrt();
    check
}

/// Returns true if a difference departs so far from the usual one that a reference has
/// failed.
pub(super) fn has_failed(check: &ReferenceCheck, difference_deg: f64) -> bool {
    departure_deg(check, difference_deg).abs() > check.failed_beyond_deg
}

fn departure_deg(check: &ReferenceCheck, difference_deg: f64) -> f64 {
    wrap_180(difference_deg - check.offset_deg.unwrap_or(0.0))
}

/// Returns each reference without half of the usual difference.
pub(super) fn without_usual_difference(
    check: &ReferenceCheck,
    gyro: Option<TrueHeading>,
    satellite: Option<TrueHeading>,
) -> (Option<TrueHeading>, Option<TrueHeading>) {
    let half = check.offset_deg.unwrap_or(0.0) / 2.0;
    let moved = |heading: TrueHeading, by: f64| {
        // A finite heading moved by a finite angle is a heading.
        TrueHeading::new(heading.degrees() + by).unwrap_or(heading)
    };
    (
        gyro.map(|gyro| moved(gyro, -half)),
        satellite.map(|satellite| moved(satellite, half)),
    )
}

/// Returns the heading of the trusted references; none without any.
pub(super) fn merge(
    check: &ReferenceCheck,
    gyro: Option<TrueHeading>,
    satellite: Option<TrueHeading>,
) -> Option<Reference> {
    match without_usual_difference(check, gyro, satellite) {
        (None, None) => None,
        (Some(gyro), None) => Some(Reference::from_gyro(gyro)),
        (None, Some(heading)) => Some(Reference {
            heading,
            gyro_share: 0.0,
            gyro_less_satellite_deg: None,
        }),
        (Some(gyro), Some(satellite)) => {
            let ahead = difference_deg(gyro, satellite);
            Some(Reference {
                heading: TrueHeading::new(satellite.degrees() + GYRO_SHARE * ahead)?,
                gyro_share: GYRO_SHARE,
                gyro_less_satellite_deg: Some(ahead),
            })
        }
    }
}

/// Counts the readings of either reference that were not trusted.
pub(super) fn count_dropped(
    check: &mut ReferenceCheck,
    readings: &[HeadingReading],
    trust: &[Trust],
) {
    for (reading, trust) in readings.iter().zip(trust) {
        check.gyro_dropped += u64::from(reading.gyro.is_some() && !trust.gyro);
        check.satellite_dropped += u64::from(reading.satellite.is_some() && !trust.satellite);
    }
}
