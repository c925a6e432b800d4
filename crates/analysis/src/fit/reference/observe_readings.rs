//! Observations from heading readings, without failed references.

use super::observe::{differences, observe};
use super::reading::{HeadingReading, Trust};
use super::{check, majority_vote, reference_drift, stuck_reference};
use crate::observation::Observation;
use binnacle_compass::result::{FitError, ReferenceCheck};
use std::ops::Range;

/// Lasting difference of two references from which neither can be used.
const LASTING_LIMIT_DEG: f64 = 6.0;

/// Observations from readings, with the comparison of their references.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedReadings {
    /// Observation of each reading, in the order given; none without a trusted reference.
    pub observations: Vec<Option<Observation>>,
    /// Comparison of the references.
    pub check: ReferenceCheck,
}

/// Makes observations of readings in any order; `one_constant_sd_deg` is the prior standard
/// deviation of either reference's constant error.
///
/// # Errors
/// [`FitError::ReferencesDisagree`] when the two differ throughout by more than any
/// alignment explains, [`FitError::ReferenceStuck`] when none ever moves,
/// [`FitError::NoReference`] when no reading has any.
pub fn observe_readings(
    readings: &[HeadingReading],
    one_constant_sd_deg: f64,
) -> Result<ObservedReadings, FitError> {
    if !readings.is_empty() && !readings.iter().any(HeadingReading::has_reference) {
        return Err(FitError::NoReference {
            readings: readings.len() as u64,
        });
    }
    let mut order: Vec<usize> = (0..readings.len()).collect();
    order.sort_by_key(|&i| readings[i].time);
    let mut trust = stuck_reference::trust(readings, &order);
    let stuck = readings
        .iter()
        .zip(&trust)
        .filter(|(reading, trust)| reading.has_reference() && !reading.may_observe(**trust));
    let stuck = stuck.count();
    if stuck > 0 && stuck == readings.iter().filter(|r| r.has_reference()).count() {
        return Err(FitError::ReferenceStuck {
            readings: stuck as u64,
        });
    }
    let (mut check, stretches) = compare(readings, &order, &trust, one_constant_sd_deg);
    if let Some(offset_deg) = check.offset_deg
        && offset_deg.abs() > LASTING_LIMIT_DEG
    {
        return Err(FitError::ReferencesDisagree {
            offset_deg,
            allowed_deg: LASTING_LIMIT_DEG,
        });
    }
    majority_vote::vote_on_stretches(readings, &order, &check, &stretches, &mut trust);
    majority_vote::vote_on_failures(readings, &order, &check, &mut trust);
    check::count_dropped(&mut check, readings, &trust);
    let observations = readings
        .iter()
        .zip(&trust)
        .map(|(reading, trust)| observe(reading, *trust, &check))
        .collect();
    Ok(ObservedReadings {
        observations,
        check,
    })
}

/// Returns the comparison, and the readings of each stretch of days with another
/// difference.
fn compare(
    readings: &[HeadingReading],
    order: &[usize],
    trust: &[Trust],
    one_constant_sd_deg: f64,
) -> (ReferenceCheck, Vec<Vec<usize>>) {
    let both = Trust {
        gyro: true,
        satellite: true,
    };
    let trusted = order.iter().copied().filter(|&i| trust[i] == both);
    let pairs = reference_drift::pairs(readings, trusted).unwrap_or_default();
    let Some(drifts) = reference_drift::find_stretches(&pairs) else {
        let all = differences(readings, trust).map(|(_, difference)| difference);
        return (
            check::check_differences(all, one_constant_sd_deg),
            Vec::new(),
        );
    };
    let sound = drifts.sound(&pairs).map(|pair| pair.difference_deg);
    let sound: Vec<f64> = sound.collect();
    let check = ReferenceCheck {
        pairs: pairs.len() as u64,
        ..check::check_sound_differences(&sound, one_constant_sd_deg)
    };
    let places = |stretch: &Range<usize>| pairs[stretch.clone()].iter().map(|p| p.index).collect();
    (check, drifts.stretches.iter().map(places).collect())
}
