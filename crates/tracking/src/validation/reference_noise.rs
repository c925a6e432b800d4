//! Errors of reference, card and chart in the mean of a course, by the levels that were learnt.

use super::residual::Residual;
use crate::state_space::states::USUAL_H_NT;
use crate::state_space::transition::DRIFT_S;
use binnacle_analysis::estimate::{COMPASS_SWING_S, SATELLITE_S, SLOW_GYRO_S};
use binnacle_compass::result::{Epoch, NoiseLevels, PredictionCoverage};
use binnacle_compass::time::Timestamp;

/// Memory of a gyro's Schuler swing, seconds: its period over 2π and the damping of 0.2.
const SCHULER_S: f64 = 84.4 * 60.0 / (std::f64::consts::TAU * 0.2);
/// Windows of ten seconds in a full row.
const FULL_WINDOWS: f64 = 60.0;

/// Noise of the courses that a model is held against.
pub(super) struct ReferenceNoise {
    levels: NoiseLevels,
    /// Time of the model.
    model_at: Option<Timestamp>,
    /// Factor of all variances by the predictions that the model was made from.
    scale: f64,
}

impl ReferenceNoise {
    pub(super) fn new(learnt: &Epoch, check: Option<PredictionCoverage>) -> ReferenceNoise {
        ReferenceNoise {
            levels: learnt.noise.unwrap_or(NoiseLevels::TYPICAL),
            model_at: learnt.data_until,
            scale: check.map_or(1.0, |check| check.widening.powi(2)),
        }
    }

    /// Returns the variance of a course's mean, degrees squared, the model's own aside. The ship's
    /// drift between the model and the course is in it.
    pub(super) fn variance(&self, course: &[Residual<'_>]) -> f64 {
        let (Some(first), Some(last)) = (course.first(), course.last()) else {
            return 0.0;
        };
        let (first_sample, last_sample) = (&first.sample.sample, &last.sample.sample);
        let seconds = last_sample.time.seconds_since(first_sample.time);
        let lasting = |sd: f64, memory_s: f64| sd * sd * mean_share(seconds / memory_s);
        let levels = &self.levels;
        let reference = if levels.drift_angle_deg > 0.0 {
            // Within a course of four hours, current and leeway hardly change.
            levels.drift_angle_deg.powi(2)
        } else if first_sample.satellite.is_some() {
            lasting(levels.satellite_deg, SATELLITE_S)
        } else {
            let cos_lat = first_sample.position.lat_deg().to_radians().cos().max(0.05);
            (lasting(levels.schuler_deg, SCHULER_S) + lasting(levels.slow_gyro_deg, SLOW_GYRO_S))
                / (cos_lat * cos_lat)
        };
        let variation = levels.variation_deg * USUAL_H_NT / first.h_nt;
        let windows: f64 = course
            .iter()
            .map(|r| f64::from(r.sample.sample.windows))
            .sum();
        let since_s = self
            .model_at
            .map_or(0.0, |at| first_sample.time.seconds_since(at).abs());
        let drift_deg = (levels.drift_nt / first.h_nt).to_degrees();
        let variance = reference
            + lasting(levels.compass_swing_deg, COMPASS_SWING_S)
            + variation * variation
            + levels.white_deg.powi(2) * FULL_WINDOWS / windows.max(1.0)
            + drift_deg * drift_deg * since_s / DRIFT_S;
        self.scale * variance
    }
}

/// Returns the share of an error's variance that is left in its mean over so many memories:
/// 2 (x − 1 + e^(−x))/x² (docs/science.md, eq. 16).
fn mean_share(memories: f64) -> f64 {
    if memories < 1e-3 {
        return 1.0;
    }
    2.0 * (memories - 1.0 + (-memories).exp()) / (memories * memories)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_over_many_memories_keeps_two_memories_of_the_variance() {
        assert!((mean_share(0.0) - 1.0).abs() < 1e-12);
        assert!((mean_share(2e-3) - 1.0).abs() < 1e-3);
        assert!((mean_share(1000.0) - 0.002).abs() < 1e-5);
    }
}
