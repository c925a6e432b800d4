//! Hands that carry out a plan step by step, correctly or with one slip, and follow the
//! check of each step; with or without a second magnetometer reading at the end.

#![allow(clippy::unwrap_used)] // a study

use super::adjusting::knowledge::{FLUXGATE, again};
use super::adjusting::scene::{ALL_KNOWN, Hidden, Scene};
use super::adjusting::wrap;
use super::tally::{mean, quantile};
use binnacle_adjustment::adjust::{
    Adjustment, CompletedStep, Outcome, Place, PredictedTable, Step, StepCheck, Unit, Verdict,
    VerticalReading, check_second_reading, check_step, plan, predict_by_compass,
};
use binnacle_adjustment::berth::BerthReading;
use binnacle_adjustment::binnacle::{Axis, Binnacle, Setting, Tray};
use binnacle_compass::model::Model;
use std::collections::BTreeMap;
use std::fmt;

/// Standard deviation of a card reading, degrees.
const CARD_SD_DEG: f64 = 0.2;
/// Number of steps after which the adjuster gives up.
const MOST_STEPS: usize = 40;
/// Greatest number of second readings.
const MOST_READINGS: usize = 4;

/// Slip in one of the steps with magnets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Slip {
    /// No slip.
    None,
    /// All magnets have this share of their stated moment.
    Moment(f64),
    /// Magnets with the wrong end.
    WrongEnd,
    /// Magnets some holes too high.
    Hole(i32),
    /// Something that the planner does not know, at the berth itself.
    Berth(Hidden),
}

/// Verification after the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ending {
    /// The compass at each step alone.
    ByCompass,
    /// A second magnetometer reading.
    ReadAgain,
}

/// Statistics of many adjustments.
#[derive(Default)]
pub(crate) struct Hands {
    pub(crate) ships: u64,
    /// Verdicts of second readings: without a slip, and with one that remains.
    pub(crate) again: [BTreeMap<&'static str, u64>; 2],
    /// Verdicts on correct steps.
    pub(crate) right: BTreeMap<&'static str, u64>,
    /// Verdicts on slips, by the difference from the expected turn, in classes.
    pub(crate) slips: BTreeMap<(usize, &'static str), u64>,
    /// Endings: at the end of a plan, refused, or sent to look for the cause.
    pub(crate) ended: BTreeMap<&'static str, u64>,
    pub(crate) held: Vec<f64>,
    /// Mean half-width of the band, degrees.
    pub(crate) half_width_deg: Vec<f64>,
    pub(crate) worst_deg: Vec<f64>,
    /// Adjustments that end with a worst true residual beyond the stated one with its band.
    pub(crate) outside: u64,
}

/// Upper ends of the classes of slips, degrees.
pub(crate) const CLASSES_DEG: [f64; 5] = [0.5, 1.0, 2.0, 4.0, f64::INFINITY];

/// Believed and actual work.
struct Work {
    binnacle: Binnacle,
    standing: Setting,
    /// The tray that differs from the belief, with its intended and actual place.
    slipped: Option<(Axis, Tray, Tray)>,
    slip: Slip,
    /// Step of the pending slip.
    slips_at: Option<u32>,
    /// Steps counted as done.
    done: Vec<CompletedStep>,
    readings: usize,
    /// Model after a second reading that required another plan, with that reading.
    learnt: Option<(Model, BerthReading, f64)>,
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

    /// Input of a plan with this setting.
    fn adjustment<'a>(&'a self, scene: &'a Scene, now: &'a Setting) -> Adjustment<'a> {
        let adjustment = Adjustment {
            binnacle: &self.binnacle,
            now: Some(now),
            ..scene.adjustment()
        };
        let Some((model, reading, down_nt)) = &self.learnt else {
            return adjustment;
        };
        let vertical = Some(VerticalReading { down_nt: *down_nt });
        Adjustment {
            model,
            reading,
            vertical,
            ..adjustment
        }
    }

    /// Returns true while a slip of this adjustment remains in the setting.
    fn is_slipped(&self) -> bool {
        self.truly(&self.standing) != self.standing
    }
}

/// Continuation of an adjustment.
enum Next {
    /// The plan's next step.
    Step,
    /// Another plan.
    Plan(Box<Outcome>),
    /// End.
    Ended(&'static str),
}

impl Hands {
    pub(crate) fn from_seeds(seeds: std::ops::Range<u64>, slip: Slip, ending: Ending) -> Hands {
        let mut hands = Hands::default();
        for seed in seeds {
            hands.add(seed, slip, ending);
        }
        hands
    }

