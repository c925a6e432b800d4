//! Verdict on a second reading.

use super::hypotheses::{Weighed, What};
use super::innovation::News;
use super::result::{Slip, Verdict};
use super::update::learnt;
use crate::adjust::diagnosis::{Card, Mistake, Refusal};
use crate::adjust::inputs::{AdjustError, Adjustment, Circumstances, Unit, VerticalReading};
use crate::adjust::limit_violations::beyond_limits;
use crate::adjust::planning::plan;
use crate::adjust::state::{Condition, Known};
use crate::berth::BerthReading;
use crate::binnacle::Setting;

/// Of a hundred right readings one is read again: χ² of two parts, and of three.
const CHI_SQUARED_99: [f64; 2] = [9.210, 11.345];
/// With more belief than this a slip is named.
const LIKELY: f64 = 0.5;

/// All that a verdict leans on.
pub(crate) struct Judge<'a> {
    pub(crate) adjustment: &'a Adjustment<'a>,
    pub(crate) condition: &'a Condition<'a>,
    pub(crate) known: &'a Known<'a>,
    pub(crate) reading: &'a BerthReading,
    pub(crate) vertical: Option<VerticalReading>,
    pub(crate) compass_deg: Option<f64>,
    pub(crate) named: Unit,
}

impl Judge<'_> {
    /// The compass, where it was read, held against such a reading.
    pub(crate) fn card(&self, reading: &BerthReading) -> Result<Option<Card>, AdjustError> {
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

    pub(crate) fn verdict(&self, news: &News, weighed: &[Weighed]) -> Result<Verdict, AdjustError> {
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
            refusals: beyond.into_iter().map(Refusal::with_cures).collect(),
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
    pub(crate) fn mistakes(&self) -> Vec<Mistake> {
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

fn greatest(news: &News) -> f64 {
    CHI_SQUARED_99[usize::from(news.is_vertical_known)]
}
