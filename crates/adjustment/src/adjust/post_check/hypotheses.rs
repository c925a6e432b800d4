//! Hypotheses about the actual setting: slips of the hand in a step, magnets that stood
//! otherwise than recorded, magnets of another moment, and any other difference from the
//! plan.
//!
//! Invariants: each hypothesis has a prior probability. The compass's turn at its step, if
//! read, and the later magnetometer reading raise or lower it. A place with a later
//! movement raises no hypothesis.

use super::innovation::{FieldVector, Innovation, MODEL_SIZE, ModelVector, Perturbation};
use super::result::{CompletedStep, Slip};
use crate::adjust::as_found::{FOUND_OTHERWISE, FoundOtherwise};
use crate::adjust::inputs::Adjustment;
use crate::adjust::instructions::{
    Corrector, Place, compass_turn, moved, replaced, reversed, stands,
};
use crate::adjust::state::{MagneticState, StateWithSetting};
use crate::binnacle::{Axis, Setting, Tray};
use crate::corrector::{Effect, Iron, effect, tray_effect};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::NORMAL_99;
use nalgebra::SMatrix;

/// Prior probability of magnets with the wrong end in a step.
const WRONG_END: f64 = 0.01;
/// Prior probabilities of one, two or three holes off, in one direction.
const HOLES_OFF: [f64; 3] = [0.004, 0.002, 0.002];
/// Prior probability of a step that was not done.
const NOT_DONE: f64 = 0.004;
/// Prior probability of another moment of all magnets of a kind.
pub(crate) const OTHER_MOMENT: f64 = 0.2;
/// Standard deviation of that moment, as a share of it.
pub(crate) const MOMENT_SD: f64 = 0.2;
/// Prior probability of another field.
const OTHER_FIELD: f64 = 0.01;
/// Standard deviation of that field along each axis, nT.
const OTHER_FIELD_NT: f64 = 2_000.0;

/// A possible difference of the ship from the plan.
pub(crate) struct Hypothesis {
    pub(crate) kind: HypothesisKind,
    /// Logarithm of the prior probability.
    log_prior: f64,
    shift: Option<Perturbation>,
    extra_errors: Vec<Perturbation>,
}

/// Kind of hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum HypothesisKind {
    /// No difference.
    AsPlanned,
    /// Another setting in a step, with the resulting setting.
    Step(u32, Slip, Setting),
    /// Magnets of a step that stood with the other end at the first reading than recorded.
    AsFound(u32),
    /// Another moment of a kind of magnets.
    Moment(String),
    /// A field outside the other hypotheses.
    OtherField,
}

impl HypothesisKind {
    /// Returns the number of the step whose corrector is not as believed.
    pub(crate) fn step(&self) -> Option<u32> {
        match self {
            HypothesisKind::Step(number, ..) | HypothesisKind::AsFound(number) => Some(*number),
            _ => None,
        }
    }
}

/// Posterior of a hypothesis after the reading, and the resulting model.
pub(crate) struct Posterior {
    pub(crate) kind: HypothesisKind,
    /// Posterior probability.
    pub(crate) share: f64,
    pub(crate) correction: ModelVector,
    pub(crate) covariance: SMatrix<f64, MODEL_SIZE, MODEL_SIZE>,
    /// Squared residual of the reading under the hypothesis, in standard errors.
    pub(crate) squared: f64,
}

/// Weighs the hypotheses by the compass alone, without those unrelated to a step.
pub(crate) fn weigh_by_compass(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    known: &StateWithSetting<'_>,
    innovation: &Innovation,
    done: &[CompletedStep],
) -> Vec<Posterior> {
    let covariance = covariance(known);
    let hypotheses = hypotheses(adjustment, state, known, innovation, done).into_iter();
    let hypotheses = hypotheses.filter(|hypothesis| hypothesis.kind != HypothesisKind::OtherField);
    normalise(
        hypotheses
            .map(|hypothesis| hypothesis.without_reading(&covariance))
            .collect(),
    )
}

