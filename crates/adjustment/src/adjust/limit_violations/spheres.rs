//! Violations of the limits because λ is too uncertain to move spheres.

use super::first_violation;
use crate::adjust::diagnosis::Refusal;
use crate::adjust::inputs::{AdjustError, Adjustment};
use crate::adjust::prediction::{self, PredictedTable, weighted_worst_deg};
use crate::adjust::search;
use crate::adjust::state::MagneticState;

/// Explains a violation of the limits: where a known λ would cure it, the magnetometer is too
/// poor, and no corrector is missing.
pub(crate) fn explain_by_lambda(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    after: &[PredictedTable],
    violation: Refusal,
) -> Vec<Refusal> {
    let limits = &adjustment.limits;
    let lambda_sd = state.lambda_sd_share();
    if lambda_sd <= limits.lambda_sd || state.binnacle.design.quadrantal.is_none() {
        return vec![violation];
    }
    let known = state.with_exact_lambda();
    let front = search::search(adjustment, &known);
    let Some(&best) = front.undominated().last() else {
        return vec![violation];
    };
    let model = known.model_with(&best.setting);
    let Ok((model, tables)) = model.map_err(AdjustError::from).and_then(|model| {
        let tables = prediction::tables_by(adjustment, &model)?;
        Ok((model, tables))
    }) else {
        return vec![violation];
    };
    let poor = Refusal::MagnetometerTooPoor {
        lambda_sd,
        limit: limits.lambda_sd,
    };
    if first_violation(&tables, &model, limits, adjustment.waters).is_none() {
        return vec![poor];
    }
    let left_deg = |tables: &[PredictedTable]| weighted_worst_deg(adjustment.waters, tables);
    if left_deg(&tables) + limits.near_equal_deg < left_deg(after) {
        vec![poor, violation]
    } else {
        vec![violation]
    }
}
