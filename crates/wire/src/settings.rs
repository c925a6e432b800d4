//! The server's settings for sampling and sending by an agent.

use serde::{Deserialize, Serialize};

/// Sampling and sending of an agent.
///
/// Settings read from JSON are always within the ranges of [`Settings::check`];
/// code that builds its own must call it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = AgentSettings, description = "Settings of an agent's sampling and sending."))]
#[serde(try_from = "RawSettings")]
pub struct Settings {
    /// Version, rising with every change; 0 is the agent's built-in default.
    pub version: u32,
    /// Speed over ground below which nothing is sampled, knots.
    pub min_sog_kn: f64,
    /// Rate of turn above which a window is refused, degrees a minute.
    pub max_rate_of_turn_deg_min: f64,
    /// Seconds after a turn in which nothing is sampled (Gaussian error).
    pub settle_s: u32,
    /// The greatest swing of the heading to either side within 30 s, degrees.
    pub max_swing_deg: f64,
    /// The longest interval averaged in one sample, seconds.
    pub sample_s: u32,
    /// A batch is sealed when its first sample is this old, seconds of ship time.
    pub seal_s: u32,
}

/// A setting out of range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("setting {name} {value} is outside {low} to {high}")]
pub struct SettingsError {
    /// The field.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
    /// The least value that is accepted.
    pub low: f64,
    /// The greatest value that is accepted.
    pub high: f64,
}

impl Default for Settings {
    /// Three minutes outlast the Gaussian error; a swing of two degrees in half
    /// a minute is the limit of Basterretxea-Iribar, Sotés & Uriarte (2016).
    fn default() -> Settings {
        Settings {
            version: 0,
            min_sog_kn: 4.0,
            max_rate_of_turn_deg_min: 18.0,
            settle_s: 180,
            max_swing_deg: 2.0,
            sample_s: 600,
            seal_s: 6 * 3600,
        }
    }
}

impl Settings {
    /// Checks all values against their ranges.
    ///
    /// # Errors
    /// [`SettingsError`] with the first field that is out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let ranges = [
            ("min_sog_kn", self.min_sog_kn, 0.0, 50.0),
            (
                "max_rate_of_turn_deg_min",
                self.max_rate_of_turn_deg_min,
                0.1,
                360.0,
            ),
            ("settle_s", f64::from(self.settle_s), 0.0, 7200.0),
            ("max_swing_deg", self.max_swing_deg, 0.1, 45.0),
            ("sample_s", f64::from(self.sample_s), 10.0, 86_400.0),
            ("seal_s", f64::from(self.seal_s), 10.0, 30.0 * 86_400.0),
        ];
        for (name, value, low, high) in ranges {
            // NaN lies in no range.
            if !(low..=high).contains(&value) {
                return Err(SettingsError {
                    name,
                    value,
                    low,
                    high,
                });
            }
        }
        Ok(())
    }
}

/// Settings as received, not yet checked.
#[derive(Deserialize)]
struct RawSettings {
    version: u32,
    min_sog_kn: f64,
    max_rate_of_turn_deg_min: f64,
    settle_s: u32,
    max_swing_deg: f64,
    sample_s: u32,
    seal_s: u32,
}

impl TryFrom<RawSettings> for Settings {
    type Error = SettingsError;
    fn try_from(raw: RawSettings) -> Result<Settings, SettingsError> {
        let settings = Settings {
            version: raw.version,
            min_sog_kn: raw.min_sog_kn,
            max_rate_of_turn_deg_min: raw.max_rate_of_turn_deg_min,
            settle_s: raw.settle_s,
            max_swing_deg: raw.max_swing_deg,
            sample_s: raw.sample_s,
            seal_s: raw.seal_s,
        };
        settings.check()?;
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_defaults_are_within_their_own_ranges_and_come_back() {
        let settings = Settings::default();
        assert_eq!(settings.check(), Ok(()));
        let text = serde_json::to_string(&settings).unwrap();
        assert_eq!(serde_json::from_str::<Settings>(&text).unwrap(), settings);
    }

    #[test]
    fn each_field_is_refused_by_its_name() {
        let good = serde_json::to_value(Settings::default()).unwrap();
        for (name, value) in [
            ("min_sog_kn", json!(-0.1)),
            ("max_rate_of_turn_deg_min", json!(0)),
            ("settle_s", json!(7201)),
            ("max_swing_deg", json!(1e9)),
            ("sample_s", json!(9)),
            ("seal_s", json!(0)),
        ] {
            let mut bad = good.clone();
            bad[name] = value;
            let error = serde_json::from_value::<Settings>(bad)
                .unwrap_err()
                .to_string();
            assert!(error.contains(name), "{error}");
        }
        let not_a_number = Settings {
            min_sog_kn: f64::NAN,
            ..Settings::default()
        };
        assert_eq!(not_a_number.check().unwrap_err().name, "min_sog_kn");
    }
}
