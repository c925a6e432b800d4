//! Plan that the adjuster follows.

use binnacle_adjustment::adjust::{Optimality, Outcome, Plan};
use serde::{Deserialize, Serialize};

/// A plan that was chosen.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ChosenPlan {
    /// Which of those that were offered, from 1.
    pub chosen: usize,
    /// All that were offered, in short.
    pub offered: Vec<PlanSummary>,
    /// What the adjuster should know of it.
    pub notes: Vec<String>,
    /// How well the search knows that nothing is better.
    pub optimality: Option<Optimality>,
    /// The plan.
    pub plan: Plan,
}

/// A plan in short.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PlanSummary {
    /// Movements of hand that it takes.
    pub moves: u32,
    /// Worst foretold residual, weighted over the waters, degrees.
    pub worst_residual_deg: f64,
    /// The widest 95 % band, degrees.
    pub widest_band_deg: f64,
}

impl ChosenPlan {
    /// What was chosen of an outcome, from 1; none when there are not so many.
    pub(crate) fn of(outcome: Outcome, chosen: usize) -> Option<ChosenPlan> {
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
