//! What the compass showed after a step, held against what was expected; and a new
//! plan from there where it was otherwise.

use super::condition::Condition;
use super::instructions::{NORMAL_99, Place, Step, change_deg};
use super::{AdjustError, Adjustment, Outcome, plan};
use crate::angle::wrap_180;
use crate::binnacle::{Axis, Binnacle, BinnacleForm, Calibrated, Setting, Soft};
use crate::corrector::Iron;
use serde::{Deserialize, Serialize};

/// A corrector is not so much weaker or stronger than it is said to be.
const STRENGTHS: std::ops::RangeInclusive<f64> = 0.3..=3.0;

/// What a step came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Recheck {
    /// It did what was expected: the next one may follow.
    Confirmed {
        /// By how much it turned less than, or beyond, what was expected, degrees.
        off_deg: f64,
    },
    /// On this heading the compass does not show it, and showed nothing.
    NotSeen {
        /// What it would have turned by, degrees.
        expected_deg: f64,
    },
    /// The magnets are in with the wrong end: turn them.
    WrongEnd {
        /// What the compass turned by, degrees.
        turned_deg: f64,
        /// How the correctors stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// The corrector is of another strength than was taken: the plan is a new one.
    OtherStrength {
        /// Its strength as a share of what was taken.
        share: f64,
        /// Standard error of that.
        share_sd: f64,
        /// The binnacle as it is now believed to be.
        binnacle: Box<Binnacle>,
        /// How the correctors stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// No strength explains it: read again, see whether the ship moved, look for
    /// magnetism of its own in the iron.
    Unexplained {
        /// By how much it is off, degrees.
        off_deg: f64,
    },
}

/// Judges a step by the compass at the berth before and after it, degrees.
///
/// # Errors
/// When the adjustment itself cannot be, or the headings are not finite.
pub fn recheck(
    adjustment: &Adjustment<'_>,
    step: &Step,
    before_deg: f64,
    after_deg: f64,
) -> Result<Recheck, AdjustError> {
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
            Recheck::Confirmed { off_deg }
        } else {
            Recheck::NotSeen {
                expected_deg: step.change_deg,
            }
        });
    }
    let condition = Condition::new(adjustment)?;
    if let Some(setting) = wrong_end(adjustment, &condition, step, turned_deg) {
        let outcome = Box::new(plan(&Adjustment {
            now: Some(&setting),
            compass_deg: Some(after_deg),
            ..adjustment.clone()
        })?);
        return Ok(Recheck::WrongEnd {
            turned_deg,
            setting,
            outcome,
        });
    }
    let Some((share, binnacle)) = strength(adjustment, step, turned_deg)? else {
        return Ok(Recheck::Unexplained { off_deg });
    };
    let setting = step.setting_after.clone();
    let outcome = Box::new(plan(&Adjustment {
        binnacle: &binnacle,
        now: Some(&setting),
        compass_deg: Some(after_deg),
        ..adjustment.clone()
    })?);
    Ok(Recheck::OtherStrength {
        share,
        share_sd: share_sd(step),
        binnacle: Box::new(binnacle),
        setting,
        outcome,
    })
}

fn share_sd(step: &Step) -> f64 {
    (0.5 / step.change_deg.abs()).min(0.5)
}

/// The setting with the step's magnets turned end for end, if that is what was read.
fn wrong_end(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
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
    let (change, sd) = change_deg(adjustment, condition, &step.setting_before, &setting);
    let tolerance = (NORMAL_99 * sd).max(step.tolerance_deg);
    (wrap_180(turned_deg - change).abs() <= tolerance).then_some(setting)
}

/// How strong the corrector must be for what was read, with the binnacle that has it so.
fn strength(
    adjustment: &Adjustment<'_>,
    step: &Step,
    turned_deg: f64,
) -> Result<Option<(f64, Binnacle)>, AdjustError> {
    if !step.seen {
        return Ok(None);
    }
    let change = |share: f64| -> Result<Option<(f64, Binnacle)>, AdjustError> {
        let Some(binnacle) = scaled(adjustment.binnacle, step, share)? else {
            return Ok(None);
        };
        let condition = Condition::new(&Adjustment {
            binnacle: &binnacle,
            ..adjustment.clone()
        })?;
        let (change, _) = change_deg(
            adjustment,
            &condition,
            &step.setting_before,
            &step.setting_after,
        );
        Ok(Some((change, binnacle)))
    };
    let mut known = (1.0, step.change_deg);
    let mut share = turned_deg / step.change_deg;
    for _ in 0..8 {
        if !STRENGTHS.contains(&share) {
            return Ok(None);
        }
        let Some((found, binnacle)) = change(share)? else {
            return Ok(None);
        };
        if (found - turned_deg).abs() < 0.02 {
            return Ok(Some((share, binnacle)));
        }
        let slope = (found - known.1) / (share - known.0);
        known = (share, found);
        share += (turned_deg - found) / slope;
    }
    Ok(None)
}

/// The binnacle with the step's corrector so much stronger.
fn scaled(binnacle: &Binnacle, step: &Step, share: f64) -> Result<Option<Binnacle>, AdjustError> {
    let sd = share_sd(step);
    let mut form: BinnacleForm = binnacle.clone().into();
    let entry = match step.to.as_ref().or(step.from.as_ref()) {
        Some(Place::Magnets(tray)) => {
            let Some(kind) = binnacle.design.magnet(&tray.magnet) else {
                return Ok(None);
            };
            let moment = binnacle.moment(kind).am2 * share;
            return Ok(Some(binnacle.with_moment(&tray.magnet, moment, sd)?));
        }
        Some(Place::Pair(pair)) => {
            let soft = Soft {
                quadrantal: Some(pair.clone()),
                flinders: None,
            };
            let Some(found) = Iron::new(binnacle, &soft).pair else {
                return Ok(None);
            };
            Calibrated::Quadrantal {
                size: pair.size.clone(),
                mark_mm: pair.mark_mm,
                q: found.q() * share,
                sd,
            }
        }
        Some(Place::Bar(bar)) => {
            let soft = Soft {
                quadrantal: None,
                flinders: Some(bar.clone()),
            };
            let Some(found) = Iron::new(binnacle, &soft).bar else {
                return Ok(None);
            };
            Calibrated::Flinders {
                length_mm: bar.length_mm,
                c: found.c() * share,
                sd,
            }
        }
        _ => return Ok(None),
    };
    form.calibration.retain(|other| !other.same_place(&entry));
    form.calibration.push(entry);
    Ok(Some(Binnacle::try_from(form)?))
}