    fn add(&mut self, seed: u64, slip: Slip, ending: Ending) {
        let hidden = match slip {
            Slip::Moment(lot_share) => Hidden {
                lot_share,
                ..ALL_KNOWN
            },
            Slip::Berth(hidden) => hidden,
            _ => ALL_KNOWN,
        };
        let mut scene = Scene::with(seed, 0, FLUXGATE, hidden);
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
            Slip::None | Slip::Moment(_) | Slip::Berth(_) => None,
        };
        self.ships += 1;
        let mut work = Work {
            binnacle: scene.binnacle.clone(),
            standing: scene.binnacle.setting.clone(),
            slipped: scene.misrecorded.clone(),
            slip,
            slips_at,
            done: Vec::new(),
            readings: 0,
            learnt: None,
        };
        let ended = self.carry_out(&mut scene, outcome, &mut work, ending);
        *self.ended.entry(ended).or_default() += 1;
    }

    fn carry_out(
        &mut self,
        scene: &mut Scene,
        mut outcome: Outcome,
        work: &mut Work,
        ending: Ending,
    ) -> &'static str {
        let mut at = 0;
        for _ in 0..MOST_STEPS {
            let next = if let Some(step) = outcome.plans[0].steps.get(at) {
                at += 1;
                self.step(scene, &step.clone(), work)
            } else if ending == Ending::ReadAgain {
                self.check_second_reading(scene, work)
            } else {
                let standing = work.standing.clone();
                let adjustment = work.adjustment(scene, &standing);
                let learnt = predict_by_compass(&adjustment, &work.done).unwrap();
                let (limits, waters) = (&adjustment.limits, adjustment.waters);
                if learnt.limit_violation(limits, waters).is_some() {
                    return "asked to read again";
                }
                self.end(scene, &learnt.after, work);
                Next::Ended("done")
            };
            match next {
                Next::Step => {}
                Next::Plan(anew) if anew.plans.is_empty() => return "refused",
                Next::Plan(anew) => (outcome, at) = (*anew, 0),
                Next::Ended(ended) => return ended,
            }
        }
        "without end"
    }

    fn step(&mut self, scene: &mut Scene, step: &Step, work: &mut Work) -> Next {
        let now = work.standing.clone();
        let before_deg = shown(scene, &work.truly(&now));
        let slips = work.slips_at == Some(step.number);
        if slips {
            work.slips_at = None;
            work.slipped = slipped(&work.binnacle, step, work.slip);
        }
        let truly = work.truly(&step.setting_after);
        let after_deg = shown(scene, &truly);
        let adjustment = work.adjustment(scene, &now);
        let found = check_step(&adjustment, step, before_deg, after_deg).unwrap();
        let turned_deg = wrap(after_deg - before_deg);
        let off_deg = wrap(turned_deg - step.change_deg).abs();
        // With magnets of another moment, every step with them is a slip.
        let of_lot = matches!(work.slip, Slip::Moment(_))
            && [&step.from, &step.to]
                .iter()
                .any(|place| matches!(place, Some(Place::Magnets(_))));
        if slips || of_lot {
            let class = CLASSES_DEG
                .iter()
                .position(|most| off_deg <= *most)
                .unwrap();
            *self.slips.entry((class, name(&found))).or_default() += 1;
        } else if work.slips_at.is_some() || work.slip == Slip::None {
            *self.right.entry(name(&found)).or_default() += 1;
        }
        let (setting, binnacle, anew) = match found {
            StepCheck::Confirmed { .. } | StepCheck::NotSeen { .. } => {
                work.standing = step.setting_after.clone();
                let turned_deg = Some(turned_deg);
                let step = step.clone();
                work.done.push(CompletedStep { step, turned_deg });
                return Next::Step;
            }
            StepCheck::WrongEnd {
                setting, outcome, ..
            } => (setting, None, outcome),
            StepCheck::FoundOtherwise {
                setting,
                binnacle,
                outcome,
                ..
            }
            | StepCheck::OtherStrength {
                setting,
                binnacle,
                outcome,
                ..
            } => (setting, Some(binnacle), outcome),
            StepCheck::Unexplained { .. } => return Next::Ended("sent to look"),
        };
        if setting != step.setting_after {
            // Reversed magnets are known from here on.
            work.slipped = None;
        }
        work.standing = setting;
        if let Some(binnacle) = binnacle {
            work.binnacle = *binnacle;
        }
        work.slips_at = None;
        Next::Plan(anew)
    }

    fn check_second_reading(&mut self, scene: &mut Scene, work: &mut Work) -> Next {
        work.readings += 1;
        if work.readings > MOST_READINGS {
            return Next::Ended("never confirmed");
        }
        let truth = scene.at_berth(&work.truly(&work.standing));
        let place = scene.place();
        let (reading, down_nt) = again(&mut scene.rng, &truth, place, FLUXGATE, &scene.berthed);
        let adjustment = work.adjustment(scene, &work.standing);
        let vertical = Some(VerticalReading { down_nt });
        let unit = Unit::Nanotesla;
        let found = check_second_reading(&adjustment, &work.done, &reading, vertical, None, unit);
        let found = found.unwrap().verdict;
        let slipped = usize::from(work.is_slipped());
        let (word, next) = match found {
            Verdict::AsPlanned { updated } => {
                self.end(scene, &updated.after, work);
                ("as planned", Next::Ended("done"))
            }
            Verdict::Replan {
                updated,
                binnacle,
                outcome,
                ..
            } => {
                work.learnt = Some((updated.model_after, reading, down_nt));
                work.binnacle = *binnacle;
                work.done.clear();
                ("beyond limits", Next::Plan(outcome))
            }
            Verdict::Slip { step, .. } => {
                let suspected = work.done[step as usize - 1].step.to.clone();
                let meant = work.slipped.as_ref().map(|(_, meant, _)| meant.clone());
                let found = suspected == meant.map(Place::Magnets) && slipped == 1;
                if found {
                    // An inspection finds the actual setting, and corrects it.
                    work.slipped = None;
                    ("the step suspected", Next::Step)
                } else {
                    ("another step suspected", Next::Ended("sent to look"))
                }
            }
            Verdict::Unexplained { .. } => ("unexplained", Next::Ended("sent to look")),
        };
        *self.again[slipped].entry(word).or_default() += 1;
        next
    }

    fn end(&mut self, scene: &Scene, after: &[PredictedTable], work: &Work) {
        let adjusted = scene.truth.with(&work.truly(&work.standing));
        let (mut held, mut headings, mut worst, mut widths) = (0_u32, 0_u32, 0.0_f64, 0.0);
        let mut is_outside = false;
        for table in after {
            let place = (table.h_nt, table.z_nt);
            let worst_here = adjusted.worst_deg(place);
            is_outside |= table.reach_deg.is_none_or(|reach| worst_here > reach);
            worst = worst.max(worst_here);
            for row in &table.rows {
                let residual = adjusted.deviation_deg(place, row.compass_deg);
                headings += 1;
                let off = wrap(residual - row.deviation_deg);
                held += u32::from(off.abs() <= row.band95_deg.unwrap());
                widths += row.band95_deg.unwrap();
            }
        }
        self.held.push(f64::from(held) / f64::from(headings));
        self.half_width_deg.push(widths / f64::from(headings));
        self.worst_deg.push(worst);
        self.outside += u64::from(is_outside);
    }
}

