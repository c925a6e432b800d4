//! Settings of an analysis, chosen by the operator.

use crate::field::FieldModel;
use serde::{Deserialize, Serialize};

/// Prior standard deviation of a reference's constant error, degrees.
pub const REFERENCE_CONSTANT_SD_DEG: f64 = 0.5;

/// Settings of an analysis, part of its input: a changed setting makes a new analysis of
/// the same samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = ReadingSettings))]
#[serde(default)]
pub struct AnalysisSettings {
    /// Model of the earth's field that the samples are compared with.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub field_model: FieldModel,
    /// Correction of the gyro's speed error.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub gyro_speed_error: GyroSpeedError,
    /// Prior standard deviation of one reference's constant error, degrees. Headings cannot
    /// separate it from the compass's own alignment, so every band contains it.
    #[cfg_attr(feature = "openapi", schema(required))]
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

/// Place where the gyro's error from the ship's motion over the turning earth is corrected.
/// The correction must be applied exactly once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum GyroSpeedError {
    /// The gyro corrects it.
    #[default]
    Corrected,
    /// The gyro does not: the analysis corrects it from speed and latitude.
    Uncorrected,
}
