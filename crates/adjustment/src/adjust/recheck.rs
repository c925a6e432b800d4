//! What the compass showed after a step, held against what was expected; and a new
//! plan from there where it was otherwise.

use super::condition::Condition;
use super::instructions::{NORMAL_99, Place, Step, change_deg, tolerance_deg};
use super::places::{elsewhere, moved, replaced};
use super::reading_of_card::turn_sd_deg;
use super::strength::strength;
use super::{AdjustError, Adjustment, Outcome, plan};
use crate::binnacle::{Axis, Binnacle, Setting};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::NORMAL_95;
use serde::{Deserialize, Serialize};

/// A card that turned by less may not have turned at all, degrees.
const UNMOVED_DEG: f64 = 0.5;
/// Holes are miscounted by no more.
const MISCOUNTED: i32 = 3;
/// What tells an effect no better, 95 %, is said to prove little.
const PROVES_LITTLE: f64 = 0.3;

/// What a step came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Recheck {
    /// It did what was expected: the next one may follow.
    Confirmed {
        /// By how much it turned less than, or beyond, what was expected, degrees.
        off_deg: f64,
        /// What that tells of the corrector, which may be little.
        proven: Proven,
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
        /// The hole near by in which one as strong as was taken would show the same.
        other_hole: Option<u16>,
        /// The binnacle as it is now believed to be.
        binnacle: Box<Binnacle>,
        /// How the correctors stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// No strength that it can have explains it: read again, see whether the ship moved, look for
    /// magnetism of its own in the iron.
    Unexplained {
        /// By how much it is off, degrees.
        off_deg: f64,
        /// Whether the card stands as it stood: the step was perhaps not done, or the
        /// card sticks.
        unmoved: bool,
    },
}

/// What two readings of the card tell of what a corrector does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Proven {
    /// Its effect as a share of what was taken.
    pub share: f64,
    /// How well the two readings tell that, 95 %, as a share of what was taken.
    pub to: f64,
}

/// What all steps together have done to the compass, which is read no worse for it than
/// after one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InAll {
    /// By how much it turned since the berth was read, degrees.
    pub turned_deg: f64,
    /// By how much it should have, degrees.
    pub expected_deg: f64,
    /// The difference, degrees.
    pub off_deg: f64,
    /// Right steps differ by more once in a hundred, degrees.
    pub tolerance_deg: f64,
}

impl Proven {
    fn new(turned_deg: f64, expected_deg: f64, h_nt: f64) -> Proven {
        Proven {
            share: turned_deg / expected_deg,
            to: NORMAL_95 * turn_sd_deg(h_nt) / expected_deg.abs(),
        }
    }

    /// All of it in words.
    pub fn in_words(&self) -> String {
        let share = 100.0 * self.share;
        let to = 100.0 * self.to;
        if self.to > PROVES_LITTLE {
            return format!(
                "{share:.0} per cent of what was expected; on this heading the card tells that \
                 only to within {to:.0} per cent, which proves little"
            );
        }
        format!("{share:.0} per cent of what was expected, to within {to:.0} per cent")
    }
}

impl InAll {
    /// Whether errors explain it.
    pub fn agrees(&self) -> bool {
        self.off_deg.abs() <= self.tolerance_deg
    }

    /// All of it in words.
    pub fn in_words(&self) -> String {
        format!(
            "in all the compass turned by {:.1} degrees since the berth was read, where {:.1} \
             were expected (to {:.1})",
            self.turned_deg, self.expected_deg, self.tolerance_deg
        )
    }
}

/// Holds the compass, read now, against what it read with the magnetometer: small errors
/// of steps, each within its own tolerance, add up.
///
/// # Errors
/// When the adjustment itself cannot be.
pub fn turned_in_all(
    adjustment: &Adjustment<'_>,
    first_deg: f64,
    now: &Setting,
    now_deg: f64,
) -> Result<InAll, AdjustError> {
    let condition = Condition::new(adjustment)?;
    let first = &adjustment.binnacle.setting;
    let (expected_deg, sd_deg) = change_deg(adjustment, &condition, first, now);
    let turned_deg = wrap_180(now_deg - first_deg);
    Ok(InAll {
        turned_deg,
        expected_deg,
        off_deg: wrap_180(turned_deg - expected_deg),
        tolerance_deg: tolerance_deg(sd_deg, adjustment.earth.h_nt),
    })
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
            let proven = Proven::new(turned_deg, step.change_deg, adjustment.earth.h_nt);
            Recheck::Confirmed { off_deg, proven }
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
    let Some(found) = strength(adjustment, step, turned_deg)? else {
        let unmoved = turned_deg.abs() <= UNMOVED_DEG;
        return Ok(Recheck::Unexplained { off_deg, unmoved });
    };
    let setting = step.setting_after.clone();
    let outcome = Box::new(plan(&Adjustment {
        binnacle: &found.binnacle,
        now: Some(&setting),
        compass_deg: Some(after_deg),
        ..adjustment.clone()
    })?);
    Ok(Recheck::OtherStrength {
        share: found.share,
        share_sd: found.share_sd,
        other_hole: other_hole(adjustment, &condition, step, turned_deg),
        binnacle: Box::new(found.binnacle),
        setting,
        outcome,
    })
}

/// What a step came to whose corrector, it turns out, stands as `setting` says: the step as
/// it was done, and the binnacle, its corrector as strong as the compass shows where that
/// was read since. `adjustment` is that of before the step.
///
/// # Errors
/// When the adjustment itself cannot be.
pub fn recheck_elsewhere(
    adjustment: &Adjustment<'_>,
    step: &Step,
    before_deg: f64,
    setting: &Setting,
    compass_deg: Option<f64>,
) -> Result<(Step, Binnacle), AdjustError> {
    let condition = Condition::new(adjustment)?;
    let (change_deg, sd_deg) = change_deg(adjustment, &condition, &step.setting_before, setting);
    let tolerance_deg = (NORMAL_99 * sd_deg).max(step.tolerance_deg);
    let to = step.to.as_ref();
    let done = Step {
        to: match to {
            Some(to) if step.is_gainsaid(&step.setting_after, setting) => {
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
        Some(turned_deg) => strength(adjustment, &done, turned_deg)?,
        None => None,
    };
    let binnacle = found.map_or_else(|| adjustment.binnacle.clone(), |found| found.binnacle);
    Ok((done, binnacle))
}

/// The hole near the step's own in which its magnets, as strong as was taken, would turn the
/// compass by what was read.
fn other_hole(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    step: &Step,
    turned_deg: f64,
) -> Option<u16> {
    let to = step.to.as_ref()?;
    let off = |by: i32| {
        let (place, hole) = moved(to, by)?;
        let setting = replaced(&step.setting_after, step.corrector, Some(to), Some(&place));
        condition.binnacle.with_setting(setting.clone()).ok()?;
        let (change, sd) = change_deg(adjustment, condition, &step.setting_before, &setting);
        let off_deg = wrap_180(turned_deg - change).abs();
        let tolerance_deg = (NORMAL_99 * sd).max(step.tolerance_deg);
        (off_deg <= tolerance_deg).then_some((off_deg, hole))
    };
    let others = (-MISCOUNTED..=MISCOUNTED).filter(|by| *by != 0);
    let nearest = others.filter_map(off).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, hole)| hole)
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
