//! Noise variances of the filter.

use super::states::{LASTING, STATES, VARIATION};
use crate::estimate::POPULATION_SD;
use binnacle_compass::result::NoiseLevels;

/// Noise levels as variances of the filter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoiseVariances {
    pub(crate) white: f64,
    pub(crate) difference_white: f64,
    pub(crate) stationary: [f64; STATES - LASTING],
    pub(crate) turn: f64,
    pub(crate) drift: f64,
}

impl NoiseVariances {
    pub(crate) fn new(levels: &NoiseLevels) -> NoiseVariances {
        let squared = |sd: f64| sd * sd;
        NoiseVariances {
            white: squared(levels.white_deg),
            difference_white: squared(levels.difference_deg),
            stationary: [
                squared(levels.schuler_deg),
                squared(levels.schuler_deg),
                squared(levels.slow_gyro_deg),
                squared(levels.compass_swing_deg),
                squared(levels.variation_deg),
                squared(levels.satellite_deg),
            ],
            turn: squared(levels.turn_deg),
            drift: squared(levels.drift_nt / POPULATION_SD[0]),
        }
    }

    /// Returns the usual variance of the variation's error.
    pub(crate) fn variation(&self) -> f64 {
        self.stationary[VARIATION - LASTING]
    }
}

/// Noise of the variation during a transient: large, and correlated for an hour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TransientNoise {
    /// Variance, degrees squared.
    pub(crate) variance: f64,
    pub(crate) memory_s: f64,
}
