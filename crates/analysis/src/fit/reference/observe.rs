//! Observations from readings with the trust in each reference.

use super::check;
use super::reading::{HeadingReading, Trust};
use crate::observation::Observation;
use binnacle_compass::result::ReferenceCheck;

/// Returns index, and gyro less satellite compass, of every reading with both.
pub(super) fn differences<'a>(
    readings: &'a [HeadingReading],
    trust: &'a [Trust],
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let both = readings.iter().zip(trust).enumerate();
    both.filter_map(|(index, (reading, trust))| {
        let (gyro, satellite) = reading.trusted(*trust);
        Some((index, check::difference_deg(gyro?, satellite?)))
    })
}

pub(super) fn observe(
    reading: &HeadingReading,
    trust: Trust,
    check: &ReferenceCheck,
) -> Option<Observation> {
    let (gyro, satellite) = reading.trusted(trust);
    let reference = check::merge(check, gyro, satellite).or_else(|| {
        // An unnamed reference may wander as a gyro does.
        let named = reading.gyro.or(reading.satellite);
        let unnamed = reading.unnamed.filter(|_| named.is_none())?;
        check::Reference::from_gyro(unnamed).into()
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