/// Card reading at the berth, degrees.
fn shown(scene: &mut Scene, setting: &Setting) -> f64 {
    let standing = scene.at_berth(setting);
    let truly = standing.compass_deg(scene.place(), scene.berthed.magnetic_deg);
    (truly + CARD_SD_DEG * scene.rng.gaussian()).rem_euclid(360.0)
}

/// Returns the wrong place of the step's magnets; `None` without such a hole.
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
        Slip::None | Slip::Moment(_) | Slip::Berth(_) => return None,
    }
    Some((axis, meant.clone(), done))
}

fn name(found: &StepCheck) -> &'static str {
    match found {
        StepCheck::Confirmed { .. } => "confirmed",
        StepCheck::NotSeen { .. } => "not seen",
        StepCheck::WrongEnd { .. } => "wrong end",
        StepCheck::FoundOtherwise { .. } => "found otherwise",
        StepCheck::OtherStrength { .. } => "other strength",
        StepCheck::Unexplained { .. } => "unexplained",
    }
}

impl fmt::Display for Hands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plans = self.held.len() as f64;
        let held = mean(&self.held);
        let squares: f64 = self.held.iter().map(|one| (one - held).powi(2)).sum();
        let within = self.worst_deg.iter().filter(|worst| **worst <= 3.0).count() as f64;
        write!(
            f,
            "{} adjustments, ended {:?}; worst beyond the stated {}; band held {:.1} % (standard error {:.1}), mean half-width \
             {:.2}, within 3 degrees {:.1} %; worst {:.2} / {:.2}; right steps {:?}; read again \
             when right {:?}, when slipped {:?}; slips",
            self.ships,
            self.ended,
            self.outside,
            100.0 * held,
            100.0 * squares.sqrt() / plans,
            mean(&self.half_width_deg),
            100.0 * within / plans,
            quantile(&self.worst_deg, 0.5),
            quantile(&self.worst_deg, 0.95),
            self.right,
            self.again[0],
            self.again[1],
        )?;
        for ((class, verdict), count) in &self.slips {
            write!(f, "; to {} degrees {verdict} {count}", CLASSES_DEG[*class])?;
        }
        Ok(())
    }
}
