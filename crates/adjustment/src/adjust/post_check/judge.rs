//! Verdict on a second reading.

use super::hypotheses::{HypothesisKind, Posterior};
use super::innovation::Innovation;
use super::result::{Slip, Verdict};
use super::update::update_prediction;
use crate::adjust::diagnosis::{CardCheck, Misreading, Refusal};
use crate::adjust::inputs::{AdjustError, Adjustment, Circumstances, Unit, VerticalReading};
use crate::adjust::limit_violations::find_violations;
use crate::adjust::planning::plan;
use crate::adjust::state::{MagneticState, StateWithSetting};
use crate::berth::BerthReading;
use crate::binnacle::Setting;

/// 99 % quantiles of χ² with two and three degrees of freedom.
const CHI_SQUARED_99: [f64; 2] = [9.210, 11.345];
/// Posterior probability above which a slip is named.
const LIKELY: f64 = 0.5;

/// Complete input of a verdict.
pub(crate) struct Judge<'a> {
    pub(crate) adjustment: &'a Adjustment<'a>,
    pub(crate) state: &'a MagneticState<'a>,
    pub(crate) known: &'a StateWithSetting<'a>,
    pub(crate) reading: &'a BerthReading,
    pub(crate) vertical: Option<VerticalReading>,
    pub(crate) compass_deg: Option<f64>,
    pub(crate) named: Unit,
}

impl Judge<'_> {
    /// Compares the compass, if read, with such a reading.
    pub(crate) fn card(&self, reading: &BerthReading) -> Result<Option<CardCheck>, AdjustError> {
        let Some(read_deg) = self.compass_deg else {
            return Ok(None);
        };
        let standing = self.known.setting.clone();
        let binnacle = self.state.binnacle.with_setting(standing)?;
        let constant_deg = self.adjustment.model.constant_deg;
        let earth = self.adjustment.earth;
        let card = CardCheck::new(read_deg, reading, earth, &binnacle, constant_deg);
        Ok(Some(card))
    }

    pub(crate) fn verdict(
        &self,
        innovation: &Innovation,
        posterior: &[Posterior],
    ) -> Result<Verdict, AdjustError> {
        if self.adjustment.model.covariance.is_none() {
            return Ok(Verdict::Unexplained {
                misreadings: self.misreadings(),
            });
        }
        let fits = posterior.iter().any(|one| {
            one.kind != HypothesisKind::OtherField && one.squared <= chi_squared_limit(innovation)
        });
        if !fits || share_of(posterior, |kind| *kind == HypothesisKind::OtherField) > LIKELY {
            return Ok(Verdict::Unexplained {
                misreadings: self.misreadings(),
            });
        }
        if is_slip(posterior) {
            return self.slip(posterior);
        }
        let updated = update_prediction(self.adjustment, self.known, posterior)?;
        let updated = Box::new(updated);
        let beyond = find_violations(
            self.adjustment,
            self.state,
            &updated.after,
            &updated.model_after,
        );
        if beyond.is_empty() {
            return Ok(Verdict::AsPlanned { updated });
        }
        let standing = self.known.setting.clone();
        let binnacle = Box::new(self.state.binnacle.with_setting(standing)?);
        let outcome = plan(&Adjustment {
            model: &updated.model_after,
            reading: self.reading,
            vertical: self.vertical,
            binnacle: &binnacle,
            now: None,
            // This heading was read before the steps, and the first reading was checked
            // against it.
            compass_deg: None,
            circumstances: Circumstances {
                earlier_lambda: None,
                shifted: None,
                is_updated_here: true,
                ..self.adjustment.circumstances
            },
            ..self.adjustment.clone()
        })?;
        Ok(Verdict::Replan {
            updated,
            refusals: beyond.into_iter().map(Refusal::with_cures).collect(),
            binnacle,
            outcome: Box::new(outcome),
        })
    }

    /// Names the most probable step, and its most probable slip.
    fn slip(&self, posterior: &[Posterior]) -> Result<Verdict, AdjustError> {
        let share_of = |wanted: u32| {
            let those = posterior.iter();
            let those = those.filter(|one| one.kind.step() == Some(wanted));
            those.map(|one| one.share).sum::<f64>()
        };
        let mut best: Option<(f64, &Posterior, u32, Slip, &Setting)> = None;
        for one in posterior {
            let HypothesisKind::Step(number, slip, setting) = &one.kind else {
                continue;
            };
            let rank = share_of(*number) + one.share;
            if best.as_ref().is_none_or(|(most, ..)| rank > *most) {
                best = Some((rank, one, *number, *slip, setting));
            }
        }
        let Some((_, _, step, slip, setting)) = best else {
            return Ok(Verdict::Unexplained {
                misreadings: Vec::new(),
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

    /// Finds misreadings of the magnetometer that make the reading as planned and
    /// consistent with the compass.
    pub(crate) fn misreadings(&self) -> Vec<Misreading> {
        if self.adjustment.model.covariance.is_none() {
            // Without a covariance, the possible differences are unknown.
            return Vec::new();
        }
        let explains = |misreading: &Misreading| {
            let undone = misreading.undone_reading(self.reading, self.vertical, self.named);
            undone.is_some_and(|(reading, vertical)| self.fits(&reading, vertical))
        };
        let whole = Misreading::ALL.into_iter().filter(explains);
        whole.chain(self.misreadings_with_down()).collect()
    }

    /// Finds misreadings that only a vertical part reveals.
    fn misreadings_with_down(&self) -> Vec<Misreading> {
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
            (Misreading::DownReversed, fits([x, y], -down_nt)),
            (
                Misreading::DownInAnotherUnit,
                units.any(|unit| fits([x, y], unit.nt() / self.named.nt() * down_nt)),
            ),
            (Misreading::ForwardDownSwapped, fits([down_nt, y], x)),
            (Misreading::StarboardDownSwapped, fits([x, down_nt], y)),
        ];
        let explaining = found.into_iter().filter(|(_, explains)| *explains);
        explaining.map(|(misreading, _)| misreading).collect()
    }

    /// Returns true when such a reading is as planned and consistent with the compass.
    fn fits(&self, reading: &BerthReading, vertical: Option<VerticalReading>) -> bool {
        let card = self.card(reading).ok().flatten();
        if card.is_some_and(|card| card.is_refused()) {
            return false;
        }
        let innovation =
            Innovation::new(self.adjustment, self.state, self.known, reading, vertical);
        let solved = innovation
            .spread
            .cholesky()
            .map(|spread| spread.solve(&innovation.difference()));
        solved.is_some_and(|solved| {
            innovation.difference().dot(&solved) <= chi_squared_limit(&innovation)
        })
    }
}

/// Returns the probability of hypotheses of a kind together.
fn share_of(posterior: &[Posterior], wanted: fn(&HypothesisKind) -> bool) -> f64 {
    let those = posterior.iter().filter(|one| wanted(&one.kind));
    those.map(|one| one.share).sum()
}

/// Returns whether a corrector is probably not as believed, and rather by a slip of the hand than
/// since before: magnets that stood otherwise before stand right now, and the reading updates the
/// model.
pub(crate) fn is_slip(posterior: &[Posterior]) -> bool {
    let slips = share_of(posterior, |kind| matches!(kind, HypothesisKind::Step(..)));
    let found = share_of(posterior, |kind| matches!(kind, HypothesisKind::AsFound(_)));
    slips + found > LIKELY && slips >= found
}

fn chi_squared_limit(innovation: &Innovation) -> f64 {
    CHI_SQUARED_99[usize::from(innovation.is_vertical_known)]
}
