//! Reading of the magnetometer at the berth, with its check.

use crate::work_orders::payload::basis::Basis;
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::ReadingForm;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A reading as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedReading {
    /// What was read.
    pub given: ReadingForm,
    /// What it was held against; none when that could not be found.
    pub basis: Option<Basis>,
    /// What it told; none when it was refused.
    pub checked: Option<BerthCheck>,
    /// Why it was refused; none when it was taken.
    pub refusal: Option<Refusal>,
}

/// What a reading told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = BerthCheck)]
pub(crate) struct BerthCheck {
    /// λ, the mean share of the earth's horizontal field that reaches the compass; every
    /// heading tells it equally well.
    pub lambda: f64,
    /// Its standard error.
    #[schema(required)]
    pub lambda_sd: Option<f64>,
    /// Between the field read and the field expected, degrees.
    pub consistency_deg: f64,
    /// The standard error of that, degrees.
    #[schema(required)]
    pub consistency_sd_deg: Option<f64>,
    /// What to make of it: `consistent`, or `loose` where wide errors explain it.
    pub verdict: String,
    /// Magnetic heading at the berth, degrees.
    pub magnetic_deg: f64,
}
