//! Hands that carry out a plan step by step, rightly or with one slip, and do what the
//! recheck of each step says.

#![allow(clippy::unwrap_used)] // a study

use super::adjusting::knowledge::FLUXGATE;
use super::adjusting::scene::Scene;
use super::adjusting::wrap;
use binnacle_magnetics::adjust::{Adjustment, Outcome, Place, Recheck, Step, plan, recheck};
use binnacle_magnetics::binnacle::{Axis, Binnacle, Setting, Tray};
use std::collections::BTreeMap;
use std::fmt;

/// How well a card is read, degrees.
const CARD_SD_DEG: f64 = 0.2;
/// Then the adjuster gives up.
const MOST_STEPS: usize = 40;

/// What is done wrong in one of the steps with magnets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Slip {
    /// Nothing.
    None,
    /// All magnets have this share of the moment that they are said to have.
    Moment(f64),
    /// The magnets go in with the wrong end.
    WrongEnd,
    /// The magnets go so many holes too high.
    Hole(i32),
}

/// What came of many adjustments.
#[derive(Default)]
pub(crate) struct Hands {
    pub(crate) ships: u64,
    /// Verdicts on steps that were done rightly.
    pub(crate) right: BTreeMap<&'static str, u64>,
    /// Verdicts on slips, by how far the compass is from what was expected, in classes.
    pub(crate) slips: BTreeMap<(usize, &'static str), u64>,
    /// How they ended: at the end of a plan, refused, or sent to look for the cause.
    pub(crate) ended: BTreeMap<&'static str, u64>,
    pub(crate) held: Vec<f64>,
    pub(crate) worst_deg: Vec<f64>,
}

/// Upper ends of the classes of slips, degrees.
pub(crate) const CLASSES_DEG: [f64; 5] = [0.5, 1.0, 2.0, 4.0, f64::INFINITY];

/// What the hands believe and what is.
struct Work {
    binnacle: Binnacle,
    standing: Setting,
    /// The tray that stands otherwise than believed, and how it truly stands.
    slipped: Option<(Axis, Tray, Tray)>,
}

impl Work {
    fn truly(&self, believed: &Setting) -> Setting {
        let mut truly = believed.clone();
        if let Some((axis, wrong, right)) = &self.slipped {
            for tray in truly.trays_mut(*axis).iter_mut().filter(|t| *t == wrong) {
                tray.clone_from(right);
            }
        }
        truly
    }
}

impl Hands {
    pub(crate) fn of(seeds: std::ops::Range<u64>, slip: Slip) -> Hands {
        let mut hands = Hands::default();
        for seed in seeds {
            hands.add(seed, slip);
        }
        hands
    }

    fn add(&mut self, seed: u64, slip: Slip) {
        let share = if let Slip::Moment(share) = slip {
            share
        } else {
            1.0
        };
        let mut scene = Scene::with_lot(seed, 0, FLUXGATE, share);
        let outcome = plan(&scene.adjustment()).unwrap();
        if outcome.plans.is_empty() {
            return;
        }
        let magnets = outcome.plans[0].steps.iter();
        let magnets = magnets.filter(|step| matches!(step.to, Some(Place::Magnets(_))));
        let magnets: Vec<u32> = magnets.map(|step| step.number).collect();
        let slips_at = match slip {
            Slip::WrongEnd | Slip::Hole(_) => {
                if magnets.is_empty() {
                    return;
                }
                Some(magnets[scene.rng.below(magnets.len())])
            }
            Slip::None | Slip::Moment(_) => None,
        };
        self.ships += 1;
        self.carry_out(&mut scene, outcome, slip, slips_at);
    }

