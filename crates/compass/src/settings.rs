//! What an operator decides about how a vessel's samples are read.

use crate::field::FieldModel;
use serde::{Deserialize, Serialize};

/// What is known beforehand of a reference's constant error: its standard
/// deviation in degrees.
pub const REFERENCE_CONSTANT_SD_DEG: f64 = 0.5;

/// Settings of an analysis. They are part of its input: a change of settings
/// makes a new analysis of the same samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct AnalysisSettings {
    /// Which model of the earth's field the samples are held against.
    pub field_model: FieldModel,
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
            field_model: FieldModel::Igrf14,
            gyro_speed_error: GyroSpeedError::Corrected,
            reference_constant_sd_deg: REFERENCE_CONSTANT_SD_DEG,
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
    /// The gyro does not: it is taken out here, from speed and latitude.
    Uncorrected,
}
