//! One true heading out of a gyro and a satellite compass.
//!
//! What always holds: a lasting, heading-independent difference between the two
//! is a fault of a reference and is never put down to the magnetic compass. It
//! is halved between them, so that the reference does not jump when one drops
//! out, and stands in the standard deviation of the reference's constant.

use crate::angle::{TrueHeading, wrap_180};
use serde::{Deserialize, Serialize};

/// Fewer readings of both at once do not show how they differ.
const NEEDED_PAIRS: usize = 12;
/// Variance of a gyro's wander, degrees squared, at the equator.
const GYRO_VARIANCE: f64 = 0.2;
/// Variance of a satellite compass's ten-minute mean, degrees squared.
const SATELLITE_VARIANCE: f64 = 0.06;
/// Where the two depart further from their usual difference one has failed;
/// the satellite compass is believed, because it flags its own drop-outs.
const FAILED_DEG: f64 = 3.0;
/// Radius of the earth's turning, knots (speed error of a gyro: sin ε =
/// V cos C / 902.5 cos φ).
const EARTH_TURN_KN: f64 = 902.5;

/// Who takes out the error that a gyro has from the ship's own motion over the
/// turning earth. It must be done once, never twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GyroSpeedError {
    /// The gyro does it itself.
    #[default]
    Corrected,
    /// The gyro does not: it is taken out here, from speed and latitude.
    Uncorrected,
}

/// A gyro's speed error in degrees, to be taken off its reading: positive on
/// northerly headings.
pub fn gyro_speed_error_deg(gyro: TrueHeading, sog_kn: f64, lat_deg: f64) -> f64 {
    // At the pole itself the rule has no meaning, and the gyro no north.
    let turn_kn = (EARTH_TURN_KN * lat_deg.to_radians().cos()).max(1.0);
    let sine = sog_kn * gyro.radians().cos() / turn_kn;
    sine.clamp(-1.0, 1.0).asin().to_degrees()
}

/// How a ship's two references compare over all her samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceCheck {
    /// Samples with both.
    pub pairs: u64,
    /// Gyro less satellite compass, the median, degrees; none without enough pairs.
    pub offset_deg: Option<f64>,
    /// Standard deviation of the constant error that is left in the reference.
    pub constant_sd_deg: f64,
}

/// A true heading made of what there was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The heading.
    pub heading: TrueHeading,
    /// What part of it is the gyro's, 0 to 1.
    pub gyro_share: f64,
}

impl ReferenceCheck {
    /// Compares gyro and satellite compass wherever both were read;
    /// `one_constant_sd_deg` is what is known beforehand of the constant error
    /// of either.
    pub fn new(
        pairs: impl Iterator<Item = (TrueHeading, TrueHeading)>,
        one_constant_sd_deg: f64,
    ) -> ReferenceCheck {
        let mut differences: Vec<f64> = pairs
            .map(|(gyro, satellite)| wrap_180(gyro.degrees() - satellite.degrees()))
            .collect();
        let count = differences.len();
        let pairs = count as u64;
        if count < NEEDED_PAIRS {
            return ReferenceCheck {
                pairs,
                offset_deg: None,
                constant_sd_deg: one_constant_sd_deg,
            };
        }
        let (_, median, _) = differences.select_nth_unstable_by(count / 2, f64::total_cmp);
        let offset = *median;
        // The mean of two is better than one, but no better than their quarrel.
        let constant_sd_deg =
            (one_constant_sd_deg * std::f64::consts::FRAC_1_SQRT_2).max(offset.abs() / 2.0);
        ReferenceCheck {
            pairs,
            offset_deg: Some(offset),
            constant_sd_deg,
        }
    }

    /// The reference heading at a latitude; none when neither was read.
    pub fn merge(
        &self,
        gyro: Option<TrueHeading>,
        satellite: Option<TrueHeading>,
        lat_deg: f64,
    ) -> Option<Reference> {
        let half = self.offset_deg.unwrap_or(0.0) / 2.0;
        let at = |degrees: f64, gyro_share: f64| {
            TrueHeading::new(degrees).map(|heading| Reference {
                heading,
                gyro_share,
            })
        };
        match (gyro, satellite) {
            (None, None) => None,
            (Some(gyro), None) => at(gyro.degrees() - half, 1.0),
            (None, Some(satellite)) => at(satellite.degrees() + half, 0.0),
            (Some(gyro), Some(satellite)) => {
                let by_satellite = satellite.degrees() + half;
                let ahead = wrap_180(gyro.degrees() - half - by_satellite);
                if ahead.abs() > FAILED_DEG {
                    return at(by_satellite, 0.0);
                }
                let cos_lat = lat_deg.to_radians().cos().max(0.17);
                let gyro_variance = GYRO_VARIANCE / (cos_lat * cos_lat);
                let share = SATELLITE_VARIANCE / (SATELLITE_VARIANCE + gyro_variance);
                at(by_satellite + share * ahead, share)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heading(degrees: f64) -> TrueHeading {
        TrueHeading::new(degrees).unwrap()
    }

    #[test]
    fn a_gyros_speed_error_is_that_of_the_manuals() {
        for (gyro, expected) in [(345.0, 343.3), (223.7, 225.0)] {
            let error = gyro_speed_error_deg(heading(gyro), 16.0, 55.0);
            assert!((gyro - error - expected).abs() < 0.05, "{gyro}: {error}");
        }
        assert!(gyro_speed_error_deg(heading(0.0), 20.0, 90.0).is_finite());
    }

    #[test]
    fn a_lasting_difference_is_halved_and_widens_the_constant() {
        let pairs = (0..40).map(|i| {
            (
                heading(9.0 * f64::from(i) + 4.0),
                heading(9.0 * f64::from(i)),
            )
        });
        let check = ReferenceCheck::new(pairs, 0.5);
        assert!((check.offset_deg.unwrap() - 4.0).abs() < 1e-9);
        assert!((check.constant_sd_deg - 2.0).abs() < 1e-9);
        let alone = check.merge(Some(heading(1.0)), None, 50.0).unwrap();
        let other = check.merge(None, Some(heading(357.0)), 50.0).unwrap();
        let both = check
            .merge(Some(heading(1.0)), Some(heading(357.0)), 50.0)
            .unwrap();
        for merged in [alone, other, both] {
            assert!(wrap_180(merged.heading.degrees() - 359.0).abs() < 1e-9);
        }
        assert!(both.gyro_share > 0.0 && both.gyro_share < 0.5);
    }

    #[test]
    fn when_one_fails_the_satellite_compass_is_believed() {
        let check = ReferenceCheck::new(std::iter::empty(), 0.5);
        let merged = check
            .merge(Some(heading(20.0)), Some(heading(10.0)), 0.0)
            .unwrap();
        assert_eq!(
            merged,
            Reference {
                heading: heading(10.0),
                gyro_share: 0.0
            }
        );
        assert_eq!(check.merge(None, None, 0.0), None);
    }
}
