//! What an operator decides about how a vessel's samples are read.

use crate::field::FieldModel;
use crate::fit::{GyroSpeedError, REFERENCE_CONSTANT_SD_DEG};
use serde::{Deserialize, Serialize};

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
