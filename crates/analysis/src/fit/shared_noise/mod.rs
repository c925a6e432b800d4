//! Reference headings that are the compass's own: a true heading made from the magnetic one
//! by adding the variation, or the compass's reading under another name.
//!
//! Such a reference agrees with the compass however wrong the compass is, so that a fit finds
//! no deviation, and a narrow band. A small deviation is no proof of it: a well adjusted
//! compass has one, too. What gives it away is shared noise. Card, sensor and gyro err each by
//! itself, and each reading is rounded by itself, so that the difference of independent
//! instruments scatters about any smooth curve of deviation. A copy's difference scatters by
//! no more than its digits. The two explanations are compared by their likelihoods, row by row
//! and by the means of courses.

mod courses;
mod curve;
mod digits;
mod likelihood;
mod pair;

use binnacle_compass::result::FitError;
use courses::weigh_courses;
use curve::residuals;
use digits::digits_deg;
use likelihood::{Digits, Evidence, weigh};
pub use pair::HeadingPair;
use std::collections::BTreeSet;

/// Least number of pairs on different readings: several for each unknown of the curve.
const NEEDED_PAIRS: usize = 40;
/// Greatest number of pairs that are weighed.
const ENOUGH_PAIRS: usize = 2000;
/// Least turn of the compass between pairs, degrees: on one heading even independent
/// instruments may show the same digits for hours.
const LEAST_TURN_DEG: f64 = 0.05;
/// Width of the sectors of heading whose pairs count as one observation, degrees: rows on one
/// heading share their slow errors and their rounding.
const SECTOR_DEG: f64 = 1.0;
/// Log-likelihood ratio from which the noise is shared: ln 10⁴. By chance a likelihood ratio
/// exceeds k with a probability of 1/k at most, so that of ten thousand ships with independent
/// instruments one is refused.
const THRESHOLD: f64 = 9.2;

/// Checks that a reference has its own noise, by pairs of compass and reference in any order.
/// Few pairs, or pairs on few headings, show nothing and pass.
///
/// # Errors
/// [`FitError::ReferenceIsCompass`].
pub fn check_independence(pairs: &[HeadingPair]) -> Result<(), FitError> {
    let sorted = sorted(pairs);
    let either = [weigh_independence(&sorted), weigh_courses(&sorted)];
    let Some(evidence) = either.into_iter().flatten().find(SharedNoise::is_shared) else {
        return Ok(());
    };
    Err(FitError::ReferenceIsCompass {
        samples: pairs.len() as u64,
        scatter_deg: evidence.scatter_deg,
        least_deg: evidence.least_deg,
    })
}

/// Evidence that compass and reference share their noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedNoise {
    /// Mean log-likelihood of a pair if the noise is shared.
    shared: f64,
    /// Mean log-likelihood of a pair if it is independent.
    independent: f64,
    /// Number of degrees of heading with pairs, each of which counts as one observation.
    sectors: f64,
    /// Scatter of the differences about the curve, degrees.
    pub scatter_deg: f64,
    /// Least scatter of independent instruments with these digits, degrees.
    pub least_deg: f64,
}

impl SharedNoise {
    /// Returns the log-likelihood ratio of shared to independent noise.
    pub fn log_ratio(&self) -> f64 {
        (self.shared - self.independent) * self.sectors
    }

    /// Returns the evidence where each shared reading was chosen among some of the compass, and
    /// `latest` has the pairs with the latest one. The choice costs its logarithm.
    #[must_use]
    pub fn of_choice(self, latest: SharedNoise, mean_log_choices: f64) -> SharedNoise {
        SharedNoise {
            shared: (self.shared - mean_log_choices).max(latest.shared),
            ..latest
        }
    }

    /// Returns whether the noise is shared: of ten thousand independent references one is.
    pub fn is_shared(&self) -> bool {
        self.log_ratio() > THRESHOLD
    }

    /// Returns whether the noise is independent, as certainly as that.
    pub fn is_independent(&self) -> bool {
        self.log_ratio() < -THRESHOLD
    }

    /// Returns whether the readings are more like those of independent instruments than not.
    pub fn favours_independence(&self) -> bool {
        self.log_ratio() < 0.0
    }
}

/// Weighs shared against independent noise, by pairs of compass and reference in any order;
/// none where there are too few of them.
pub fn weigh_independence(pairs: &[HeadingPair]) -> Option<SharedNoise> {
    let sorted = sorted(pairs);
    let digits = digits(&sorted);
    let chosen = turned_pairs(&sorted, digits.compass_deg.max(LEAST_TURN_DEG));
    if chosen.len() < NEEDED_PAIRS {
        return None;
    }
    let residuals = residuals(&sorted, &chosen)?;
    let sectors: BTreeSet<i64> = chosen
        .iter()
        .map(|&i| (sorted[i].compass_deg() / SECTOR_DEG) as i64)
        .collect();
    let Evidence {
        shared,
        independent,
        scatter_deg,
    } = weigh(&residuals, digits);
    Some(SharedNoise {
        shared,
        independent,
        sectors: sectors.len() as f64,
        scatter_deg,
        least_deg: likelihood::least_scatter_deg(digits),
    })
}

/// Returns the digits of both instruments.
fn digits(pairs: &[HeadingPair]) -> Digits {
    let digits_of = |reading: fn(&HeadingPair) -> f64| {
        let readings: Vec<f64> = pairs.iter().map(reading).collect();
        digits_deg(&readings)
    };
    Digits {
        compass_deg: digits_of(HeadingPair::compass_deg),
        // A correction of the speed error hides them.
        reference_deg: digits_of(HeadingPair::reference_deg)
            .max(digits_of(HeadingPair::raw_reference_deg)),
    }
}

/// Returns pairs in order of time.
fn sorted(pairs: &[HeadingPair]) -> Vec<HeadingPair> {
    let mut sorted = pairs.to_vec();
    sorted.sort_by(|a, b| (a.time.cmp(&b.time)).then(a.compass_deg().total_cmp(&b.compass_deg())));
    sorted
}

/// Returns the places of enough pairs between which the compass turned.
fn turned_pairs(sorted: &[HeadingPair], turn_deg: f64) -> Vec<usize> {
    let mut last: Option<f64> = None;
    let mut turned = Vec::new();
    for (place, pair) in sorted.iter().enumerate() {
        let compass = pair.compass_deg();
        // Half a digit allows for the rounding of the digits themselves.
        let has_turned = last.is_none_or(|last| {
            binnacle_compass::angle::wrap_180(compass - last).abs() > turn_deg / 2.0
        });
        if has_turned {
            turned.push(place);
            last = Some(compass);
        }
    }
    let every = turned.len().div_ceil(ENOUGH_PAIRS).max(1);
    turned.into_iter().step_by(every).collect()
}
