//! `[silence]`: age up to which readings serve, for sampling and for steering.

use super::seconds::PositiveSeconds;
use serde::Deserialize;
use std::time::Duration;

/// Intervals of the compass that it may miss.
const STEERING_INTERVALS: f64 = 3.0;

/// Age up to which readings serve.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SilenceConfig {
    /// Sampling: seconds of GNSS time after which the next source is used.
    pub stale_s: PositiveSeconds,
    /// Steering: seconds after the compass's last reading, or three of its own intervals.
    pub steering_s: PositiveSeconds,
    /// Other times of single roles.
    pub compass: SteeringRoleSilence,
    /// Gyro compass.
    pub gyro: RoleSilence,
    /// Satellite compass.
    pub satellite: RoleSilence,
    /// Position, speed and GNSS time.
    pub position: SteeringRoleSilence,
    /// Rate of turn.
    pub rate_of_turn: RoleSilence,
    /// Log.
    pub log: RoleSilence,
    /// Roll.
    pub roll: RoleSilence,
    /// Temperature of the air.
    pub temperature: RoleSilence,
}

/// Times of a role that is only sampled.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RoleSilence {
    stale_s: Option<PositiveSeconds>,
}

/// Times of a role that is steered by, too.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SteeringRoleSilence {
    stale_s: Option<PositiveSeconds>,
    steering_s: Option<PositiveSeconds>,
}

impl Default for SilenceConfig {
    fn default() -> SilenceConfig {
        SilenceConfig {
            stale_s: PositiveSeconds(15.0),
            steering_s: PositiveSeconds(2.0),
            compass: SteeringRoleSilence::default(),
            gyro: RoleSilence::default(),
            satellite: RoleSilence::default(),
            position: SteeringRoleSilence::default(),
            rate_of_turn: RoleSilence::default(),
            log: RoleSilence::default(),
            roll: RoleSilence::default(),
            temperature: RoleSilence::default(),
        }
    }
}

impl SilenceConfig {
    /// Returns the seconds for which a reading of a sampled role serves.
    pub fn stale_s(&self, role: RoleSilence) -> f64 {
        role.stale_s.unwrap_or(self.stale_s).0
    }

    /// Returns the age up to which the compass is steered by, given its own interval.
    ///
    /// A `stale_s` below two seconds has always ended the output, too.
    pub fn compass_steering(&self, interval: Duration) -> Duration {
        let shortest = match self.compass.steering_s {
            Some(steering_s) => steering_s.0,
            None => self.steering_s.0.min(self.stale_s(self.compass.sampling())),
        };
        let own = interval.mul_f64(STEERING_INTERVALS);
        own.max(Duration::from_secs_f64(shortest))
    }

    /// Returns the age of the last fix up to which a heading is corrected by dead reckoning from
    /// it. Without one the error of the reckoned place decides.
    pub fn position_steering(&self) -> Option<Duration> {
        let seconds = self.position.steering_s.map(|steering_s| steering_s.0);
        seconds.map(Duration::from_secs_f64)
    }
}

impl SteeringRoleSilence {
    /// Returns the times for sampling.
    pub fn sampling(self) -> RoleSilence {
        RoleSilence {
            stale_s: self.stale_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(toml: &str) -> SilenceConfig {
        toml::from_str(toml).unwrap()
    }

    #[test]
    fn steering_ends_after_two_seconds_or_three_intervals_of_the_compass() {
        let silence = SilenceConfig::default();
        let limit = |interval_ms| {
            let interval = Duration::from_millis(interval_ms);
            silence.compass_steering(interval).as_secs_f64()
        };
        assert!((limit(0) - 2.0).abs() < 1e-9);
        assert!((limit(100) - 2.0).abs() < 1e-9);
        assert!((limit(1_000) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn each_role_may_have_its_own_times() {
        let silence = read("stale_s = 20\n[compass]\nsteering_s = 5\n[gyro]\nstale_s = 40");
        let still = Duration::ZERO;
        assert_eq!(silence.compass_steering(still), Duration::from_secs(5));
        assert!((silence.stale_s(silence.gyro) - 40.0).abs() < 1e-9);
        assert!((silence.stale_s(silence.compass.sampling()) - 20.0).abs() < 1e-9);
        assert!(toml::from_str::<SilenceConfig>("[gyro]\nsteering_s = 5").is_err());
        let short = read("stale_s = 1");
        assert_eq!(short.compass_steering(still), Duration::from_secs(1));
    }
}
