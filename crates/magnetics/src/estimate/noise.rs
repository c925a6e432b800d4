//! The errors of reference, compass and variation as a stochastic process.
//!
//! Six sizes say how large each is; how long each lasts is known well enough
//! from the instruments' physics to be fixed.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Dynamic states: Schuler swing and its rate, slow gyro error, compass swing,
/// variation error, drift of bx and of by.
pub(crate) const STATES: usize = 7;

/// Schuler's period, 84.4 minutes, as an angular frequency.
const SCHULER_PER_S: f64 = TAU / (84.4 * 60.0);
/// A gyro's north-settling damps the swing by about this part of critical.
const SCHULER_DAMPING: f64 = 0.2;
/// How long the gyro's settling point stays where it is.
const SLOW_GYRO_S: f64 = 3.0 * 86_400.0;
/// How long the compass swings about a wrong mean after disturbance.
const COMPASS_SWING_S: f64 = 20.0 * 60.0;
/// How far the crust's own field stays the same.
const VARIATION_NM: f64 = 60.0;
/// The days in which drift is counted.
const DRIFT_S: f64 = 30.0 * 86_400.0;

/// Standard deviations of the errors, degrees unless the name says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseLevels {
    /// What is new in every row: a ten-minute mean of 60 windows.
    pub white_deg: f64,
    /// The gyro's Schuler swing at the equator; it grows as 1/cos(latitude).
    pub schuler_deg: f64,
    /// The gyro's slow wander at the equator; it grows as 1/cos(latitude).
    pub slow_gyro_deg: f64,
    /// The compass's swing over some twenty minutes.
    pub compass_swing_deg: f64,
    /// The error of variation over some sixty miles, where H is 24 µT.
    pub variation_deg: f64,
    /// How far bx and by wander in thirty days, nT.
    pub drift_nt: f64,
}

impl NoiseLevels {
    /// What ships have on the average; the data move it from here.
    pub(crate) const TYPICAL: NoiseLevels = NoiseLevels {
        white_deg: 0.25,
        schuler_deg: 0.35,
        slow_gyro_deg: 0.3,
        compass_swing_deg: 0.25,
        variation_deg: 0.2,
        drift_nt: 60.0,
    };

    /// For rows without times, which cannot show any memory.
    pub(crate) const MEMORYLESS: NoiseLevels = NoiseLevels {
        white_deg: 0.5,
        schuler_deg: 0.0,
        slow_gyro_deg: 0.0,
        compass_swing_deg: 0.0,
        variation_deg: 0.0,
        drift_nt: 0.0,
    };

    pub(crate) fn to_array(self) -> [f64; 6] {
        [
            self.white_deg,
            self.schuler_deg,
            self.slow_gyro_deg,
            self.compass_swing_deg,
            self.variation_deg,
            self.drift_nt,
        ]
    }

    pub(crate) fn from_array(a: [f64; 6]) -> NoiseLevels {
        NoiseLevels {
            white_deg: a[0],
            schuler_deg: a[1],
            slow_gyro_deg: a[2],
            compass_swing_deg: a[3],
            variation_deg: a[4],
            drift_nt: a[5],
        }
    }

    /// Stationary variances of the states; the drift's is zero where the filter
    /// begins, for there the parameters are what is asked for.
    pub(crate) fn initial_variances(&self) -> [f64; STATES] {
        [
            self.schuler_deg.powi(2),
            self.schuler_deg.powi(2),
            self.slow_gyro_deg.powi(2),
            self.compass_swing_deg.powi(2),
            self.variation_deg.powi(2),
            0.0,
            0.0,
        ]
    }
}

/// How the states go over from one row to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transition {
    /// The Schuler pair's 2 × 2 matrix; the rate is in units of the swing, so
    /// that both have the same variance.
    pub(crate) schuler: [[f64; 2]; 2],
    /// What is left of slow gyro error, compass swing and variation error.
    pub(crate) decay: [f64; 3],
    /// The step as part of thirty days.
    pub(crate) drift_share: f64,
}

impl Transition {
    /// Over `seconds` and `miles`, both not negative.
    pub(crate) fn over(seconds: f64, miles: f64) -> Transition {
        let phase = SCHULER_PER_S * seconds;
        let damped = (1.0 - SCHULER_DAMPING * SCHULER_DAMPING).sqrt();
        let shrink = (-SCHULER_DAMPING * phase).exp();
        let (sin, cos) = (damped * phase).sin_cos();
        let (sin, cos) = (shrink * sin / damped, shrink * cos);
        Transition {
            schuler: [
                [cos + SCHULER_DAMPING * sin, sin],
                [-sin, cos - SCHULER_DAMPING * sin],
            ],
            decay: [
                (-seconds / SLOW_GYRO_S).exp(),
                (-seconds / COMPASS_SWING_S).exp(),
                (-miles / VARIATION_NM).exp(),
            ],
            drift_share: seconds / DRIFT_S,
        }
    }
}