/// Weighs the hypotheses by the reading; probabilities sum to one.
pub(crate) fn weigh_hypotheses(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    known: &StateWithSetting<'_>,
    innovation: &Innovation,
    done: &[CompletedStep],
) -> Vec<Posterior> {
    let covariance = covariance(known);
    let hypotheses = hypotheses(adjustment, state, known, innovation, done);
    let found: Vec<(f64, Posterior)> = hypotheses
        .into_iter()
        .filter_map(|hypothesis| hypothesis.posterior(innovation, &covariance))
        .collect();
    normalise(found)
}

/// Returns the covariance of the prediction.
fn covariance(known: &StateWithSetting<'_>) -> SMatrix<f64, MODEL_SIZE, MODEL_SIZE> {
    let covariance = known.model.covariance.unwrap_or_default();
    SMatrix::from_fn(|r, c| covariance[r][c])
}

/// Converts log-probabilities to probabilities.
fn normalise(found: Vec<(f64, Posterior)>) -> Vec<Posterior> {
    let likeliest = found
        .iter()
        .map(|(log, _)| *log)
        .fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = found.iter().map(|(log, _)| (log - likeliest).exp()).sum();
    let normalised = found.into_iter().map(|(log, posterior)| Posterior {
        share: (log - likeliest).exp() / sum,
        ..posterior
    });
    normalised.collect()
}

impl Hypothesis {
    /// Returns the log-probability and the posterior without a reading.
    fn without_reading(
        self,
        covariance: &SMatrix<f64, MODEL_SIZE, MODEL_SIZE>,
    ) -> (f64, Posterior) {
        let extra_errors = self
            .extra_errors
            .iter()
            .map(|perturbation| perturbation.of_model);
        let posterior = Posterior {
            kind: self.kind,
            share: 0.0,
            correction: self
                .shift
                .map_or_else(ModelVector::zeros, |shift| shift.of_model),
            covariance: extra_errors.fold(*covariance, |sum, way| sum + way * way.transpose()),
            squared: 0.0,
        };
        (self.log_prior, posterior)
    }

    /// Returns the log-probability and the posterior by the reading.
    fn posterior(
        self,
        innovation: &Innovation,
        covariance: &SMatrix<f64, MODEL_SIZE, MODEL_SIZE>,
    ) -> Option<(f64, Posterior)> {
        let nothing = Perturbation {
            of_reading: FieldVector::zeros(),
            of_model: ModelVector::zeros(),
        };
        let shift = self.shift.unwrap_or(nothing);
        let (mut spread, mut cross_covariance, mut covariance) =
            (innovation.spread, innovation.cross_covariance, *covariance);
        for perturbation in &self.extra_errors {
            spread += perturbation.of_reading * perturbation.of_reading.transpose();
            cross_covariance += perturbation.of_model * perturbation.of_reading.transpose();
            covariance += perturbation.of_model * perturbation.of_model.transpose();
        }
        let spread = spread.cholesky()?;
        let difference = innovation.difference() - shift.of_reading;
        let solved = spread.solve(&difference);
        let squared = difference.dot(&solved);
        let size: f64 = spread.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
        let gain = spread.solve(&cross_covariance.transpose()).transpose();
        let posterior = Posterior {
            kind: self.kind,
            share: 0.0,
            correction: shift.of_model + cross_covariance * solved,
            covariance: covariance - gain * cross_covariance.transpose(),
            squared,
        };
        Some((self.log_prior - squared / 2.0 - size, posterior))
    }
}

