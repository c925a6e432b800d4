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
    let mut compared = compare_all(readings, one_constant_sd_deg)?;
    let Compared {
        order,
        trust,
        check,
        stretches,
    } = &mut compared;
    majority_vote::vote_on_stretches(readings, order, check, stretches, trust);
    majority_vote::vote_on_failures(readings, order, check, trust);
    check::count_dropped(check, readings, trust);
    let observations = readings
        .iter()
        .zip(trust.iter())
        .map(|(reading, trust)| observe(reading, *trust, check))
        .collect();
    Ok(ObservedReadings {
        observations,
        check: *check,
    })
}

/// Compares the references of readings in any order, without a verdict on which one failed.
///
/// # Errors
/// Those of [`observe_readings`].
pub fn compare_references(
    readings: &[HeadingReading],
    one_constant_sd_deg: f64,
) -> Result<ReferenceCheck, FitError> {
    Ok(compare_all(readings, one_constant_sd_deg)?.check)
}

/// Comparison of the references of all readings.
struct Compared {
    /// Places of the readings in order of time.
    order: Vec<usize>,
    /// Trust in the references of each reading: a stuck one has none.
    trust: Vec<Trust>,
    check: ReferenceCheck,
    /// Readings of each stretch of days with another difference.
    stretches: Vec<Vec<usize>>,
}

fn compare_all(
    readings: &[HeadingReading],
    one_constant_sd_deg: f64,
) -> Result<Compared, FitError> {
    if !readings.is_empty() && !readings.iter().any(HeadingReading::has_reference) {
        return Err(FitError::NoReference {
            readings: readings.len() as u64,
        });
    }
    let mut order: Vec<usize> = (0..readings.len()).collect();
    order.sort_by_key(|&i| readings[i].time);
    let trust = stuck_reference::trust(readings, &order);
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
    let (check, stretches) = compare(readings, &order, &trust, one_constant_sd_deg);
    if let Some(offset_deg) = check.offset_deg
        && offset_deg.abs() > LASTING_LIMIT_DEG
    {
        return Err(FitError::ReferencesDisagree {
            offset_deg,
            allowed_deg: LASTING_LIMIT_DEG,
        });
    }
    Ok(Compared {
        order,
        trust,
        check,
        stretches,
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
