//! Check of a step by the observed turn of the compass, with a new plan where it differs.

mod corrector_scale;
mod result;

pub use result::{ProvenEffect, StepCheck, TotalTurn};

use super::as_found::{FoundOtherwise, log_density};
use super::inputs::{AdjustError, Adjustment};
use super::instructions::{Place, Step, compass_turn, elsewhere, moved, replaced, tolerance_deg};
use super::planning::plan;
use super::post_check::{MOMENT_SD, OTHER_MOMENT};
use super::state::MagneticState;
use crate::binnacle::{Axis, Binnacle, Setting};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::NORMAL_99;
use corrector_scale::{CorrectorScale, find_scale};

/// Turn below which the card may not have moved, degrees.
const UNMOVED_DEG: f64 = 0.5;
/// Greatest miscount of holes.
const MISCOUNTED: i32 = 3;
/// Compares the present compass heading with that at the magnetometer reading: small errors
/// of the steps, each within its own tolerance, add up.
///
/// # Errors
/// Fails when the input of the adjustment is invalid.
pub fn check_total_turn(
    adjustment: &Adjustment<'_>,
    first_deg: f64,
    now: &Setting,
    now_deg: f64,
) -> Result<TotalTurn, AdjustError> {
    let state = MagneticState::new(adjustment)?;
    let first = &adjustment.binnacle.setting;
    let turn = compass_turn(adjustment, &state, first, now);
    let turned_deg = wrap_180(now_deg - first_deg);
    Ok(TotalTurn {
        turned_deg,
        expected_deg: turn.change_deg,
        off_deg: wrap_180(turned_deg - turn.change_deg),
        tolerance_deg: tolerance_deg(turn.sd_deg, adjustment.earth.h_nt),
    })
}

/// Judges a step by the compass headings before and after it, degrees.
///
/// # Errors
/// Fails when the input of the adjustment is invalid, or the headings are not finite.
pub fn check_step(
    adjustment: &Adjustment<'_>,
    step: &Step,
    before_deg: f64,
    after_deg: f64,
) -> Result<StepCheck, AdjustError> {
    for (field, value) in [("before_deg", before_deg), ("after_deg", after_deg)] {
        if !(0.0..=360.0).contains(&value) {
            return Err(AdjustError::Value {
                field,
                value,
                least: 0.0,
                greatest: 360.0,
            });
        }
    }
    let turned_deg = wrap_180(after_deg - before_deg);
    let off_deg = wrap_180(turned_deg - step.change_deg);
    if off_deg.abs() <= step.tolerance_deg {
        return Ok(if step.seen {
            let proven = ProvenEffect::new(turned_deg, step.change_deg, adjustment.earth.h_nt);
            StepCheck::Confirmed { off_deg, proven }
        } else {
            StepCheck::NotSeen {
                expected_deg: step.change_deg,
            }
        });
    }
    let state = MagneticState::new(adjustment)?;
    if let Some(setting) = wrong_end(adjustment, &state, step, turned_deg) {
        let outcome = Box::new(plan(&Adjustment {
            now: Some(&setting),
            compass_deg: Some(after_deg),
            ..adjustment.clone()
        })?);
        return Ok(StepCheck::WrongEnd {
            turned_deg,
            setting,
            outcome,
        });
    }
    let Some(cause) = find_cause(adjustment, step, turned_deg)? else {
        let unmoved = turned_deg.abs() <= UNMOVED_DEG;
        return Ok(StepCheck::Unexplained { off_deg, unmoved });
    };
    let setting = step.setting_after.clone();
    let outcome = Box::new(plan(&Adjustment {
        binnacle: cause.binnacle(),
        now: Some(&setting),
        compass_deg: Some(after_deg),
        ..adjustment.clone()
    })?);
    Ok(match cause {
        Cause::Record(supposed) => StepCheck::FoundOtherwise {
            turned_deg,
            binnacle: Box::new(supposed.binnacle),
            setting,
            outcome,
        },
        Cause::Strength {
            found,
            or_record_wrong,
        } => StepCheck::OtherStrength {
            share: found.share,
            share_sd: found.share_sd,
            other_hole: other_hole(adjustment, &state, step, turned_deg),
            or_found_otherwise: or_record_wrong,
            binnacle: Box::new(found.binnacle),
            setting,
            outcome,
        },
    })
}

/// Cause of another turn than expected, with the step as said.
enum Cause {
    /// The magnets stood with the other end than recorded.
    Record(FoundOtherwise),
    /// The corrector has another strength.
    Strength {
        found: CorrectorScale,
        /// True if a wrong record would explain the turn too.
        or_record_wrong: bool,
    },
}

impl Cause {
    fn binnacle(&self) -> &Binnacle {
        match self {
            Cause::Record(supposed) => &supposed.binnacle,
            Cause::Strength { found, .. } => &found.binnacle,
        }
    }
}

