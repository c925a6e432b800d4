//! Result of planning.

use super::berth_check::BerthCheck;
use super::second_heading::SecondHeading;
use crate::adjust::diagnosis::{Refusal, Refused};
use crate::adjust::heeling::HeelingPlan;
use crate::adjust::inputs::{Limits, Water};
use crate::adjust::instructions::Step;
use crate::adjust::limit_violations::first_violation;
use crate::adjust::prediction::PredictedTable;
use crate::adjust::search::Optimality;
use crate::binnacle::Setting;
use binnacle_compass::model::Model;
use serde::{Deserialize, Serialize};

/// Result of planning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlanOffer))]
pub struct Outcome {
    /// Check of the berth; none when its reading was refused.
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Object>))]
    pub berth: Option<BerthCheck>,
    /// Reasons for the absence of a plan; empty when there is one.
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<Object>))]
    pub refusals: Vec<Refused>,
    /// Notes for the adjuster.
    pub notes: Vec<String>,
    /// Recommended plan first, then others with more or fewer moves.
    pub plans: Vec<Plan>,
    /// Optimality of the search.
    pub optimality: Option<Optimality>,
    /// Advice to read the field on another heading, where that would be worth it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_heading: Option<SecondHeading>,
}

/// A possible setting of the correctors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CorrectorPlan))]
pub struct Plan {
    /// Planned setting.
    pub setting: Setting,
    /// Number of moves.
    pub moves: u32,
    /// Worst predicted residual on any heading, weighted over the waters, degrees.
    pub worst_residual_deg: f64,
    /// Widest 95 % band in any of them, degrees.
    pub widest_band_deg: f64,
    /// λ with this setting.
    pub lambda: f64,
    /// Present deviations at the berth and in the waters.
    pub before: Vec<PredictedTable>,
    /// Predicted residuals.
    pub after: Vec<PredictedTable>,
    /// Plan for the heeling magnets.
    pub heeling: HeelingPlan,
    /// Steps in order.
    pub steps: Vec<Step>,
    /// Model that applies after the last step; its covariance includes the errors of λ and
    /// of the moved correctors.
    pub model_after: Model,
}

impl Plan {
    /// Checks the plan against limits in these waters; a plan offered by
    /// [`crate::adjust::plan`] keeps to its own limits.
    #[must_use]
    pub fn limit_violation(&self, limits: &Limits, waters: &[Water]) -> Option<Refused> {
        first_violation(&self.after, &self.model_after, limits, waters).map(Refusal::with_cures)
    }
}
