//! OpenAPI descriptions of a model. The compass crate owns the type.

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
    /// Constant added to the exact deviation: alignment, reference and variation offsets, degrees,
    /// east positive.
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
    /// Quality of the model; absent in a model that came without.
    #[schema(required = false)]
    quality: Option<QualitySchema>,
}

/// Quality of a model.
#[derive(ToSchema)]
#[schema(as = Quality)]
#[allow(dead_code, reason = "describes binnacle_compass::model::Quality")]
pub(super) struct QualitySchema {
    /// Number of samples with independent errors that would determine the deviation at the last
    /// place as well as all samples do.
    effective_samples: f64,
    /// Standard error of the worst known combination of parameters over that of
    /// the best, by the data alone; null where the data leave one quite open.
    #[schema(required)]
    condition: Option<f64>,
    /// Part of the knowledge of each parameter that is from the data, 0 to 1.
    from_data: FromDataSchema,
    /// Cautions on the use of the model.
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

/// Caution on the use of a model.
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
        /// Duration of the gap, days.
        days: f64,
        /// Time of the last sample.
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

/// Parameters that the data determine; false for those that rest on the prior.
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

/// Withdrawal of earlier cards.
#[derive(ToSchema)]
#[schema(as = CardWithdrawn)]
#[allow(dead_code, reason = "describes binnacle_wire::messages::CardWithdrawn")]
pub struct CardWithdrawnSchema {
    /// Time from which they do not hold.
    since: Time,
    /// Change of the ship's magnetism or the compass: a kind of logbook entry, a detected cause, or
    /// `ship_as_before`.
    #[schema(example = "adjustment")]
    reason: String,
}