fn hypotheses(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    known: &StateWithSetting<'_>,
    innovation: &Innovation,
    done: &[CompletedStep],
) -> Vec<Hypothesis> {
    let mut hypotheses = vec![Hypothesis::new(HypothesisKind::AsPlanned, 1.0)];
    let mut places: Vec<&Place> = Vec::new();
    for (index, done) in done.iter().enumerate().rev() {
        let number = index as u32 + 1;
        let to = done.step.to.as_ref();
        let stands = to.is_none_or(|to| stands(&known.setting, done.step.corrector, to));
        if !stands || to.is_some_and(|to| places.contains(&to)) {
            continue;
        }
        places.extend(to);
        let of_step = step_hypotheses(adjustment, state, known, innovation, number, done);
        hypotheses.extend(of_step);
    }
    for (index, done) in done.iter().enumerate() {
        let found = found_otherwise(adjustment, known, innovation, index as u32 + 1, done);
        hypotheses.extend(found);
    }
    for kind in moved_kinds(state, known) {
        let more = Effect::default();
        let more = more.plus(&magnets(state, &known.setting, &kind));
        let more = more.less(&magnets(state, &state.binnacle.setting, &kind));
        let (off, sd, log_shown) = moment_shown(done, &kind);
        hypotheses.push(Hypothesis {
            shift: Some(innovation.perturbation(known, &more.times(off))),
            extra_errors: vec![innovation.perturbation(known, &more.times(sd))],
            log_prior: OTHER_MOMENT.ln() + log_shown,
            ..Hypothesis::new(HypothesisKind::Moment(kind), OTHER_MOMENT)
        });
    }
    let along = |axis: usize| {
        let mut effect = Effect::default();
        effect.b_nt[axis] = OTHER_FIELD_NT;
        innovation.perturbation(known, &effect)
    };
    hypotheses.push(Hypothesis {
        extra_errors: vec![along(0), along(1), along(2)],
        ..Hypothesis::new(HypothesisKind::OtherField, OTHER_FIELD)
    });
    hypotheses
}

/// Estimates another moment of a kind from the turns of its steps: the relative difference,
/// its standard deviation, and the log-likelihood ratio to the assumed moment.
fn moment_shown(done: &[CompletedStep], kind: &str) -> (f64, f64, f64) {
    let of_kind = |place: &Option<Place>| match place {
        Some(Place::Magnets(tray)) => tray.magnet == kind,
        _ => true,
    };
    let (mut weight, mut sum) = (1.0 / MOMENT_SD.powi(2), 0.0);
    for CompletedStep { step, turned_deg } in done {
        let magnets = matches!(
            step.corrector,
            Corrector::ForeAndAft | Corrector::Athwartship
        );
        let Some(turned_deg) = turned_deg else {
            continue;
        };
        if !magnets || !of_kind(&step.from) || !of_kind(&step.to) {
            continue;
        }
        // The whole turn comes from them and is proportional to their moment.
        let by_share = step.change_deg;
        let off_deg = wrap_180(turned_deg - step.change_deg);
        let sd_deg = step.tolerance_deg / NORMAL_99;
        weight += (by_share / sd_deg).powi(2);
        sum += by_share * off_deg / sd_deg.powi(2);
    }
    let off = sum / weight;
    let log_shown = (off * sum - (weight * MOMENT_SD.powi(2)).ln()) / 2.0;
    (off, weight.sqrt().recip(), log_shown)
}

impl Hypothesis {
    fn new(kind: HypothesisKind, prior: f64) -> Hypothesis {
        Hypothesis {
            kind,
            log_prior: prior.ln(),
            shift: None,
            extra_errors: Vec::new(),
        }
    }
}

