//! Spheres that cannot move because λ is too uncertain.

use crate::adjust::diagnosis::Refusal;
use crate::adjust::inputs::Adjustment;
use crate::adjust::prediction::{self, PredictedTable};
use crate::adjust::search;
use crate::adjust::state::MagneticState;

/// Assumed residual of a water with ambiguous headings, degrees.
const AMBIGUOUS_DEG: f64 = 90.0;

/// Explains an excessive residual: where movable spheres would reduce it, the magnetometer
/// is too poor, and no corrector is missing.
pub(crate) fn explain_large_residual(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    after: &[PredictedTable],
    too_large: Refusal,
) -> Vec<Refusal> {
    let limits = &adjustment.limits;
    if state.may_move_pair || state.binnacle.design.quadrantal.is_none() {
        return vec![too_large];
    }
    let free = state.with_free_spheres();
    let front = search::search(adjustment, &free);
    let Some(&best) = front.undominated().last() else {
        return vec![too_large];
    };
    if best.worst_deg + limits.near_equal_deg >= weighted_worst_deg(adjustment, after) {
        return vec![too_large];
    }
    let poor = Refusal::MagnetometerTooPoor {
        lambda_sd: state.lambda_sd_share(),
        limit: limits.lambda_sd,
    };
    // The band includes the uncertain λ, which a better magnetometer cures: only the
    // residual counts.
    let within = |table: &PredictedTable| {
        table
            .worst_deg
            .is_some_and(|worst_deg| worst_deg <= limits.residual_deg)
    };
    let would_do = prediction::tables(adjustment, &free, &best.setting)
        .is_ok_and(|tables| prediction::counted(&tables, adjustment.waters).all(within));
    if would_do {
        return vec![poor];
    }
    vec![poor, too_large]
}

/// Returns the worst residual, weighted over the waters as in the search, degrees.
fn weighted_worst_deg(adjustment: &Adjustment<'_>, after: &[PredictedTable]) -> f64 {
    // The first table is for the berth.
    let in_waters = adjustment.waters.iter().zip(after.iter().skip(1));
    let (weights, sum) = in_waters.fold((0.0, 0.0), |(weights, sum), (water, table)| {
        let worst_deg = table.worst_deg.unwrap_or(AMBIGUOUS_DEG);
        (weights + water.weight, sum + water.weight * worst_deg)
    });
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adjust::tests::case;

    /// The search minimises the mean over the waters; the limit applies to the worst of
    /// them.
    #[test]
    fn the_mean_over_the_waters_is_not_the_worst_of_them() {
        let case = case(60.0);
        let adjustment = case.adjustment();
        let mut after = case.plan().plans.remove(0).after;
        for (table, worst_deg) in after.iter_mut().zip([9.0, 1.0, 4.0]) {
            table.worst_deg = Some(worst_deg);
        }
        // Two parts of the time in the first water, one in the second; the berth has no
        // weight.
        let mean_deg = weighted_worst_deg(&adjustment, &after);
        assert!((mean_deg - 2.0).abs() < 1e-12, "{mean_deg}");
        after[2].worst_deg = None;
        let mean_deg = weighted_worst_deg(&adjustment, &after);
        assert!(
            (mean_deg - (2.0 + AMBIGUOUS_DEG) / 3.0).abs() < 1e-12,
            "{mean_deg}"
        );
    }
}
