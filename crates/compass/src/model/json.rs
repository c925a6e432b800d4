//! Written form of a model (docs/model.md), as printed by `fit --json`, stored by the
//! server and sent on board.
//!
//! Invariants: the version comes first. A form without one is version 1, as in models
//! written before it existed. A form of another version is refused by its number, because
//! its other fields may have another meaning. A changed meaning takes the next number; a
//! new optional field does not.

use super::{
    Covariance, Identifiable, Model, NeedleInduction, Parameters, Quality, ReferenceGrade,
};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

const VERSION: u32 = 1;

/// A fitted model.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = Model))]
#[serde(rename = "Model")]
pub(super) struct Form {
    /// Version of this form: 1. It is not the number of the model.
    #[serde(default = "version", deserialize_with = "known_version")]
    #[cfg_attr(feature = "openapi", schema(required))]
    version: u32,
    /// Poisson's parameters over the shielding factor λ.
    parameters_over_lambda: Parameters,
    /// Constant added to the exact deviation: alignment, reference and variation offsets,
    /// degrees, east positive.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    constant_deg: f64,
    /// Covariance, 8 × 8: the parameters in their order, the constant last.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required, value_type = Option<Vec<Vec<f64>>>))]
    covariance: Option<Covariance>,
    /// Parameters determined by the data.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    identifiable: Option<Identifiable>,
    /// Root mean square of the residuals, degrees.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    rms_deg: Option<f64>,
    /// Number of samples with weight.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    samples_used: u64,
    /// Number of samples left out or rejected as outliers.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    samples_rejected: u64,
    /// Evidence behind the model; absent in a model stored without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    quality: Option<Quality>,
    /// Source of the true headings behind the model: gyro or satellite compass where absent.
    #[serde(default, skip_serializing_if = "ReferenceGrade::is_heading")]
    reference_grade: ReferenceGrade,
    /// Harmonic mean of the horizontal field over the samples, nT; absent where unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mean_h_nt: Option<f64>,
    /// The needles' part of D and E, which grows as 1/H; absent where the correctors are
    /// unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    needles: Option<NeedleInduction>,
}

fn version() -> u32 {
    VERSION
}

fn known_version<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    let found = u32::deserialize(deserializer)
        .map_err(|error| D::Error::custom(format_args!("version: {error}")))?;
    if found == VERSION {
        return Ok(found);
    }
    Err(D::Error::custom(format_args!(
        "version: a model of version {found}; this program reads version {VERSION}"
    )))
}

impl From<Form> for Model {
    fn from(form: Form) -> Model {
        Model {
            parameters_over_lambda: form.parameters_over_lambda,
            constant_deg: form.constant_deg,
            covariance: form.covariance,
            identifiable: form.identifiable,
            rms_deg: form.rms_deg,
            samples_used: form.samples_used,
            samples_rejected: form.samples_rejected,
            quality: form.quality,
            reference_grade: form.reference_grade,
            mean_h_nt: form.mean_h_nt,
            needles: form.needles,
        }
    }
}

impl From<Model> for Form {
    fn from(model: Model) -> Form {
        Form {
            version: VERSION,
            parameters_over_lambda: model.parameters_over_lambda,
            constant_deg: model.constant_deg,
            covariance: model.covariance,
            identifiable: model.identifiable,
            rms_deg: model.rms_deg,
            samples_used: model.samples_used,
            samples_rejected: model.samples_rejected,
            quality: model.quality,
            reference_grade: model.reference_grade,
            mean_h_nt: model.mean_h_nt,
            needles: model.needles,
        }
    }
}

#[cfg(feature = "openapi")]
crate::openapi::named_schema!(Model, "Model", Form);
