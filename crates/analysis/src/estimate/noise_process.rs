//! The errors of reference, compass and variation as a stochastic process.
//!
//! Nine sizes say how large each is; how long each lasts is known well enough
//! from the instruments' physics to be fixed.

use binnacle_compass::result::{NOISE_LEVELS, NoiseLevels};
use std::f64::consts::TAU;

/// Dynamic states: Schuler swing and its rate, slow gyro error, compass swing,
/// variation error, the satellite compass's error, drift of bx and of by.
pub(crate) const STATES: usize = 8;
/// Where bx's drift stands; by's follows.
pub(crate) const DRIFT: usize = 6;
/// Sizes of noise.
pub(crate) const LEVELS: usize = NOISE_LEVELS;

/// Schuler's period, 84.4 minutes, as an angular frequency.
pub(crate) const SCHULER_PER_S: f64 = TAU / (84.4 * 60.0);
/// A gyro's north-settling damps the swing by about this part of critical.
pub(crate) const SCHULER_DAMPING: f64 = 0.2;
/// How long the gyro's settling point stays where it is.
pub(crate) const SLOW_GYRO_S: f64 = 3.0 * 86_400.0;
/// How long the compass swings about a wrong mean after disturbance.
pub(crate) const COMPASS_SWING_S: f64 = 20.0 * 60.0;
/// How long a satellite compass's antennas hear the same reflections.
const SATELLITE_S: f64 = 30.0 * 60.0;
/// How far the crust's own field stays the same.
pub(crate) const VARIATION_NM: f64 = 60.0;
/// The days in which drift is counted.
const DRIFT_S: f64 = 30.0 * 86_400.0;
/// A turn lies no further back than this when the ship has settled again.
const SETTLED_S: f64 = 900.0;

/// Stationary variances of the states; the drift's is zero where the filter
/// begins, for it is counted from there.
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

/// How the states go over from one row to the next: [`Step::sailing`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transition {
    /// The Schuler pair's 2 × 2 matrix; the rate is in units of the swing, so
    /// that both have the same variance.
    pub(crate) schuler: [[f64; 2]; 2],
    /// What is left of slow gyro error, compass swing, variation error and
    /// satellite compass's error.
    pub(crate) decay: [f64; 4],
    /// What has become of a swing's rate since the turn before, if she turned.
    pub(crate) since_turn: Option<[f64; 2]>,
    /// The step as part of thirty days.
    pub(crate) drift_share: f64,
}

/// What a time alone says of a transition. Most rows are equally far apart, and what
/// was worked out for one serves the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    seconds: f64,
    /// Of a step without miles and turn.
    still: Transition,
}

impl Step {
    /// Over `seconds`, not negative.
    pub(crate) fn over(seconds: f64) -> Step {
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
        Step { seconds, still }
    }

    /// The same, or one over `seconds` if that is another time.
    pub(crate) fn again(self, seconds: f64) -> Step {
        if seconds.to_bits() == self.seconds.to_bits() {
            self
        } else {
            Step::over(seconds)
        }
    }

    /// With so many miles sailed, and a turn or none.
    pub(crate) fn sailing(&self, miles: f64, turned: bool) -> Transition {
        let mut transition = self.still;
        transition.decay[2] = (-miles / VARIATION_NM).exp();
        transition.since_turn = turned.then(|| {
            let [[_, swing], [_, rate]] = swing_over(self.seconds.min(SETTLED_S));
            [swing, rate]
        });
        transition
    }
}

/// The damped swing and its rate (in units of the swing) after `seconds`.
fn swing_over(seconds: f64) -> [[f64; 2]; 2] {
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