    fn carry_out(
        &mut self,
        scene: &mut Scene,
        mut outcome: Outcome,
        slip: Slip,
        mut slips_at: Option<u32>,
    ) {
        let mut work = Work {
            binnacle: scene.binnacle.clone(),
            standing: scene.binnacle.setting.clone(),
            slipped: None,
        };
        let mut next = 0;
        for _ in 0..MOST_STEPS {
            let Some(step) = outcome.plans[0].steps.get(next).cloned() else {
                *self.ended.entry("done").or_default() += 1;
                self.end(scene, &outcome, &work);
                return;
            };
            let now = work.standing.clone();
            let before_deg = shown(scene, &work.truly(&now));
            let slips = slips_at == Some(step.number);
            if slips {
                slips_at = None;
                work.slipped = slipped(&work.binnacle, &step, slip);
            }
            let truly = work.truly(&step.setting_after);
            let after_deg = shown(scene, &truly);
            let adjustment = Adjustment {
                binnacle: &work.binnacle,
                now: Some(&now),
                ..scene.adjustment()
            };
            let found = recheck(&adjustment, &step, before_deg, after_deg).unwrap();
            let off_deg = wrap(after_deg - before_deg - step.change_deg).abs();
            // Magnets of another moment make every step with them a slip.
            let of_lot = matches!(slip, Slip::Moment(_))
                && [&step.from, &step.to]
                    .iter()
                    .any(|place| matches!(place, Some(Place::Magnets(_))));
            if slips || of_lot {
                let class = CLASSES_DEG
                    .iter()
                    .position(|most| off_deg <= *most)
                    .unwrap();
                *self.slips.entry((class, name(&found))).or_default() += 1;
            } else if slips_at.is_some() || slip == Slip::None {
                *self.right.entry(name(&found)).or_default() += 1;
            }
            next += 1;
            let again = match found {
                Recheck::Confirmed { .. } | Recheck::NotSeen { .. } => {
                    work.standing = step.setting_after;
                    continue;
                }
                Recheck::WrongEnd {
                    setting, outcome, ..
                } => (setting, None, outcome),
                Recheck::OtherStrength {
                    setting,
                    binnacle,
                    outcome,
                    ..
                } => (setting, Some(binnacle), outcome),
                Recheck::Unexplained { .. } => {
                    *self.ended.entry("sent to look").or_default() += 1;
                    return;
                }
            };
            let (setting, binnacle, anew) = again;
            if setting != step.setting_after {
                // What stands the wrong way round is known now.
                work.slipped = None;
            }
            work.standing = setting;
            if let Some(binnacle) = binnacle {
                work.binnacle = *binnacle;
            }
            outcome = *anew;
            next = 0;
            slips_at = None;
            if outcome.plans.is_empty() {
                *self.ended.entry("refused").or_default() += 1;
                return;
            }
        }
        *self.ended.entry("without end").or_default() += 1;
    }

    fn end(&mut self, scene: &Scene, outcome: &Outcome, work: &Work) {
        let adjusted = scene.truth.with(&work.truly(&work.standing));
        let (mut held, mut headings, mut worst) = (0_u32, 0_u32, 0.0_f64);
        for table in &outcome.plans[0].after {
            let place = (table.h_nt, table.z_nt);
            worst = worst.max(adjusted.worst_deg(place));
            for row in &table.rows {
                let residual = adjusted.deviation_deg(place, row.compass_deg);
                headings += 1;
                let off = wrap(residual - row.deviation_deg);
                held += u32::from(off.abs() <= row.band95_deg.unwrap());
            }
        }
        self.held.push(f64::from(held) / f64::from(headings));
        self.worst_deg.push(worst);
    }
}

/// What the card shows at the berth, degrees.
fn shown(scene: &mut Scene, setting: &Setting) -> f64 {
    let standing = scene.truth.with(setting);
    let truly = standing.compass_deg(scene.place(), scene.berthed.magnetic_deg);
    (truly + CARD_SD_DEG * scene.rng.gaussian()).rem_euclid(360.0)
}

/// Where the step's magnets are put instead; nowhere else where there is no such hole.
fn slipped(binnacle: &Binnacle, step: &Step, slip: Slip) -> Option<(Axis, Tray, Tray)> {
    let Some(Place::Magnets(meant)) = &step.to else {
        return None;
    };
    let of = |axis: &Axis| step.setting_after.trays(*axis).contains(meant);
    let axis = Axis::BOTH.into_iter().find(of)?;
    let mut done = meant.clone();
    match slip {
        Slip::WrongEnd => done.red = done.red.reversed(),
        Slip::Hole(higher) => {
            done.hole = u16::try_from(i32::from(done.hole) + higher).ok()?;
            let mut after = step.setting_after.clone();
            for tray in after.trays_mut(axis).iter_mut().filter(|t| *t == meant) {
                tray.clone_from(&done);
            }
            binnacle.with_setting(after).ok()?;
        }
        Slip::None | Slip::Moment(_) => return None,
    }
    Some((axis, meant.clone(), done))
}

fn name(found: &Recheck) -> &'static str {
    match found {
        Recheck::Confirmed { .. } => "confirmed",
        Recheck::NotSeen { .. } => "not seen",
        Recheck::WrongEnd { .. } => "wrong end",
        Recheck::OtherStrength { .. } => "other strength",
        Recheck::Unexplained { .. } => "unexplained",
    }
}

impl fmt::Display for Hands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plans = self.held.len() as f64;
        let held = self.held.iter().sum::<f64>() / plans;
        let within = self.worst_deg.iter().filter(|worst| **worst <= 3.0).count() as f64;
        write!(
            f,
            "{} adjustments, ended {:?}; band held {:.1} %, within 3 degrees {:.1} %; right steps \
             {:?}; slips",
            self.ships,
            self.ended,
            100.0 * held,
            100.0 * within / plans,
            self.right,
        )?;
        for ((class, verdict), count) in &self.slips {
            write!(f, "; to {} degrees {verdict} {count}", CLASSES_DEG[*class])?;
        }
        Ok(())
    }
}
