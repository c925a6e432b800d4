//! Planning: from the checks of the berth through the search to plans.

mod berth_check;
mod notes;
mod outcome;
mod second_heading;

pub use berth_check::{BerthCheck, HeadingVisibility};
pub use outcome::{Outcome, Plan};
pub use second_heading::SecondHeading;

use super::diagnosis::{CardCheck, Refusal, check_preconditions, refuse_berth};
use super::heeling;
use super::inputs::{self, AdjustError, Adjustment};
use super::instructions;
use super::limit_violations::find_violations;
use super::prediction;
use super::search::{self, BestSetting, ParetoFront};
use super::state::MagneticState;
use crate::binnacle::Setting;

/// Finds the best few settings of the correctors, or the reasons for their absence.
///
/// # Errors
/// Fails when the input is invalid. An inconsistent berth, an old model and the like are
/// refusals, not errors.
pub fn plan(adjustment: &Adjustment<'_>) -> Result<Outcome, AdjustError> {
    inputs::validate(adjustment)?;
    let mut refusals = check_preconditions(adjustment);
    let state = match MagneticState::new(adjustment) {
        Ok(state) => state,
        Err(AdjustError::Berth(error)) => {
            refusals.push(refuse_berth(adjustment, error)?);
            return Ok(refused_outcome(None, refusals));
        }
        Err(error) => return Err(error),
    };
    let berth = BerthCheck::new(adjustment, &state);
    let card = adjustment.card();
    refusals.extend(
        card.filter(CardCheck::is_refused)
            .map(Refusal::CardDisagrees),
    );
    refusals.extend(state.drift.refusal());
    refusals.extend(foreign_field(&state));
    let vertical = adjustment.vertical_check();
    refusals.extend(vertical.and_then(|vertical| vertical.refusal()));
    if !refusals.is_empty() {
        return Ok(refused_outcome(Some(berth), refusals));
    }
    let front = search::search(adjustment, &state);
    let mut plans = Vec::new();
    for found in choose_plans(&front, adjustment.limits.near_equal_deg) {
        let plan = complete_plan(adjustment, &state, found)?;
        if plan
            .limit_violation(&adjustment.limits, adjustment.waters)
            .is_none()
        {
            plans.push(plan);
        } else if refusals.is_empty() {
            // The refusals apply to the plan that would be recommended.
            refusals = find_violations(adjustment, &state, &plan.after, &plan.model_after);
        }
    }
    // A plan that violates the limits is no alternative either.
    if plans.is_empty() {
        return Ok(Outcome {
            notes: notes::left_out(&front.optimality).into_iter().collect(),
            optimality: Some(front.optimality),
            ..refused_outcome(Some(berth), refusals)
        });
    }
    let second_heading = SecondHeading::advise(adjustment, &state, &plans[0].setting)?;
    let mut notes = notes::notes(adjustment, &state, &berth, &plans, &front.optimality);
    notes.extend(second_heading.map(|advice| advice.to_string()));
    Ok(Outcome {
        second_heading,
        notes,
        berth: Some(berth),
        refusals: Vec::new(),
        plans,
        optimality: Some(front.optimality),
    })
}

/// Refuses readings on two headings that one λ does not explain.
fn foreign_field(state: &MagneticState<'_>) -> Option<Refusal> {
    let two = state.two_headings.filter(|two| two.is_foreign)?;
    Some(Refusal::ForeignField {
        left_nt: two.left_nt,
    })
}

fn refused_outcome(berth: Option<BerthCheck>, refusals: Vec<Refusal>) -> Outcome {
    Outcome {
        berth,
        refusals: refusals.into_iter().map(Refusal::with_cures).collect(),
        notes: Vec::new(),
        plans: Vec::new(),
        optimality: None,
        second_heading: None,
    }
}

/// Greatest number of plans.
const PLANS: usize = 5;

/// Chooses the setting with the fewest moves among near-equals, then a better one with more
/// moves, then cheaper ones.
fn choose_plans(front: &ParetoFront, near_equal_deg: f64) -> Vec<&BestSetting> {
    let found = front.undominated();
    let Some(best) = found.last() else {
        return Vec::new();
    };
    let good_enough = best.reach_deg + near_equal_deg;
    let first = found.iter().position(|f| f.reach_deg <= good_enough);
    let first = first.unwrap_or(found.len() - 1);
    let mut order = vec![found[first]];
    order.extend(found[first + 1..].iter().rev().take(1));
    order.extend(found[..first].iter().rev());
    order.truncate(PLANS);
    order
}

fn complete_plan(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    found: &BestSetting,
) -> Result<Plan, AdjustError> {
    let tables = |setting: &Setting| prediction::tables(adjustment, state, setting);
    let after = tables(&found.setting)?;
    let widest = after.iter().filter_map(|table| table.widest_band_deg);
    Ok(Plan {
        moves: found.moves,
        worst_residual_deg: prediction::weighted_worst_deg(adjustment.waters, &after),
        widest_band_deg: widest.fold(0.0, f64::max),
        lambda: state.lambda_with(&found.setting),
        before: tables(&adjustment.binnacle.setting)?,
        after,
        heeling: heeling::heeling_plan(adjustment, state, &found.setting),
        steps: instructions::steps(adjustment, state, &found.setting),
        model_after: state.model_with(&found.setting)?,
        setting: found.setting.clone(),
    })
}
