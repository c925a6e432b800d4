//! Steps of a plan, each with the predicted compass heading.
//!
//! The order is an adjuster's: Flinders bar, spheres, heeling magnets, fore-and-aft
//! magnets, athwartship magnets. Invariants: after every step, the setting is possible with
//! the binnacle and the correctors on board, and after the last it is the plan's. A step
//! whose hole is occupied waits for the other tray, or takes its own out first.

mod step;

mod compass_turn;
mod places;
mod sequence;
mod wording;

pub(crate) use compass_turn::{compass_turn, tolerance_deg};
pub(crate) use places::{elsewhere, moved, replaced, reversed, stands};
pub use step::{Action, Corrector, Place, Step};

use super::heeling;
use super::inputs::Adjustment;
use super::state::MagneticState;
use crate::binnacle::Setting;
use crate::corrector::effect;
use binnacle_compass::angle::wrap_360;
use compass_turn::compass_at_berth;
use sequence::{Movement, sequence};
use wording::{describe_movement, retentive_check};

pub(crate) fn steps(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    to: &Setting,
) -> Vec<Step> {
    let start = adjustment.standing();
    let first_deg = adjustment
        .compass_deg
        .unwrap_or_else(|| compass_at_berth(adjustment, state, &effect(state.binnacle, start)));
    let mut steps = Vec::new();
    let mut before = start.clone();
    let mut shown_deg = first_deg;
    for movement in sequence(state, start, to) {
        let number = steps.len() as u32 + 1;
        let step = step(adjustment, state, number, movement, before, shown_deg);
        shown_deg = step.expected_compass_deg;
        before = step.setting_after.clone();
        steps.push(step);
    }
    steps
}

fn step(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    number: u32,
    movement: Movement,
    before: Setting,
    shown_deg: f64,
) -> Step {
    let Movement {
        corrector,
        from,
        to,
        setting_after: after,
    } = movement;
    let turn = compass_turn(adjustment, state, &before, &after);
    let change_deg = turn.change_deg;
    let tolerance_deg = tolerance_deg(turn.sd_deg, adjustment.earth.h_nt);
    let action = action(from.as_ref(), to.as_ref());
    Step {
        number,
        corrector,
        action,
        words: describe_movement(state, corrector, from.as_ref(), to.as_ref()),
        check: match corrector {
            Corrector::Heeling => heeling::check_instruction(adjustment, state, &before, &after),
            // Iron that comes out needs no check of its retentive magnetism.
            _ => to.as_ref().and_then(|_| retentive_check(corrector)),
        },
        from,
        to,
        expected_compass_deg: wrap_360(shown_deg + change_deg),
        change_deg,
        tolerance_deg,
        seen: change_deg.abs() > tolerance_deg,
        setting_before: before,
        setting_after: after,
    }
}

fn action(from: Option<&Place>, to: Option<&Place>) -> Action {
    match (from, to) {
        (None, _) => Action::Fit,
        (_, None) => Action::TakeOut,
        (Some(Place::Magnets(a)), Some(Place::Magnets(b)))
            if a.count == b.count && a.magnet == b.magnet && a.red == b.red =>
        {
            Action::Move
        }
        (Some(Place::Pair(a)), Some(Place::Pair(b))) if a.size == b.size => Action::Move,
        (Some(Place::Bucket(a)), Some(Place::Bucket(b)))
            if a.count == b.count && a.red == b.red =>
        {
            Action::Move
        }
        _ => Action::Change,
    }
}
