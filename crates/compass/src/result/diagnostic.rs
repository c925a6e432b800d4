//! Diagnosis of each sample.

use crate::sample::Sample;
use serde::{Deserialize, Serialize};

/// A sample with its diagnosis. Unavailable values are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = Sample))]
pub struct SampleDiagnostic {
    /// Original sample.
    #[serde(flatten)]
    #[cfg_attr(feature = "openapi", schema(inline))]
    pub sample: Sample,
    /// Variation, degrees, east positive.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub variation_deg: Option<f64>,
    /// Horizontal field, nT.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub h_nt: Option<f64>,
    /// Vertical field, nT, down positive.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub z_nt: Option<f64>,
    /// Reference less variation less compass, degrees.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub deviation_deg: Option<f64>,
    /// Predicted deviation on this compass heading at this place, degrees.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub predicted_deg: Option<f64>,
    /// Measured less predicted, degrees.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub residual_deg: Option<f64>,
    /// Robust weight, 0 to 1.
    pub weight: f64,
    /// Used: it had weight in a model.
    pub used: bool,
    /// Reason for rejection or reduced weight; none at full weight.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub reason: Option<SampleReason>,
}

/// Reason for the rejection or reduced weight of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum SampleReason {
    /// No gyro or satellite compass heading.
    NoReference,
    /// Gyro and satellite compass contradict each other and neither could be confirmed, or
    /// the only reference was stuck while the ship turned.
    ReferenceFailed,
    /// The compass was stuck while the ship turned, or swung by itself.
    CompassStuck,
    /// Taken under GNSS interference: its position is by dead reckoning.
    GnssInterference,
    /// Date outside the years of the field model.
    OutsideFieldModel,
    /// The horizontal field is too weak for a compass.
    FieldTooWeak,
    /// Taken with magnetic cargo on board.
    MagneticCargo,
    /// Taken alongside: by the logbook, or stationary on one heading.
    Berth,
    /// Taken in a magnetic storm, over a local anomaly, or near other iron.
    Disturbance,
    /// Outlier: its weight was reduced by more than half.
    Outlier,
    /// Its epoch has no model.
    NoModel,
    /// No gyro or satellite compass, and too slow for the course over ground to show the
    /// heading: the ship drifts, or nearly.
    TooSlowForCourse,
    /// No gyro or satellite compass, and in a turn or just after one, where the course over
    /// ground does not show the heading.
    TurningCourse,
}
