//! How large the errors of reference, compass and variation are.

use serde::{Deserialize, Serialize};

/// How many numbers [`NoiseLevels`] holds.
pub const NOISE_LEVELS: usize = 9;

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
    pub const TYPICAL: NoiseLevels = NoiseLevels {
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
    pub const MEMORYLESS: NoiseLevels = NoiseLevels {
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

    /// The sizes in their order.
    pub fn to_array(self) -> [f64; NOISE_LEVELS] {
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

    /// From the sizes in their order.
    pub fn from_array(a: [f64; NOISE_LEVELS]) -> NoiseLevels {
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
    pub fn row_variance(&self) -> f64 {
        let parts = [
            self.white_deg,
            self.schuler_deg,
            self.slow_gyro_deg,
            self.compass_swing_deg,
            self.variation_deg,
        ];
        parts.map(|sd| sd * sd).iter().sum()
    }
}
