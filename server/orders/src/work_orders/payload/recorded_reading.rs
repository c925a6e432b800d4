//! Reading of the magnetometer at the berth, with its check.

use crate::work_orders::payload::plan_basis::Basis;
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::ReadingForm;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Reading at the berth, with its basis and its check.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedReading {
    /// Values as sent.
    pub given: ReadingForm,
    /// Basis that it was compared with; `None` if that could not be loaded.
    pub basis: Option<Basis>,
    /// Check; `None` when the reading was refused.
    pub checked: Option<BerthCheck>,
    /// Refusal; `None` when the reading was accepted.
    pub refusal: Option<Refusal>,
}

/// Check of a reading at the berth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = BerthCheck)]
pub(crate) struct BerthCheck {
    /// λ, the mean share of the earth's horizontal field that reaches the compass. Its estimate
    /// is equally good on every heading.
    pub lambda: f64,
    /// Standard error of λ.
    #[schema(required)]
    pub lambda_sd: Option<f64>,
    /// Angle between the field read and the field expected, degrees.
    pub consistency_deg: f64,
    /// Standard error of that angle, degrees.
    #[schema(required)]
    pub consistency_sd_deg: Option<f64>,
    /// Verdict: `consistent`, or `loose` where large errors explain the angle.
    pub verdict: String,
    /// Magnetic heading at the berth, degrees.
    pub magnetic_deg: f64,
}
