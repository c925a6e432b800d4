//! How the OpenAPI document describes a model; the model itself is the science
//! crate's.

use binnacle_compass::model::Model;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A fitted model, as `fit --json` prints it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ModelJson(pub Model);

impl TryFrom<String> for ModelJson {
    type Error = serde_json::Error;

    fn try_from(text: String) -> Result<ModelJson, serde_json::Error> {
        serde_json::from_str(&text)
    }
}

/// A fitted model.
#[derive(ToSchema)]
#[schema(as = Model)]
#[allow(dead_code, reason = "describes binnacle_compass::model::Model")]
pub struct ModelSchema {
    /// The version of this form: 1. Not to be confused with the count of the
    /// compass's models.
    version: u32,
    parameters_over_lambda: ParametersSchema,
    /// What is added to the exact deviation: alignment, reference and variation
    /// offsets, degrees, east positive.
    constant_deg: f64,
    /// 8 × 8: the parameters in their order, the constant last.
    #[schema(required)]
    covariance: Option<Vec<Vec<f64>>>,
    #[schema(required)]
    identifiable: Option<IdentifiableSchema>,
    /// Root mean square of the residuals, degrees.
    #[schema(required)]
    rms_deg: Option<f64>,
    /// Samples that carried weight.
    samples_used: u64,
    /// Samples that were left out or held to be outliers.
    samples_rejected: u64,
    /// What the model rests on; absent in a model that came without.
    #[schema(required = false)]
    quality: Option<QualitySchema>,
}

/// What a model rests on.
#[derive(ToSchema)]
#[schema(as = Quality)]
#[allow(dead_code, reason = "describes binnacle_compass::model::Quality")]
pub(super) struct QualitySchema {
    /// How many samples with independent errors would tell the deviation, where
    /// the ship was last, as well as all her samples together.
    effective_samples: f64,
    /// Standard error of the worst known combination of parameters over that of
    /// the best, by the data alone; null where the data leave one quite open.
    #[schema(required)]
    condition: Option<f64>,
    /// What part of the knowledge of each parameter is from the data, 0 to 1.
    from_data: FromDataSchema,
    /// What the model should not be trusted for.
    cautions: Vec<CautionSchema>,
}

/// For each parameter and the constant: 0 rests on ships at large, 1 on the data.
#[derive(ToSchema)]
#[schema(as = FromData)]
#[allow(dead_code, reason = "describes binnacle_compass::model::FromData")]
pub(super) struct FromDataSchema {
    bx_nt: f64,
    chi13: f64,
    by_nt: f64,
    chi23: f64,
    chi11_minus_chi22: f64,
    chi12: f64,
    chi21: f64,
    constant_deg: f64,
}

/// What a model should not be trusted for.
#[derive(Serialize, ToSchema)]
#[serde(tag = "caution", rename_all = "snake_case")]
#[schema(as = Caution)]
#[allow(dead_code, reason = "describes binnacle_compass::model::Caution")]
pub(super) enum CautionSchema {
    /// Only the sums bx + χ13 Z and by + χ23 Z are known.
    OneMagneticLatitude,
    /// More samples in the same latitudes would tell what the sums are made of.
    FewSamples,
    /// Rows without times, or that share them.
    NoTimes,
    /// Residuals are larger than sound instruments leave.
    LargeResiduals {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
    },
    /// The last samples stand more than a year after the others.
    LongGap {
        /// How long there were none, days.
        days: f64,
        /// When the last sample was taken.
        last: Time,
    },
    /// Some samples lie where the horizontal field is weak.
    WeakField {
        /// The weakest horizontal field, nT.
        h_nt: f64,
    },
}

/// Poisson's parameters over the shielding factor.
#[derive(ToSchema)]
#[schema(as = ParametersOverLambda)]
#[allow(dead_code, reason = "describes binnacle_compass::model::Parameters")]
pub struct ParametersSchema {
    /// Fore-and-aft permanent field, nT, forward positive.
    bx_nt: f64,
    /// Fore-and-aft field from the vertical earth field.
    chi13: f64,
    /// Athwartship permanent field, nT, starboard positive.
    by_nt: f64,
    /// Athwartship field from the vertical earth field.
    chi23: f64,
    /// Twice the exact coefficient D.
    chi11_minus_chi22: f64,
    chi12: f64,
    chi21: f64,
}

/// Which parameters the data determine; what is false rests on the prior.
#[derive(ToSchema)]
#[schema(as = Identifiable)]
#[allow(
    dead_code,
    clippy::struct_excessive_bools,
    reason = "describes binnacle_compass::model::Identifiable"
)]
pub struct IdentifiableSchema {
    bx_nt: bool,
    chi13: bool,
    by_nt: bool,
    chi23: bool,
    chi11_minus_chi22: bool,
    chi12: bool,
    chi21: bool,
    constant_deg: bool,
}
