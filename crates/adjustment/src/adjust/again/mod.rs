//! The magnetometer read once more, after the steps: what the compass on one heading cannot
//! show, the field can.
//!
//! With the bowl out again the same magnetometer lies in the same place. What it reads less
//! what was foretold is told apart into errors that were to be expected, which sharpen the
//! model, and slips of the hand, which are named. What always holds: a reading that fits
//! makes the band no narrower than all that may still be wrong together leaves it; one that
//! a slip explains better names the step; one that nothing explains confirms nothing
//! (docs/science.md, §11).

mod doubts;
mod form;
mod news;

pub use form::AgainForm;

use super::beyond::beyond_limits;
use super::card::Card;
use super::condition::{Condition, Known};
use super::heeling::VerticalReading;
use super::instructions::Step;
use super::mistakes::Mistake;
use super::predicted::{PredictedTable, tables_by};
use super::read::Unit;
use super::{AdjustError, Adjustment, Circumstances, Outcome, Refused, plan};
use crate::berth::BerthReading;
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::ship::PARAMETERS;
use doubts::{Weighed, What, weigh, weigh_by_compass};
use nalgebra::SMatrix;
use news::{EIGHT, Eight, News};
use serde::{Deserialize, Serialize};

/// Of a hundred right readings one is read again: χ² of two parts, and of three.
const CHI_SQUARED_99: [f64; 2] = [9.210, 11.345];
/// With more belief than this a slip is named.
const LIKELY: f64 = 0.5;

/// A step that was done.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// The step.
    pub step: Step,
    /// By how much the compass turned, degrees, where it was read.
    pub turned_deg: Option<f64>,
}

/// What the second reading came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Again {
    /// Forward, to starboard and, where it was read both times, down.
    pub parts: Vec<Part>,
    /// The compass held against the field, where it was read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub card: Option<Card>,
    /// What to make of it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// One part of the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// What was foretold, nT.
    pub expected_nt: f64,
    /// What was read, nT.
    pub read_nt: f64,
    /// Standard error of the difference, nT.
    pub standard_error_nt: f64,
}

/// What to make of a second reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// The correctors do what they were to do.
    AsPlanned {
        /// What is foretold now.
        learnt: Box<Learnt>,
    },
    /// They do, but what is foretold now is beyond the limits: there is a plan from here.
    Replan {
        /// What is foretold now.
        learnt: Box<Learnt>,
        /// What of it is beyond the limits.
        refusals: Vec<Refused>,
        /// The binnacle with its correctors as they stand.
        binnacle: Box<Binnacle>,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// A step was done otherwise: look at it.
    Slip {
        /// Its place among those that were done, from 1.
        step: u32,
        /// What is suspected.
        slip: Slip,
        /// Belief in that step's slip, 0 to 1.
        share: f64,
        /// How the correctors would stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// Nothing explains it: read again.
    Unexplained {
        /// Mistakes each of which alone would explain it.
        mistakes: Vec<Mistake>,
    },
}

/// How a step was done instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "slip", rename_all = "snake_case")]
pub enum Slip {
    /// The magnets went in with the wrong end.
    WrongEnd,
    /// They went into another hole or position.
    OtherHole {
        /// Its number.
        hole: u16,
    },
    /// It was not done.
    NotDone,
}

/// What is foretold after the second reading, or after the steps without one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learnt {
    /// The model that holds from now on, with covariance.
    pub model_after: Model,
    /// Residuals at the berth and in the waters.
    pub after: Vec<PredictedTable>,
    /// The greatest residual in any of them, degrees.
    pub worst_residual_deg: f64,
    /// The widest 95 % band in any of them, degrees.
    pub widest_band_deg: f64,
}

/// Judges a second reading by the same magnetometer, the correctors standing as
/// `adjustment.now` says after these steps. `named` is the unit that its figures were said
/// to be in, `compass_deg` what the compass read before the bowl was taken out.
///
/// # Errors
/// When the adjustment itself cannot be.
pub fn read_again(
    adjustment: &Adjustment<'_>,
    done: &[Done],
    reading: &BerthReading,
    vertical: Option<VerticalReading>,
    compass_deg: Option<f64>,
    named: Unit,
) -> Result<Again, AdjustError> {
    super::given::check(adjustment)?;
    if let Some(vertical) = vertical {
        vertical.must_be_a_field()?;
    }
    let condition = Condition::new(adjustment)?;
    let known = condition.known_with(adjustment.standing())?;
    let news = News::new(adjustment, &condition, &known, reading, vertical);
    let weighed = weigh(adjustment, &condition, &known, &news, done);
    let judge = Judge {
        adjustment,
        condition: &condition,
        known: &known,
        reading,
        vertical,
        compass_deg,
        named,
    };
    let card = judge.card(reading)?;
    let verdict = if card.is_some_and(|card| card.is_refused()) {
        Verdict::Unexplained {
            mistakes: judge.mistakes(),
        }
    } else {
        judge.verdict(&news, &weighed)?
    };
    Ok(Again {
        parts: parts(&news),
        card,
        verdict,
    })
}

