//! Noise levels of reference, compass and variation.

use serde::{Deserialize, Serialize};

/// Number of values in [`NoiseLevels`] that the estimator learns.
pub const NOISE_LEVELS: usize = 9;

/// Standard deviations of the errors, degrees unless the name has another unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseLevels {
    /// White noise of a row: a ten-minute mean of 60 windows with a scatter of 0.5°.
    pub white_deg: f64,
    /// Gyro's Schuler oscillation on a steady course at the equator; proportional to
    /// 1/cos(latitude).
    pub schuler_deg: f64,
    /// Increase of the Schuler oscillation by a turn of over 20°, at the equator.
    #[serde(default)]
    pub turn_deg: f64,
    /// Gyro's slow drift at the equator; proportional to 1/cos(latitude).
    pub slow_gyro_deg: f64,
    /// Compass's oscillation over some twenty minutes.
    pub compass_swing_deg: f64,
    /// Error of variation over some sixty miles, where H is 24 µT.
    pub variation_deg: f64,
    /// Drift of bx and by in thirty days, nT.
    pub drift_nt: f64,
    /// Satellite compass's error over some thirty minutes.
    #[serde(default)]
    pub satellite_deg: f64,
    /// White noise of the difference of gyro and satellite compass.
    #[serde(default)]
    pub difference_deg: f64,
    /// Drift angle by current and wind about its mean, of a ship whose reference is her course
    /// over ground; zero otherwise.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub drift_angle_deg: f64,
}

// By reference, as serde calls it.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(deg: &f64) -> bool {
    deg.abs() < f64::MIN_POSITIVE
}

impl NoiseLevels {
    /// Average levels, the starting point of the estimation.
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
        drift_angle_deg: 0.0,
    };

    /// Levels for rows without times, whose correlations are unknown.
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
        drift_angle_deg: 0.0,
    };

    /// Returns the levels that the estimator learns, in the order of the fields.
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

    /// Makes the levels of a heading reference from an array in the order of the fields.
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
            drift_angle_deg: 0.0,
        }
    }

    /// Returns the total variance of a single row, degrees squared.
    pub fn row_variance(&self) -> f64 {
        let parts = [
            self.white_deg,
            self.schuler_deg,
            self.slow_gyro_deg,
            self.compass_swing_deg,
            self.variation_deg,
            self.drift_angle_deg,
        ];
        parts.map(|sd| sd * sd).iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_of_a_heading_reference_are_stored_without_a_drift_angle() {
        let stored = serde_json::to_value(NoiseLevels::TYPICAL).unwrap();
        assert_eq!(stored.get("drift_angle_deg"), None);
        let read: NoiseLevels = serde_json::from_value(stored).unwrap();
        assert_eq!(read, NoiseLevels::TYPICAL);
    }
}
