//! Planning: from the checks of the berth through the search to plans.

mod berth_check;
mod notes;
mod outcome;

pub use berth_check::{BerthCheck, Seen};
pub use outcome::{Outcome, Plan};

use super::diagnosis::{Card, Refusal, beforehand, of_berth};
use super::heeling;
use super::inputs::{self, AdjustError, Adjustment};
use super::instructions;
use super::limit_violations::beyond_limits;
use super::prediction;
use super::search::{self, Found, Front};
use super::state::Condition;
use crate::binnacle::Setting;

/// The best few ways to set the correctors, or why there is none.
///
/// # Errors
/// When something given cannot be. An inconsistent berth, a model too old and the like
/// are no errors but refusals.
pub fn plan(adjustment: &Adjustment<'_>) -> Result<Outcome, AdjustError> {
    inputs::check(adjustment)?;
    let mut refusals = beforehand(adjustment);
    let condition = match Condition::new(adjustment) {
        Ok(condition) => condition,
        Err(AdjustError::Berth(error)) => {
            refusals.push(of_berth(adjustment, error)?);
            return Ok(refused(None, refusals));
        }
        Err(error) => return Err(error),
    };
    let berth = BerthCheck::new(adjustment, &condition);
    let card = adjustment.card();
    refusals.extend(card.filter(Card::is_refused).map(Refusal::CardDisagrees));
    refusals.extend(condition.since.refusal());
    let vertical = adjustment.vertical_judged();
    refusals.extend(vertical.and_then(|vertical| vertical.refusal()));
    if !refusals.is_empty() {
        return Ok(refused(Some(berth), refusals));
    }
    let front = search::search(adjustment, &condition);
    let mut plans = Vec::new();
    for found in chosen(&front, adjustment.limits.near_equal_deg) {
        let plan = whole(adjustment, &condition, found)?;
        if plan.beyond(&adjustment.limits, adjustment.waters).is_none() {
            plans.push(plan);
        } else if refusals.is_empty() {
            // Of the plan that would be recommended.
            refusals = beyond_limits(adjustment, &condition, &plan.after, &plan.model_after);
        }
    }
    // What is beyond the limits is no alternative either.
    if plans.is_empty() {
        return Ok(Outcome {
            notes: notes::left_out(&front.optimality).into_iter().collect(),
            optimality: Some(front.optimality),
            ..refused(Some(berth), refusals)
        });
    }
    Ok(Outcome {
        notes: notes::notes(adjustment, &condition, &berth, &plans, &front.optimality),
        berth: Some(berth),
        refusals: Vec::new(),
        plans,
        optimality: Some(front.optimality),
    })
}

fn refused(berth: Option<BerthCheck>, refusals: Vec<Refusal>) -> Outcome {
    Outcome {
        berth,
        refusals: refusals.into_iter().map(Refusal::with_cures).collect(),
        notes: Vec::new(),
        plans: Vec::new(),
        optimality: None,
    }
}

/// How many plans are shown.
const PLANS: usize = 5;

/// The fewest moves among near-equals first, then what is better for more moves, then
/// what is cheaper.
fn chosen(front: &Front, near_equal_deg: f64) -> Vec<&Found> {
    let found = front.undominated();
    let Some(best) = found.last() else {
        return Vec::new();
    };
    let good_enough = best.worst_deg + near_equal_deg;
    let first = found.iter().position(|f| f.worst_deg <= good_enough);
    let first = first.unwrap_or(found.len() - 1);
    let mut order = vec![found[first]];
    order.extend(found[first + 1..].iter().rev().take(1));
    order.extend(found[..first].iter().rev());
    order.truncate(PLANS);
    order
}

fn whole(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    found: &Found,
) -> Result<Plan, AdjustError> {
    let tables = |setting: &Setting| prediction::tables(adjustment, condition, setting);
    let after = tables(&found.setting)?;
    let widest = after.iter().filter_map(|table| table.widest_band_deg);
    Ok(Plan {
        moves: found.moves,
        worst_residual_deg: found.worst_deg,
        widest_band_deg: widest.fold(0.0, f64::max),
        lambda: condition.lambda_with(&found.setting),
        before: tables(&adjustment.binnacle.setting)?,
        after,
        heeling: heeling::said(adjustment, condition, &found.setting),
        steps: instructions::steps(adjustment, condition, &found.setting),
        model_after: condition.model_with(&found.setting)?,
        setting: found.setting.clone(),
    })
}
