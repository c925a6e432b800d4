//! What an operator decides about how a vessel's samples are read.

use serde::{Deserialize, Serialize};

/// Settings of an analysis. They are part of its input: a change of settings
/// makes a new analysis of the same samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct AnalysisSettings {
    /// Whether the gyro already takes its speed error out.
    pub gyro_speed_error: GyroSpeedError,
    /// What is known beforehand of one reference's constant error: its standard
    /// deviation in degrees. Headings cannot tell it from the compass's own
    /// alignment, so that it stands in every band.
    pub reference_constant_sd_deg: f64,
}

impl Default for AnalysisSettings {
    fn default() -> AnalysisSettings {
        AnalysisSettings {
            gyro_speed_error: GyroSpeedError::Corrected,
            reference_constant_sd_deg: 0.5,
        }
    }
}

/// Who takes out the error that a gyro has from the ship's own motion over the
/// turning earth. It must be done once, never twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GyroSpeedError {
    /// The gyro does it itself.
    #[default]
    Corrected,
    /// The gyro does not: the analysis does, from speed and latitude.
    Uncorrected,
}
