//! Notes for the adjuster on the plans.

use super::berth_check::BerthCheck;
use super::outcome::Plan;
use crate::adjust::diagnosis::{friction_deg, undetectable_misreadings};
use crate::adjust::inputs::Adjustment;
use crate::adjust::needle_part::without_needles;
use crate::adjust::search::Optimality;
use crate::adjust::state::MagneticState;
use binnacle_compass::ship::CAUTION_H_NT;

/// Lists all notes, the most serious first.
pub(crate) fn notes(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    berth: &BerthCheck,
    plans: &[Plan],
    optimality: &Optimality,
) -> Vec<String> {
    let mut notes: Vec<String> = only_here(adjustment, plans).into_iter().collect();
    notes.extend(berth.notes());
    let detectable_turn_deg = berth.consistency.detectable_turn_deg();
    notes.extend(state.drift.notes(detectable_turn_deg));
    let model = without_needles(adjustment.model, adjustment.binnacle, adjustment.earth);
    let unseen = undetectable_misreadings(&model, adjustment.earth, adjustment.reading);
    notes.extend(unseen.iter().map(|misreading| {
        format!(
            "this heading cannot show whether {misreading}: the reading fits either way, and \
             lambda hardly differs"
        )
    }));
    if adjustment.circumstances.model_age_days.is_none() {
        notes.push(
            "the age of the model is not given (model_until) and not checked: cargo, work on the \
             hull or a season may lie between it and this berth"
                .to_owned(),
        );
    }
    let h_nt = adjustment.earth.h_nt;
    if h_nt < CAUTION_H_NT {
        notes.push(format!(
            "the horizontal field here is only {:.1} microtesla: friction alone may hold the card \
             {:.1} degrees off, and small errors of the reading have a large effect",
            h_nt / 1e3,
            friction_deg(h_nt)
        ));
    }
    let card = adjustment.card().filter(|card| !card.agrees());
    notes.extend(card.map(|card| card.to_string()));
    notes.extend(spheres_left(adjustment, state, plans));
    if !state.may_move_bar && adjustment.binnacle.design.flinders.is_some() {
        notes.push(
            "the Flinders bar is left as found: the model does not separate chi13 from bx"
                .to_owned(),
        );
    }
    if adjustment.vertical.is_none() && adjustment.binnacle.design.heeling.is_some() {
        notes.push(
            "the heeling magnets are left as found: the vertical field (down) was not read"
                .to_owned(),
        );
    }
    notes.extend(
        adjustment
            .vertical_check()
            .and_then(|vertical| vertical.note()),
    );
    notes.extend(heeling_left(plans));
    notes.extend(left_out(optimality));
    notes
}

/// Describes Kelvin spheres that are not moved where λ is uncertain.
fn spheres_left(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    plans: &[Plan],
) -> Option<String> {
    adjustment.binnacle.design.quadrantal.as_ref()?;
    let setting = &plans.first()?.setting;
    let lambda_sd = state.lambda_sd_share();
    let left = setting.quadrantal == adjustment.standing().quadrantal;
    (left && lambda_sd > adjustment.limits.lambda_sd).then(|| {
        format!(
            "the Kelvin spheres are left as found: lambda is uncertain by {:.1} per cent, and \
             moving them would widen the band by more than it would gain",
            100.0 * lambda_sd
        )
    })
}

/// Describes possible improvements after an incomplete search.
pub(crate) fn left_out(optimality: &Optimality) -> Option<String> {
    (!optimality.proven).then(|| {
        format!(
            "not every setting of the correctors on board was tried: another may leave up \
             to {:.2} degrees less than the best one found",
            optimality.gap_deg
        )
    })
}

/// Heeling error that is reported, degrees per degree of heel: two degrees in a roll of
/// ten.
const MOST_HEELING_ERROR: f64 = 0.2;

fn heeling_left(plans: &[Plan]) -> Option<String> {
    let heeling = plans.first()?.heeling;
    let left = heeling.after_deg_per_deg?.abs();
    (left > MOST_HEELING_ERROR).then(|| {
        format!(
            "on north and south {left:.2} degrees of heeling error are left per degree of heel, \
             more than {MOST_HEELING_ERROR}: the heeling magnets on board can do no better with \
             this iron; the compass will swing when the vessel rolls"
        )
    })
}

/// Difference of dips, as tangents, below which waters count as one.
const ONE_DIP: f64 = 0.3;
/// Significance of a parameter, in standard errors.
const KNOWN_SD: f64 = 3.0;
/// Least induced share of B that matters, degrees.
const LEAST_SHARE_DEG: f64 = 1.0;

/// Describes magnets that correct an induced field, for a vessel that may leave these
/// waters.
fn only_here(adjustment: &Adjustment<'_>, plans: &[Plan]) -> Option<String> {
    let after = &plans.first()?.model_after;
    let covariance = after.covariance?;
    let waters = adjustment.waters.iter().filter(|water| water.weight > 0.0);
    let dips: Vec<f64> = waters.map(|water| water.z_nt / water.h_nt).collect();
    let least = dips.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = dips.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let chi13 = after.parameters_over_lambda.chi13;
    let is_known = chi13.abs() > KNOWN_SD * covariance[1][1].sqrt();
    let share_deg = (chi13 * f64::midpoint(least, greatest)).to_degrees();
    if greatest - least > ONE_DIP || !is_known || share_deg.abs() < LEAST_SHARE_DEG {
        return None;
    }
    let bar = if adjustment.binnacle.design.flinders.is_some() {
        "; a Flinders bar would follow the field: give the vessel's trading waters"
    } else {
        ""
    };
    let share_deg = share_deg.abs();
    Some(format!(
        "this plan is for waters of one dip only: {share_deg:.1} degrees of B are induced by the \
         vertical field (chi13) and corrected by magnets; at the magnetic equator the vessel will \
         have {share_deg:.1} degrees of B again, and in the other hemisphere {:.1}{bar}",
        2.0 * share_deg
    ))
}
