//! Spheres that have to stay where they are, because λ is too unsure.

use super::condition::Condition;
use super::{Adjustment, PredictedTable, Refusal, search};

/// Why the residual is too large: where spheres on board would lessen it, had they not to
/// stay because λ is too unsure, that is the magnetometer's and no corrector's.
pub(super) fn residual_too_large(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    after: &[PredictedTable],
    too_large: Refusal,
) -> Vec<Refusal> {
    let limits = &adjustment.limits;
    if condition.may_move_pair || condition.binnacle.design.quadrantal.is_none() {
        return vec![too_large];
    }
    let front = search::search(adjustment, &condition.with_free_spheres());
    let best = front.undominated().last().map(|found| found.worst_deg);
    let best_deg = best.unwrap_or(f64::INFINITY);
    if best_deg + limits.near_equal_deg >= weighted_worst_deg(adjustment, after) {
        return vec![too_large];
    }
    let poor = Refusal::MagnetometerTooPoor {
        lambda_sd: condition.lambda_sd_share(),
        limit: limits.lambda_sd,
    };
    if best_deg <= limits.residual_deg {
        return vec![poor];
    }
    vec![poor, too_large]
}

/// The worst residual, weighted over the waters as the search does, degrees.
fn weighted_worst_deg(adjustment: &Adjustment<'_>, after: &[PredictedTable]) -> f64 {
    // The berth stands first.
    let in_waters = adjustment.waters.iter().zip(after.iter().skip(1));
    let (weights, sum) = in_waters.fold((0.0, 0.0), |(weights, sum), (water, table)| {
        let worst_deg = table.worst_deg.unwrap_or(0.0);
        (weights + water.weight, sum + water.weight * worst_deg)
    });
    sum / weights
}
