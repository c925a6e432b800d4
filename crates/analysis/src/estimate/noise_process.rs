//! Errors of reference, compass and variation as a stochastic process.
//!
//! Nine levels give their sizes; their durations are known well enough from the
//! instruments' physics to be constants.

use binnacle_compass::result::{NOISE_LEVELS, NoiseLevels};
use std::f64::consts::TAU;

/// Number of dynamic states: Schuler swing and its rate, slow gyro error, compass swing,
/// variation error, the satellite compass's error, drift of bx and of by.
pub(crate) const STATES: usize = 8;
/// Index of the drift of bx; that of by follows.
pub(crate) const DRIFT: usize = 6;
/// Number of noise levels.
pub(crate) const LEVELS: usize = NOISE_LEVELS;

/// Schuler's period, 84.4 minutes, as an angular frequency.
pub(crate) const SCHULER_PER_S: f64 = TAU / (84.4 * 60.0);
/// Damping of the swing by a gyro's settling, as a part of the critical one.
pub(crate) const SCHULER_DAMPING: f64 = 0.2;
/// Correlation time of the gyro's settling point.
pub const SLOW_GYRO_S: f64 = 3.0 * 86_400.0;
/// Correlation time of the compass's swing about a wrong mean after a disturbance.
pub const COMPASS_SWING_S: f64 = 20.0 * 60.0;
/// Correlation time of a satellite compass's reflections.
pub const SATELLITE_S: f64 = 30.0 * 60.0;
/// Correlation distance of the crust's own field.
pub const VARIATION_NM: f64 = 60.0;
/// Time for which the drift level holds.
const DRIFT_S: f64 = 30.0 * 86_400.0;
/// Greatest time since a turn when the vessel has settled again.
const SETTLED_S: f64 = 900.0;

/// Returns the stationary variances of the states; the drift's is zero, because it counts
/// from the first row.
pub(crate) fn initial_variances(levels: &NoiseLevels) -> [f64; STATES] {
    [
        levels.schuler_deg.powi(2),
        levels.schuler_deg.powi(2),
        levels.slow_gyro_deg.powi(2),
        levels.compass_swing_deg.powi(2),
        levels.variation_deg.powi(2),
        levels.satellite_deg.powi(2),
        0.0,
        0.0,
    ]
}

/// Transition of the states from one row to the next: [`TimeStep::transition`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transition {
    /// The Schuler pair's 2 × 2 matrix; the rate is in units of the swing, so that both
    /// have the same variance.
    pub(crate) schuler: [[f64; 2]; 2],
    /// Remaining shares of slow gyro error, compass swing, variation error and satellite
    /// compass's error.
    pub(crate) decay: [f64; 4],
    /// Effect on the swing and its rate of a turn since the previous row.
    pub(crate) since_turn: Option<[f64; 2]>,
    /// Length of the step as a part of thirty days.
    pub(crate) drift_share: f64,
}

/// Part of a transition that depends on time alone. Most rows are equally far apart, and
/// reuse it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimeStep {
    seconds: f64,
    /// Transition without distance and turn.
    still: Transition,
}

impl TimeStep {
    /// Makes the step of `seconds`, not negative.
    pub(crate) fn new(seconds: f64) -> TimeStep {
        let still = Transition {
            schuler: swing_over(seconds),
            decay: [
                (-seconds / SLOW_GYRO_S).exp(),
                (-seconds / COMPASS_SWING_S).exp(),
                1.0,
                (-seconds / SATELLITE_S).exp(),
            ],
            since_turn: None,
            drift_share: seconds / DRIFT_S,
        };
        TimeStep { seconds, still }
    }

    /// Returns this step, or a new one if `seconds` differs.
    pub(crate) fn for_seconds(self, seconds: f64) -> TimeStep {
        if seconds.to_bits() == self.seconds.to_bits() {
            self
        } else {
            TimeStep::new(seconds)
        }
    }

    /// Returns the transition over a distance, with a turn or without.
    pub(crate) fn transition(&self, miles: f64, turned: bool) -> Transition {
        let mut transition = self.still;
        transition.decay[2] = (-miles / VARIATION_NM).exp();
        transition.since_turn = turned.then(|| {
            let [[_, swing], [_, rate]] = swing_over(self.seconds.min(SETTLED_S));
            [swing, rate]
        });
        transition
    }
}

/// Returns the damped swing and its rate (in units of the swing) after `seconds`.
pub fn swing_over(seconds: f64) -> [[f64; 2]; 2] {
    let phase = SCHULER_PER_S * seconds;
    let damped = (1.0 - SCHULER_DAMPING * SCHULER_DAMPING).sqrt();
    let shrink = (-SCHULER_DAMPING * phase).exp();
    let (sin, cos) = (damped * phase).sin_cos();
    let (sin, cos) = (shrink * sin / damped, shrink * cos);
    [
        [cos + SCHULER_DAMPING * sin, sin],
        [-sin, cos - SCHULER_DAMPING * sin],
    ]
}