/// What is foretold of correctors that stand as `adjustment.now` says after these steps,
/// where the field was not read again: what the compass leaves open of slips and of
/// magnets' moments is in the band.
///
/// # Errors
/// When the adjustment itself cannot be.
pub fn by_compass(adjustment: &Adjustment<'_>, done: &[Done]) -> Result<Learnt, AdjustError> {
    super::given::check(adjustment)?;
    let condition = Condition::new(adjustment)?;
    let known = condition.known_with(adjustment.standing())?;
    let reading = adjustment.reading;
    let news = News::new(adjustment, &condition, &known, reading, adjustment.vertical);
    let weighed = weigh_by_compass(adjustment, &condition, &known, &news, done);
    learnt(adjustment, &condition, &known, &weighed)
}

fn parts(news: &News) -> Vec<Part> {
    let count = if news.is_vertical_known { 3 } else { 2 };
    let part = |axis: usize| Part {
        expected_nt: news.expected[axis],
        read_nt: news.read[axis],
        standard_error_nt: news.spread[(axis, axis)].sqrt(),
    };
    (0..count).map(part).collect()
}

/// All that a verdict leans on.
struct Judge<'a> {
    adjustment: &'a Adjustment<'a>,
    condition: &'a Condition<'a>,
    known: &'a Known<'a>,
    reading: &'a BerthReading,
    vertical: Option<VerticalReading>,
    compass_deg: Option<f64>,
    named: Unit,
}

impl Judge<'_> {
    /// The compass, where it was read, held against such a reading.
    fn card(&self, reading: &BerthReading) -> Result<Option<Card>, AdjustError> {
        let Some(read_deg) = self.compass_deg else {
            return Ok(None);
        };
        let standing = self.known.setting.clone();
        let binnacle = self.condition.binnacle.with_setting(standing)?;
        let constant_deg = self.adjustment.model.constant_deg;
        let earth = self.adjustment.earth;
        let card = Card::new(read_deg, reading, earth, &binnacle, constant_deg);
        Ok(Some(card))
    }

    fn verdict(&self, news: &News, weighed: &[Weighed]) -> Result<Verdict, AdjustError> {
        if self.adjustment.model.covariance.is_none() {
            return Ok(Verdict::Unexplained {
                mistakes: self.mistakes(),
            });
        }
        let fits = weighed
            .iter()
            .any(|one| one.what != What::Elsewhere && one.squared <= greatest(news));
        let share_of = |wanted: fn(&What) -> bool| {
            let those = weighed.iter().filter(|one| wanted(&one.what));
            those.map(|one| one.share).sum::<f64>()
        };
        if !fits || share_of(|what| *what == What::Elsewhere) > LIKELY {
            return Ok(Verdict::Unexplained {
                mistakes: self.mistakes(),
            });
        }
        if share_of(|what| matches!(what, What::Step(..))) > LIKELY {
            return self.slip(weighed);
        }
        let learnt = learnt(self.adjustment, self.condition, self.known, weighed)?;
        let learnt = Box::new(learnt);
        let beyond = beyond_limits(
            self.adjustment,
            self.condition,
            &learnt.after,
            &learnt.model_after,
        );
        if beyond.is_empty() {
            return Ok(Verdict::AsPlanned { learnt });
        }
        let standing = self.known.setting.clone();
        let binnacle = Box::new(self.condition.binnacle.with_setting(standing)?);
        let outcome = plan(&Adjustment {
            model: &learnt.model_after,
            reading: self.reading,
            vertical: self.vertical,
            binnacle: &binnacle,
            now: None,
            // That was read before the steps, and the first reading was held against this.
            compass_deg: None,
            circumstances: Circumstances {
                earlier_lambda: None,
                has_learnt_here: true,
                ..self.adjustment.circumstances
            },
            ..self.adjustment.clone()
        })?;
        Ok(Verdict::Replan {
            learnt,
            refusals: beyond
                .into_iter()
                .map(super::refusal::Refusal::with_cures)
                .collect(),
            binnacle,
            outcome: Box::new(outcome),
        })
    }

    /// The step that is doubted most, and the likeliest way in which it was done.
    fn slip(&self, weighed: &[Weighed]) -> Result<Verdict, AdjustError> {
        let share_of = |wanted: u32| {
            let those = weighed
                .iter()
                .filter(|one| matches!(one.what, What::Step(number, ..) if number == wanted));
            those.map(|one| one.share).sum::<f64>()
        };
        let mut best: Option<(f64, &Weighed, u32, Slip, &Setting)> = None;
        for one in weighed {
            let What::Step(number, slip, setting) = &one.what else {
                continue;
            };
            let rank = share_of(*number) + one.share;
            if best.as_ref().is_none_or(|(most, ..)| rank > *most) {
                best = Some((rank, one, *number, *slip, setting));
            }
        }
        let Some((_, _, step, slip, setting)) = best else {
            return Ok(Verdict::Unexplained {
                mistakes: Vec::new(),
            });
        };
        let outcome = plan(&Adjustment {
            now: Some(setting),
            compass_deg: None,
            ..self.adjustment.clone()
        })?;
        Ok(Verdict::Slip {
            step,
            slip,
            share: share_of(step),
            setting: setting.clone(),
            outcome: Box::new(outcome),
        })
    }

    /// What done otherwise with the magnetometer would make it as planned, and the compass
    /// agree with it.
    fn mistakes(&self) -> Vec<Mistake> {
        if self.adjustment.model.covariance.is_none() {
            // Nothing is known of what differences there may be.
            return Vec::new();
        }
        let explains = |mistake: &Mistake| {
            let undone = mistake.undone_reading(self.reading, self.vertical, self.named);
            undone.is_some_and(|(reading, vertical)| self.fits(&reading, vertical))
        };
        let whole = Mistake::ALL.into_iter().filter(explains);
        whole.chain(self.mistakes_with_down()).collect()
    }

    /// Those that only a vertical part tells.
    fn mistakes_with_down(&self) -> Vec<Mistake> {
        let (Some(_), Some(vertical)) = (self.adjustment.vertical, self.vertical) else {
            return Vec::new();
        };
        let ([x, y], down_nt) = (self.reading.field_nt(), vertical.down_nt);
        let fits = |field_nt: [f64; 2], down_nt: f64| {
            let (errors, alignment) = (self.reading.errors(), self.reading.alignment());
            let undone = BerthReading::new(self.reading.magnetic(), field_nt, errors, alignment);
            undone.is_ok_and(|undone| self.fits(&undone, Some(VerticalReading { down_nt })))
        };
        let mut units = Unit::ALL.iter().filter(|unit| **unit != self.named);
        let found = [
            (Mistake::DownReversed, fits([x, y], -down_nt)),
            (
                Mistake::DownInAnotherUnit,
                units.any(|unit| fits([x, y], unit.nt() / self.named.nt() * down_nt)),
            ),
            (Mistake::ForwardDownSwapped, fits([down_nt, y], x)),
            (Mistake::StarboardDownSwapped, fits([x, down_nt], y)),
        ];
        let explaining = found.into_iter().filter(|(_, explains)| *explains);
        explaining.map(|(mistake, _)| mistake).collect()
    }

    /// Whether such a reading is as planned, and turns the compass to what it read.
    fn fits(&self, reading: &BerthReading, vertical: Option<VerticalReading>) -> bool {
        let card = self.card(reading).ok().flatten();
        if card.is_some_and(|card| card.is_refused()) {
            return false;
        }
        let news = News::new(
            self.adjustment,
            self.condition,
            self.known,
            reading,
            vertical,
        );
        let solved = news
            .spread
            .cholesky()
            .map(|spread| spread.solve(&news.off()));
        solved.is_some_and(|solved| news.off().dot(&solved) <= greatest(&news))
    }
}

