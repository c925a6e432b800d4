//! What became of each sample.

use crate::sample::Sample;
use serde::{Deserialize, Serialize};

/// A sample and what became of it. Fields that could not be had are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleDiagnostic {
    /// The sample as it was.
    #[serde(flatten)]
    pub sample: Sample,
    /// The earth's variation, degrees, east positive.
    pub variation_deg: Option<f64>,
    /// Horizontal field, nT.
    pub h_nt: Option<f64>,
    /// Vertical field, nT, down positive.
    pub z_nt: Option<f64>,
    /// Reference less variation less compass, degrees.
    pub deviation_deg: Option<f64>,
    /// The model's deviation on this compass heading, here, degrees.
    pub predicted_deg: Option<f64>,
    /// Measured less predicted, degrees.
    pub residual_deg: Option<f64>,
    /// Robust weight, 0 to 1.
    pub weight: f64,
    /// Whether it carried weight in a model.
    pub used: bool,
    /// Why it was left out or doubted; none when it was taken at full weight.
    pub reason: Option<SampleReason>,
}

/// Why a sample was left out, or held to be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleReason {
    /// Neither gyro nor satellite compass.
    NoReference,
    /// Gyro and satellite compass contradict each other and neither could be
    /// shown to be right, or the only one repeated itself while the ship turned.
    ReferenceFailed,
    /// The compass repeated itself while the ship turned.
    CompassStuck,
    /// Before or after the years that the field model covers.
    OutsideFieldModel,
    /// The horizontal field is too weak for a compass.
    FieldTooWeak,
    /// Taken with magnetic cargo on board.
    MagneticCargo,
    /// Taken alongside: by the logbook, or lying still on one heading.
    Berth,
    /// Taken in a magnetic storm, over a local anomaly, or near other iron.
    Disturbance,
    /// It disagrees with the rest: its weight was lowered by more than half.
    Outlier,
    /// Its epoch has no model.
    NoModel,
}