/// Lists the possible slips of one step.
fn step_hypotheses(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    known: &StateWithSetting<'_>,
    innovation: &Innovation,
    number: u32,
    done: &CompletedStep,
) -> Vec<Hypothesis> {
    let step = &done.step;
    let to = step.to.as_ref();
    let mut others: Vec<(Slip, f64, Option<Place>)> =
        vec![(Slip::NotDone, NOT_DONE, step.from.clone())];
    if let Some(turned) = to.and_then(reversed) {
        others.push((Slip::WrongEnd, WRONG_END, Some(turned)));
    }
    for (holes, prior) in (1..).zip(HOLES_OFF) {
        for by in [holes, -holes] {
            if let Some((place, hole)) = to.and_then(|to| moved(to, by)) {
                others.push((Slip::OtherHole { hole }, prior, Some(place)));
            }
        }
    }
    let hypothesis = |(slip, prior, place): (Slip, f64, Option<Place>)| {
        let instead = |setting: &Setting| replaced(setting, step.corrector, to, place.as_ref());
        let setting = instead(&known.setting);
        state.binnacle.with_setting(setting.clone()).ok()?;
        let more = effect(state.binnacle, &setting).less(&known.effect);
        let shown = done.turned_deg.map_or(0.0, |turned_deg| {
            let off_deg = |after: &Setting| {
                let turn = compass_turn(adjustment, state, &step.setting_before, after);
                wrap_180(turned_deg - turn.change_deg)
            };
            let sd_deg = step.tolerance_deg / NORMAL_99;
            let [so, as_planned] = [instead(&step.setting_after), step.setting_after.clone()];
            (off_deg(&as_planned).powi(2) - off_deg(&so).powi(2)) / (2.0 * sd_deg.powi(2))
        });
        Some(Hypothesis {
            shift: Some(innovation.perturbation(known, &more)),
            log_prior: prior.ln() + shown,
            ..Hypothesis::new(HypothesisKind::Step(number, slip, setting), prior)
        })
    };
    others.into_iter().filter_map(hypothesis).collect()
}

/// Supposes that a step's magnets stood with the other end at the first reading: the ship
/// without correctors is then another.
fn found_otherwise(
    adjustment: &Adjustment<'_>,
    known: &StateWithSetting<'_>,
    innovation: &Innovation,
    number: u32,
    done: &CompletedStep,
) -> Option<Hypothesis> {
    let supposed = FoundOtherwise::suppose(adjustment, &done.step)?;
    let recorded = adjustment.binnacle;
    let more = effect(recorded, &recorded.setting);
    let more = more.less(&effect(recorded, &supposed.binnacle.setting));
    let shown = done.turned_deg.map_or(0.0, |turned_deg| {
        let sd_deg = done.step.tolerance_deg / NORMAL_99;
        let off = |change_deg: f64| (wrap_180(turned_deg - change_deg) / sd_deg).powi(2);
        (off(done.step.change_deg) - off(supposed.change_deg)) / 2.0
    });
    Some(Hypothesis {
        shift: Some(innovation.perturbation(known, &more)),
        log_prior: FOUND_OTHERWISE.ln() + shown,
        ..Hypothesis::new(HypothesisKind::AsFound(number), FOUND_OTHERWISE)
    })
}

/// Lists the kinds of magnets whose setting changed since the first reading.
fn moved_kinds(state: &MagneticState<'_>, known: &StateWithSetting<'_>) -> Vec<String> {
    let was = &state.binnacle.setting;
    let mut kinds = Vec::new();
    for axis in Axis::BOTH {
        let (old, new) = (was.trays(axis), known.setting.trays(axis));
        let only = |these: &[Tray], others: &[Tray]| -> Vec<String> {
            let differing = these.iter().filter(|tray| !others.contains(tray));
            differing.map(|tray| tray.magnet.clone()).collect()
        };
        kinds.extend(only(old, new));
        kinds.extend(only(new, old));
    }
    kinds.sort();
    kinds.dedup();
    kinds
}

/// Returns the effect of the magnets of one kind in a setting.
fn magnets(state: &MagneticState<'_>, setting: &Setting, kind: &str) -> Effect {
    let iron = Iron::new(state.binnacle, &setting.soft());
    let mut sum = Effect::default();
    for axis in Axis::BOTH {
        for tray in setting
            .trays(axis)
            .iter()
            .filter(|tray| tray.magnet == kind)
        {
            sum = sum.plus(&tray_effect(state.binnacle, &iron, axis, tray));
        }
    }
    sum
}