/// The mean of all that may be, and its spread.
fn learnt(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    known: &Known<'_>,
    weighed: &[Weighed],
) -> Result<Learnt, AdjustError> {
    let mean: Eight = weighed.iter().map(|one| one.correction * one.share).sum();
    let mut spread = SMatrix::<f64, EIGHT, EIGHT>::zeros();
    for one in weighed {
        let apart = one.correction - mean;
        spread += (one.covariance + apart * apart.transpose()) * one.share;
    }
    let spread = (spread + spread.transpose()) / 2.0;
    let model_after = corrected(&known.model, &mean, &spread);
    let after = tables_by(adjustment, |earth| {
        let foretold = condition.model_at(&known.model, &known.setting, earth)?;
        Ok::<Model, DeviationError>(corrected(&foretold, &mean, &spread))
    })?;
    let greatest =
        |of: fn(&PredictedTable) -> Option<f64>| after.iter().filter_map(of).fold(0.0, f64::max);
    Ok(Learnt {
        worst_residual_deg: greatest(|table| table.worst_deg),
        widest_band_deg: greatest(|table| table.widest_band_deg),
        model_after,
        after,
    })
}

fn greatest(news: &News) -> f64 {
    CHI_SQUARED_99[usize::from(news.is_vertical_known)]
}

fn corrected(model: &Model, correction: &Eight, covariance: &SMatrix<f64, EIGHT, EIGHT>) -> Model {
    let parameters = model.parameters_over_lambda.to_array();
    let parameters = std::array::from_fn(|i| parameters[i] + correction[i]);
    Model {
        parameters_over_lambda: Parameters::from_array(parameters),
        constant_deg: model.constant_deg + correction[PARAMETERS],
        covariance: Some(covariance.transpose().into()),
        ..model.clone()
    }
}

#[cfg(test)]
mod tests;
