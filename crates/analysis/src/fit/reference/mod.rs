//! From what was read to observations: one true heading out of a gyro and a
//! satellite compass, and which of them to believe.
//!
//! What always holds: a difference between the two references never depends on
//! the ship's magnetism, so that it is never put down to the magnetic compass.
//! The usual one is halved between them, so that the reference does not jump when
//! one drops out, and stands in the standard deviation of the reference's
//! constant. Any other is a failure, be it of an hour or for good: the magnetic
//! compass, by a model of other readings, tells which has failed, and that one is
//! dropped; where it cannot tell, both are.

mod check;
mod parted;
mod stuck;
mod vote;

use crate::observation::Observation;
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::result::{FitError, ReferenceCheck};
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Two references that differ so much throughout are no reference.
const LASTING_LIMIT_DEG: f64 = 6.0;

/// What was read at one time, with the earth's field around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingReading {
    /// When; none when the source did not say.
    pub time: Option<Timestamp>,
    /// Where; none when the source gave the field in place of the position.
    pub position: Option<Position>,
    /// The raw compass heading.
    pub compass: CompassHeading,
    /// The gyro's, its speed error taken out.
    pub gyro: Option<TrueHeading>,
    /// The satellite compass's.
    pub satellite: Option<TrueHeading>,
    /// A true heading of unknown origin, for want of the other two.
    pub unnamed: Option<TrueHeading>,
    /// The earth's variation there and then.
    pub variation: Variation,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Speed over ground, knots.
    pub sog_kn: Option<f64>,
    /// Ten-second windows behind the reading, at least 1.
    pub windows: u16,
    /// Standard deviation of compass less reference among them, degrees.
    pub spread_deg: Option<f64>,
    /// How much it counts beside the others; 1 where nothing is said.
    pub weight: f64,
}

/// Readings held against their references.
#[derive(Clone, Debug, PartialEq)]
pub struct Referred {
    /// For each reading, in the order given, its observation; none where there
    /// was no reference or none to be believed.
    pub observations: Vec<Option<Observation>>,
    /// How the references compare.
    pub check: ReferenceCheck,
}

/// Which references of a reading are believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Trust {
    gyro: bool,
    satellite: bool,
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
    let mut trust = stuck::trust(readings, &order);
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
    vote::settle_stretches(readings, &order, &check, &stretches, &mut trust);
    vote::settle(readings, &order, &check, &mut trust);
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
    let pairs = parted::pairs(readings, believed).unwrap_or_default();
    let Some(parted) = parted::part(&pairs) else {
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

/// Index and gyro less satellite compass of every reading with both.
fn differences<'a>(
    readings: &'a [HeadingReading],
    trust: &'a [Trust],
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let both = readings.iter().zip(trust).enumerate();
    both.filter_map(|(index, (reading, trust))| {
        let (gyro, satellite) = reading.believed(*trust);
        Some((index, check::difference_deg(gyro?, satellite?)))
    })
}

impl HeadingReading {
    fn has_reference(&self) -> bool {
        self.gyro.or(self.satellite).or(self.unnamed).is_some()
    }

    fn may_observe(&self, trust: Trust) -> bool {
        let (gyro, satellite) = self.believed(trust);
        let named = self.gyro.or(self.satellite);
        gyro.or(satellite).is_some() || named.is_none()
    }

    fn believed(&self, trust: Trust) -> (Option<TrueHeading>, Option<TrueHeading>) {
        (
            self.gyro.filter(|_| trust.gyro),
            self.satellite.filter(|_| trust.satellite),
        )
    }
}

fn observe(reading: &HeadingReading, trust: Trust, check: &ReferenceCheck) -> Option<Observation> {
    let (gyro, satellite) = reading.believed(trust);
    let reference = check::merge(check, gyro, satellite).or_else(|| {
        // An unnamed reference may wander as a gyro does.
        let named = reading.gyro.or(reading.satellite);
        let unnamed = reading.unnamed.filter(|_| named.is_none())?;
        check::Reference::of_gyro(unnamed).into()
    })?;
    Some(Observation {
        time: reading.time,
        position: reading.position,
        compass: reading.compass,
        deviation: (reference.heading - reading.variation) - reading.compass,
        variation: reading.variation,
        h_nt: reading.h_nt,
        z_nt: reading.z_nt,
        gyro_share: reference.gyro_share,
        gyro_less_satellite_deg: reference.gyro_less_satellite_deg,
        sog_kn: reading.sog_kn,
        windows: reading.windows,
        spread_deg: reading.spread_deg,
        weight: reading.weight,
    })
}

#[cfg(test)]
mod tests;
