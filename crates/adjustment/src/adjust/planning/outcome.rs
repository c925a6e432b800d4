//! Result of planning.

use super::berth_check::BerthCheck;
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

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// What the berth told; none when its reading was refused.
    pub berth: Option<BerthCheck>,
    /// Why there is no plan; empty when there is one.
    pub refusals: Vec<Refused>,
    /// What the adjuster should know of it.
    pub notes: Vec<String>,
    /// The recommended plan first, then others that cost more or less.
    pub plans: Vec<Plan>,
    /// How well the search knows that nothing is better.
    pub optimality: Option<Optimality>,
}

/// One way to set the correctors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// How they will stand.
    pub setting: Setting,
    /// Movements of hand that it takes.
    pub moves: u32,
    /// Worst foretold residual on any heading, weighted over the waters, degrees.
    pub worst_residual_deg: f64,
    /// The widest 95 % band in any of them, degrees.
    pub widest_band_deg: f64,
    /// λ with this setting.
    pub lambda: f64,
    /// Deviations as they are, at the berth and in the waters.
    pub before: Vec<PredictedTable>,
    /// Residuals as they will be.
    pub after: Vec<PredictedTable>,
    /// What becomes of the heeling magnets.
    pub heeling: HeelingPlan,
    /// What to do, in order.
    pub steps: Vec<Step>,
    /// The model that holds from the last step on, its covariance with the errors of λ
    /// and of the correctors that were moved.
    pub model_after: Model,
}

impl Plan {
    /// Which of these limits it breaks in these waters, with what would cure that; nothing
    /// that [`crate::adjust::plan`] offers breaks those it was asked for.
    #[must_use]
    pub fn limit_violation(&self, limits: &Limits, waters: &[Water]) -> Option<Refused> {
        first_violation(&self.after, &self.model_after, limits, waters).map(Refusal::with_cures)
    }
}
