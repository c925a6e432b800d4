//! Errors of watches: the variance of the mean error over four hours on one heading, and
//! the covariance between the watches of a visit.
//!
//! The processes are those of docs/science.md, §7; the means are eq. 16.

use crate::estimate::{COMPASS_SWING_S, SCHULER_DAMPING, SCHULER_PER_S, SLOW_GYRO_S, VARIATION_NM};
use binnacle_compass::coverage::magnetic_latitude_deg;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::EarthField;
use nalgebra::{Complex, Matrix3};

/// Length of a watch, hours.
pub const WATCH_HOURS: f64 = 4.0;
/// Number of watches in a visit, a day apart.
pub const WATCHES: usize = 3;

const WATCH_S: f64 = WATCH_HOURS * 3600.0;
const DAY_S: f64 = 86_400.0;
/// Speed of a ship on passage, knots.
const SPEED_KN: f64 = 12.0;
/// Number of ten-minute rows in a watch.
const ROWS: f64 = WATCH_HOURS * 6.0;
/// Least variance of a mean, degrees squared: a card cannot be read to a hundredth of a
/// degree.
const LEAST_VARIANCE: f64 = 1e-4;

/// Error with a limited memory: its autocorrelation is Re[start · exp(−rate t)].
#[derive(Clone, Copy, Debug)]
struct ErrorMemory {
    start: Complex<f64>,
    rate_per_s: Complex<f64>,
}

impl ErrorMemory {
    fn fading(seconds: f64) -> ErrorMemory {
        ErrorMemory {
            start: Complex::new(1.0, 0.0),
            rate_per_s: Complex::new(1.0 / seconds, 0.0),
        }
    }

    /// Returns the memory of the Schuler swing.
    fn schuler() -> ErrorMemory {
        let damped = (1.0 - SCHULER_DAMPING * SCHULER_DAMPING).sqrt();
        ErrorMemory {
            start: Complex::new(1.0, -SCHULER_DAMPING / damped),
            rate_per_s: Complex::new(SCHULER_DAMPING, -damped) * SCHULER_PER_S,
        }
    }

    /// Returns the variance of a watch's mean, as a part of the error's own.
    fn variance_of_mean(self) -> f64 {
        let x = self.rate_per_s * WATCH_S;
        let share = (x - 1.0 + (-x).exp()) * 2.0 / (x * x);
        (self.start * share).re
    }

    /// Returns the covariance of two watches' means that begin `apart_s` after one another.
    fn covariance_between(self, apart_s: f64) -> f64 {
        let x = self.rate_per_s * WATCH_S;
        // exp(x) itself overflows where the memory is short beside a watch.
        let later = self.rate_per_s * (apart_s - WATCH_S);
        let share = (Complex::new(1.0, 0.0) - (-x).exp()).powi(2) / (x * x);
        (self.start * share * (-later).exp()).re
    }
}

/// Returns the covariance, degrees squared, of the mean errors of a visit's watches in a
/// field; `gyro_share` is 1 where the reference is a gyro, 0 where it is a satellite
/// compass.
pub(super) fn errors_of_watches(
    noise: &NoiseLevels,
    gyro_share: f64,
    earth: EarthField,
) -> Matrix3<f64> {
    // The vessel's place is known as a field only; on average magnetic and geographic
    // latitude are the same.
    let lat = magnetic_latitude_deg(earth.h_nt, earth.z_nt).to_radians();
    let gyro = gyro_share / lat.cos().max(0.17);
    let variation = (24_000.0 / earth.h_nt).clamp(0.5, 4.0);
    let parts = [
        // A watch on another heading begins with a turn.
        (
            noise.schuler_deg.hypot(noise.turn_deg) * gyro,
            ErrorMemory::schuler(),
        ),
        (noise.slow_gyro_deg * gyro, ErrorMemory::fading(SLOW_GYRO_S)),
        (
            noise.compass_swing_deg,
            ErrorMemory::fading(COMPASS_SWING_S),
        ),
        (
            noise.variation_deg * variation,
            ErrorMemory::fading(VARIATION_NM / SPEED_KN * 3600.0),
        ),
    ];
    let sum = |of: &dyn Fn(ErrorMemory) -> f64| -> f64 {
        parts.iter().map(|(sd, memory)| sd * sd * of(*memory)).sum()
    };
    let own = sum(&ErrorMemory::variance_of_mean) + noise.white_deg.powi(2) / ROWS + LEAST_VARIANCE;
    let shared = |days: f64| sum(&|memory: ErrorMemory| memory.covariance_between(days * DAY_S));
    let (next_day, day_after) = (shared(1.0), shared(2.0));
    Matrix3::new(
        own, next_day, day_after, //
        next_day, own, next_day, //
        day_after, next_day, own,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the mean's variance as a sum over pairs of minutes.
    fn by_the_minute(memory: ErrorMemory, apart_s: f64) -> f64 {
        let minutes = (WATCH_S / 60.0) as i32;
        let correlation = |t: f64| (memory.start * (-memory.rate_per_s * t).exp()).re;
        let mut sum = 0.0;
        for i in 0..minutes {
            for j in 0..minutes {
                sum += correlation((apart_s + 60.0 * f64::from(i - j)).abs());
            }
        }
        sum / f64::from(minutes).powi(2)
    }

    #[test]
    fn means_vary_as_their_minutes_say() {
        let day = 3.0 * DAY_S;
        for memory in [
            ErrorMemory::schuler(),
            ErrorMemory::fading(day),
            ErrorMemory::fading(18_000.0),
            ErrorMemory::fading(1200.0),
        ] {
            assert!((memory.variance_of_mean() - by_the_minute(memory, 0.0)).abs() < 1e-3);
            for days in [1.0, 2.0] {
                let between = memory.covariance_between(days * DAY_S);
                let expected = by_the_minute(memory, days * DAY_S);
                assert!((between - expected).abs() < 1e-4, "{between} {expected}");
            }
        }
    }

    #[test]
    fn a_gyro_repeats_itself_and_a_satellite_compass_does_not() {
        let noise = NoiseLevels {
            white_deg: 0.25,
            schuler_deg: 0.2,
            turn_deg: 0.3,
            slow_gyro_deg: 0.3,
            compass_swing_deg: 0.25,
            variation_deg: 0.2,
            drift_nt: 60.0,
            satellite_deg: 0.2,
            difference_deg: 0.2,
            drift_angle_deg: 0.0,
        };
        let earth = EarthField {
            h_nt: 20_000.0,
            z_nt: 45_000.0,
        };
        let gyro = errors_of_watches(&noise, 1.0, earth);
        let satellite = errors_of_watches(&noise, 0.0, earth);
        assert!(gyro[(0, 1)] > 0.3 * gyro[(0, 0)], "{gyro}");
        assert!(satellite[(0, 1)] < 0.05 * satellite[(0, 0)], "{satellite}");
        assert!(satellite[(0, 0)] < 0.5 * gyro[(0, 0)]);
        assert!(gyro.cholesky().is_some());
    }
}