/// Finds the likelier cause of the turn. Magnets that come from a deep hole turn the compass a
/// little more if the record of their end is wrong, as stronger magnets do.
fn find_cause(
    adjustment: &Adjustment<'_>,
    step: &Step,
    turned_deg: f64,
) -> Result<Option<Cause>, AdjustError> {
    let supposed = FoundOtherwise::suppose(adjustment, step)
        .filter(|supposed| supposed.off_deg(turned_deg).abs() <= supposed.tolerance_deg);
    let found = find_scale(adjustment, step, turned_deg)?;
    let found = match (&supposed, found) {
        (Some(supposed), Some(_))
            if supposed.log_weight(turned_deg) >= log_weight_of_strength(step, turned_deg) =>
        {
            None
        }
        (_, found) => found,
    };
    Ok(match (supposed, found) {
        (supposed, Some(found)) => Some(Cause::Strength {
            found,
            or_record_wrong: supposed.is_some(),
        }),
        (supposed, None) => supposed.map(Cause::Record),
    })
}

/// Logarithm of the prior probability of another moment times the density of the turn, per degree.
fn log_weight_of_strength(step: &Step, turned_deg: f64) -> f64 {
    let off_deg = wrap_180(turned_deg - step.change_deg);
    let sd_deg = (step.tolerance_deg / NORMAL_99).hypot(MOMENT_SD * step.change_deg);
    OTHER_MOMENT.ln() + log_density(off_deg, sd_deg)
}

/// Judges a step whose corrector turns out to be in the place of `setting`: returns the
/// completed step, and the binnacle with the strength or the record that the compass shows, if it
/// was read since. `adjustment` is that before the step.
///
/// # Errors
/// Fails when the input of the adjustment is invalid.
pub fn check_step_with_setting(
    adjustment: &Adjustment<'_>,
    step: &Step,
    before_deg: f64,
    setting: &Setting,
    compass_deg: Option<f64>,
) -> Result<(Step, Binnacle), AdjustError> {
    let state = MagneticState::new(adjustment)?;
    let turn = compass_turn(adjustment, &state, &step.setting_before, setting);
    let change_deg = turn.change_deg;
    let tolerance_deg = (NORMAL_99 * turn.sd_deg).max(step.tolerance_deg);
    let to = step.to.as_ref();
    let done = Step {
        to: match to {
            Some(to) if step.is_contradicted(&step.setting_after, setting) => {
                elsewhere(setting, step.corrector, to, &step.setting_after)
            }
            to => to.cloned(),
        },
        change_deg,
        tolerance_deg,
        seen: change_deg.abs() > tolerance_deg,
        setting_after: setting.clone(),
        ..step.clone()
    };
    let turned_deg = compass_deg.map(|compass_deg| wrap_180(compass_deg - before_deg));
    let otherwise =
        turned_deg.filter(|turned_deg| wrap_180(turned_deg - change_deg).abs() > tolerance_deg);
    let found = match otherwise {
        Some(turned_deg) => find_cause(adjustment, &done, turned_deg)?,
        None => None,
    };
    let binnacle = found.as_ref().map_or(adjustment.binnacle, Cause::binnacle);
    Ok((done, binnacle.clone()))
}

/// Finds a nearby hole in which unscaled magnets would explain the turn.
fn other_hole(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    step: &Step,
    turned_deg: f64,
) -> Option<u16> {
    let to = step.to.as_ref()?;
    let off = |by: i32| {
        let (place, hole) = moved(to, by)?;
        let setting = replaced(&step.setting_after, step.corrector, Some(to), Some(&place));
        state.binnacle.with_setting(setting.clone()).ok()?;
        let turn = compass_turn(adjustment, state, &step.setting_before, &setting);
        let off_deg = wrap_180(turned_deg - turn.change_deg).abs();
        let tolerance_deg = (NORMAL_99 * turn.sd_deg).max(step.tolerance_deg);
        (off_deg <= tolerance_deg).then_some((off_deg, hole))
    };
    let others = (-MISCOUNTED..=MISCOUNTED).filter(|by| *by != 0);
    let nearest = others.filter_map(off).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, hole)| hole)
}

/// Returns the setting with the step's magnets reversed, if that explains the turn.
fn wrong_end(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    step: &Step,
    turned_deg: f64,
) -> Option<Setting> {
    let Some(Place::Magnets(tray)) = &step.to else {
        return None;
    };
    let mut setting = step.setting_after.clone();
    for axis in Axis::BOTH {
        for other in setting
            .trays_mut(axis)
            .iter_mut()
            .filter(|other| *other == tray)
        {
            other.red = other.red.reversed();
        }
    }
    let turn = compass_turn(adjustment, state, &step.setting_before, &setting);
    let tolerance = (NORMAL_99 * turn.sd_deg).max(step.tolerance_deg);
    (wrap_180(turned_deg - turn.change_deg).abs() <= tolerance).then_some(setting)
}
