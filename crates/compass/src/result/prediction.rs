//! Check of an analysis by its own predictions: each reading is predicted before it is used.

use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Share of readings that a right 95 % band leaves outside.
const OUTSIDE: f64 = 0.05;
/// Probability of a count below, or above, the range of chance.
const TAIL: f64 = 0.025;

/// Readings that were predicted before they were used, and the share inside the 95 % band.
///
/// Rows minutes apart share their errors. A watch is therefore the unit that counts: the rows
/// on one heading, four hours at most, predicted from all that was known before its first
/// row. Watches are independent of each other where the band is right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PredictionCoverage {
    /// Rows that were predicted from the rows before.
    #[cfg_attr(feature = "openapi", schema(example = 4210))]
    pub rows: u64,
    /// Rows inside their 95 % band, the noise of a row in it.
    #[cfg_attr(feature = "openapi", schema(example = 4003))]
    pub rows_inside: u64,
    /// Latest watches that were predicted, at most a hundred.
    #[cfg_attr(feature = "openapi", schema(example = 100))]
    pub watches: u32,
    /// Watches whose mean lay inside its 95 % band.
    #[cfg_attr(feature = "openapi", schema(example = 94))]
    pub watches_inside: u32,
    /// Fewest watches inside that a right band may have by chance, at 95 %.
    #[cfg_attr(feature = "openapi", schema(example = 90))]
    pub expected_from: u32,
    /// Most watches inside that a right band may have by chance, at 95 %.
    #[cfg_attr(feature = "openapi", schema(example = 99))]
    pub expected_to: u32,
    /// Watches left out: they lie between a reported change, or fault of an instrument, and its
    /// detection.
    #[cfg_attr(feature = "openapi", schema(example = 2))]
    pub watches_disturbed: u32,
    /// Mean square of the watches' errors over their predicted variance, each at most 9; 1 is
    /// right.
    #[cfg_attr(feature = "openapi", schema(example = 1.05))]
    pub mean_square: f64,
    /// Factor by which the band of the current model was widened; never below 1.
    #[cfg_attr(feature = "openapi", schema(example = 1.0))]
    pub widening: f64,
}

impl PredictionCoverage {
    /// Returns true if fewer watches are inside than chance explains.
    pub fn falls_short(&self) -> bool {
        self.watches_inside < self.expected_from
    }
}

/// Returns the numbers inside a right 95 % band that are usual among so many independent
/// readings: fewer, or more, are seen once in forty times (binomial distribution).
pub fn expected_inside(readings: u32) -> RangeInclusive<u32> {
    let n = f64::from(readings);
    let odds = (OUTSIDE / (1.0 - OUTSIDE)).ln();
    let mut log_probability = n * (1.0 - OUTSIDE).ln();
    let mut below = 0.0;
    let (mut fewest_outside, mut most_outside) = (None, readings);
    for outside in 0..=readings {
        let probability = log_probability.exp();
        if fewest_outside.is_none() && below + probability > TAIL {
            fewest_outside = Some(outside);
        }
        below += probability;
        if below >= 1.0 - TAIL {
            most_outside = outside;
            break;
        }
        let k = f64::from(outside);
        log_probability += odds + ((n - k) / (k + 1.0)).ln();
    }
    readings - most_outside..=readings - fewest_outside.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_chance_is_that_of_the_binomial_distribution() {
        // Tables of the binomial distribution, p 0.05: of 20 P(more than 3) is 0.016, of 100
        // P(more than 10) is 0.011 and P(none) 0.006, P(1 or none) 0.037.
        assert_eq!(expected_inside(0), 0..=0);
        assert_eq!(expected_inside(1), 0..=1);
        assert_eq!(expected_inside(20), 17..=20);
        assert_eq!(expected_inside(100), 90..=99);
    }

    #[test]
    fn the_range_of_very_many_readings_is_near_ninety_five_per_cent() {
        let range = expected_inside(100_000);
        assert!(
            *range.start() > 94_800 && *range.end() < 95_200,
            "{range:?}"
        );
        assert!(range.contains(&95_000));
    }

    #[test]
    fn a_result_stored_without_the_check_has_an_empty_one() {
        let empty = PredictionCoverage::default();
        assert!(!empty.falls_short());
        assert!(
            PredictionCoverage {
                expected_from: 90,
                watches_inside: 89,
                ..empty
            }
            .falls_short()
        );
    }
}
