//! How gyro and satellite compass compare, and the heading of both.

use super::{HeadingReading, Trust};
use binnacle_compass::angle::{TrueHeading, wrap_180};
use binnacle_compass::result::{MAX_FAILURE_THRESHOLD_DEG, ReferenceCheck};

/// Fewer readings of both at once do not show how they differ.
const NEEDED_PAIRS: usize = 12;
/// The gyro's share in the heading of both. From row to row the gyro is the
/// steadier; what it does wrong for longer shows in the difference, which the
/// estimator takes in beside the merged heading.
const GYRO_SHARE: f64 = 0.7;
/// Two sound references hardly differ by more.
const SOUND_DEG: f64 = 2.5;
/// When this part of all pairs differ by less than [`SOUND_DEG`], those are the
/// sound ones.
const SOUND_SHARE: f64 = 0.25;
/// Where the two depart further from their usual difference one has failed: so
/// many standard deviations, and within these limits.
const FAILED_SD: f64 = 6.0;
const FAILED_DEG: (f64, f64) = (2.0, MAX_FAILURE_THRESHOLD_DEG);
/// The median of |x| of a Gaussian is this part of its standard deviation.
const MEDIAN_TO_SD: f64 = 0.674_489_8;

/// A true heading made of what there was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference {
    pub(super) heading: TrueHeading,
    /// What part of it is the gyro's, 0 to 1.
    pub(super) gyro_share: f64,
    /// Gyro less satellite compass where both were taken, their usual difference
    /// taken off, degrees.
    pub(super) gyro_less_satellite_deg: Option<f64>,
}

impl Reference {
    /// A heading by a gyro alone.
    pub(super) fn of_gyro(heading: TrueHeading) -> Reference {
        Reference {
            heading,
            gyro_share: 1.0,
            gyro_less_satellite_deg: None,
        }
    }
}

/// Gyro less satellite compass, degrees.
pub(super) fn difference_deg(gyro: TrueHeading, satellite: TrueHeading) -> f64 {
    wrap_180(gyro.degrees() - satellite.degrees())
}

/// From every difference of gyro and satellite compass, degrees.
pub(super) fn check_of(
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
    let telling = if sound.len() as f64 >= enough {
        sound
    } else {
        all
    };
    ReferenceCheck {
        pairs,
        ..check_of_sound(&telling, one_constant_sd_deg)
    }
}

/// From differences of references of which neither had failed for long, degrees.
pub(super) fn check_of_sound(sound: &[f64], one_constant_sd_deg: f64) -> ReferenceCheck {
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
    let Some((offset, spread)) = median(sound.to_vec()).zip(robust_sd(sound)) else {
        return check;
    };
    check.offset_deg = Some(offset);
    check.failed_beyond_deg = (FAILED_SD * spread).clamp(FAILED_DEG.0, FAILED_DEG.1);
    // The mean of two is better than one, but no better than their quarrel.
    let variance = (one_constant_sd_deg.powi(2) / 2.0).max(offset.powi(2) / 4.0);
    check.constant_sd_deg = variance.sqrt();
    check
}

/// How far a difference departs from the usual, when one must have failed.
pub(super) fn has_failed(check: &ReferenceCheck, difference_deg: f64) -> bool {
    departure_deg(check, difference_deg).abs() > check.failed_beyond_deg
}

fn departure_deg(check: &ReferenceCheck, difference_deg: f64) -> f64 {
    wrap_180(difference_deg - check.offset_deg.unwrap_or(0.0))
}

/// Either reference with half of the usual difference taken off.
pub(super) fn centred(
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

/// The reference heading of what is believed; none when nothing is.
pub(super) fn merge(
    check: &ReferenceCheck,
    gyro: Option<TrueHeading>,
    satellite: Option<TrueHeading>,
) -> Option<Reference> {
    match centred(check, gyro, satellite) {
        (None, None) => None,
        (Some(gyro), None) => Some(Reference::of_gyro(gyro)),
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

/// Notes how often either reference was there and not believed.
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

/// None of no numbers.
pub(super) fn median(mut numbers: Vec<f64>) -> Option<f64> {
    let middle = numbers.len() / 2;
    if numbers.is_empty() {
        return None;
    }
    Some(*numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The standard deviation of a Gaussian of whose numbers as many are as near to the median;
/// none of no numbers.
pub(super) fn robust_sd(numbers: &[f64]) -> Option<f64> {
    let middle = median(numbers.to_vec())?;
    let off = numbers.iter().map(|x| (x - middle).abs());
    Some(median(off.collect())? / MEDIAN_TO_SD)
}
