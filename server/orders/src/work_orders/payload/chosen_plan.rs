//! Plan that the adjuster follows.

use binnacle_adjustment::adjust::{Optimality, Outcome, Plan};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Plan that was chosen.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub(crate) struct ChosenPlan {
    /// Number among the plans offered, from 1.
    pub chosen: usize,
    /// All plans offered, in short.
    pub offered: Vec<PlanSummary>,
    /// Notes for the adjuster.
    pub notes: Vec<String>,
    /// Proven optimality of the search.
    pub optimality: Option<Optimality>,
    /// The plan.
    pub plan: Plan,
}

/// Summary of a plan.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanInShort)]
pub(crate) struct PlanSummary {
    /// Number of corrector moves.
    pub moves: u32,
    /// Worst predicted residual, weighted over the waters, degrees.
    pub worst_residual_deg: f64,
    /// Widest 95 % band, degrees.
    pub widest_band_deg: f64,
}

impl ChosenPlan {
    /// Chooses a plan of an outcome, from 1; `None` if there are fewer.
    pub(crate) fn from_outcome(outcome: Outcome, chosen: usize) -> Option<ChosenPlan> {
        let in_short = |plan: &Plan| PlanSummary {
            moves: plan.moves,
            worst_residual_deg: plan.worst_residual_deg,
            widest_band_deg: plan.widest_band_deg,
        };
        Some(ChosenPlan {
            chosen,
            offered: outcome.plans.iter().map(in_short).collect(),
            notes: outcome.notes,
            optimality: outcome.optimality,
            plan: outcome.plans.into_iter().nth(chosen.checked_sub(1)?)?,
        })
    }
}
