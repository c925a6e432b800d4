//! Observations from heading readings, with failed references left out.

use super::observe::{differences, observe};
use super::reading::{HeadingReading, Trust};
use super::{check, majority_vote, reference_drift, stuck_reference};
use crate::observation::Observation;
use binnacle_compass::result::{FitError, ReferenceCheck};
use std::ops::Range;

/// Two references that differ so much throughout are no reference.
const LASTING_LIMIT_DEG: f64 = 6.0;

/// Readings held against their references.
#[derive(Clone, Debug, PartialEq)]
pub struct Referred {
    /// For each reading, in the order given, its observation; none where there
    /// was no reference or none to be believed.
    pub observations: Vec<Option<Observation>>,
    /// How the references compare.
    pub check: ReferenceCheck,
}

/// Makes observations of readings, whatever their order; `one_constant_sd_deg` is
/// what is known beforehand of the constant error of either reference.
///
/// # Errors
/// [`FitError::ReferencesDisagree`] when the two differ throughout by more than
/// any alignment explains, [`FitError::ReferenceStuck`] when none ever moves,
/// [`FitError::NoReference`] when no reading has any.
pub fn refer(readings: &[HeadingReading], one_constant_sd_deg: f64) -> Result<Referred, FitError> {
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
    majority_vote::settle_stretches(readings, &order, &check, &stretches, &mut trust);
    majority_vote::settle(readings, &order, &check, &mut trust);
    check::count_dropped(&mut check, readings, &trust);
    let observations = readings
        .iter()
        .zip(&trust)
        .map(|(reading, trust)| observe(reading, *trust, &check))
        .collect();
    Ok(Referred {
        observations,
        check,
    })
}

/// How the two compare, and the readings of each stretch of days over which they stand
/// otherwise.
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
    let believed = order.iter().copied().filter(|&i| trust[i] == both);
    let pairs = reference_drift::pairs(readings, believed).unwrap_or_default();
    let Some(parted) = reference_drift::part(&pairs) else {
        let all = differences(readings, trust).map(|(_, difference)| difference);
        return (check::check_of(all, one_constant_sd_deg), Vec::new());
    };
    let sound = parted.sound(&pairs).map(|pair| pair.difference_deg);
    let sound: Vec<f64> = sound.collect();
    let check = ReferenceCheck {
        pairs: pairs.len() as u64,
        ..check::check_of_sound(&sound, one_constant_sd_deg)
    };
    let places = |stretch: &Range<usize>| pairs[stretch.clone()].iter().map(|p| p.index).collect();
    (check, parted.stretches.iter().map(places).collect())
}
