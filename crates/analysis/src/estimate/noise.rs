//! The errors of reference, compass and variation as a stochastic process.
//!
//! Nine sizes say how large each is; how long each lasts is known well enough
//! from the instruments' physics to be fixed.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Dynamic states: Schuler swing and its rate, slow gyro error, compass swing,
/// variation error, the satellite compass's error, drift of bx and of by.
pub(crate) const STATES: usize = 8;
/// Where bx's drift stands; by's follows.
pub(crate) const DRIFT: usize = 6;
/// Sizes of noise.
pub(crate) const LEVELS: usize = 9;

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

/// Standard deviations of the errors, degrees unless the name says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseLevels {
    /// What is new in every row: a ten-minute mean of 60 windows that scattered by 0.5°.
    pub white_deg: f64,
    /// The gyro's Schuler swing at the equator while she keeps her course; it
    /// grows as 1/cos(latitude).
    pub schuler_deg: f64,
    /// What a turn of over 20° adds to the swing at the equator.
    #[serde(default)]
    pub turn_deg: f64,
    /// The gyro's slow wander at the equator; it grows as 1/cos(latitude).
    pub slow_gyro_deg: f64,
    /// The compass's swing over some twenty minutes.
    pub compass_swing_deg: f64,
    /// The error of variation over some sixty miles, where H is 24 µT.
    pub variation_deg: f64,
    /// How far bx and by wander in thirty days, nT.
    pub drift_nt: f64,
    /// The satellite compass's error over some thirty minutes.
    #[serde(default)]
    pub satellite_deg: f64,
    /// What is new in every difference of gyro and satellite compass.
    #[serde(default)]
    pub difference_deg: f64,
}

impl NoiseLevels {
    /// What ships have on the average; the data move it from here.
    pub(crate) const TYPICAL: NoiseLevels = NoiseLevels {
        white_deg: 0.2,
        schuler_deg: 0.2,
        turn_deg: 0.4,
        slow_gyro_deg: 0.3,
        compass_swing_deg: 0.2,
        variation_deg: 0.2,
        drift_nt: 60.0,
        satellite_deg: 0.2,
        difference_deg: 0.2,
    };

    /// For rows without times, which cannot show any memory.
    pub(crate) const MEMORYLESS: NoiseLevels = NoiseLevels {
        white_deg: 0.5,
        schuler_deg: 0.0,
        turn_deg: 0.0,
        slow_gyro_deg: 0.0,
        compass_swing_deg: 0.0,
        variation_deg: 0.0,
        drift_nt: 0.0,
        satellite_deg: 0.0,
        difference_deg: 0.5,
    };

    pub(crate) fn to_array(self) -> [f64; LEVELS] {
        [
            self.white_deg,
            self.schuler_deg,
            self.turn_deg,
            self.slow_gyro_deg,
            self.compass_swing_deg,
            self.variation_deg,
            self.drift_nt,
            self.satellite_deg,
            self.difference_deg,
        ]
    }

    pub(crate) fn from_array(a: [f64; LEVELS]) -> NoiseLevels {
        NoiseLevels {
            white_deg: a[0],
            schuler_deg: a[1],
            turn_deg: a[2],
            slow_gyro_deg: a[3],
            compass_swing_deg: a[4],
            variation_deg: a[5],
            drift_nt: a[6],
            satellite_deg: a[7],
            difference_deg: a[8],
        }
    }

    /// Variance of a single row, degrees squared, all its errors together.
    pub(crate) fn of_a_row(&self) -> f64 {
        let parts = [
            self.white_deg,
            self.schuler_deg,
            self.slow_gyro_deg,
            self.compass_swing_deg,
            self.variation_deg,
        ];
        parts.map(|sd| sd * sd).iter().sum()
    }

    /// Stationary variances of the states; the drift's is zero where the filter
    /// begins, for it is counted from there.
    pub(crate) fn initial_variances(&self) -> [f64; STATES] {
        [
            self.schuler_deg.powi(2),
            self.schuler_deg.powi(2),
            self.slow_gyro_deg.powi(2),
            self.compass_swing_deg.powi(2),
            self.variation_deg.powi(2),
            self.satellite_deg.powi(2),
            0.0,
            0.0,
        ]
    }
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
