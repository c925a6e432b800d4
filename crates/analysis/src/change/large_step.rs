//! A step that is far larger than most: lightning can leave many times what cargo does.
//!
//! What always holds: a ship to whom nothing large happened has none of these copies, so
//! that small changes are judged as if there were none; each reads every row linearised at
//! the ship that it supposes, for deviation is not linear in a large step.

use super::filter::{Filter, Measurement, NoiseVariances};
use super::hypotheses::{Fork, HypothesisBank};
use super::hypothesis_kind::HypothesisKind;
use super::jump_models::apply_jump;
use crate::change::thresholds::{LARGE_STEP_DEG, LARGE_STEP_MAX_ROWS};
use crate::estimate::{USUAL_FUSION, Unknowns};

/// A row is linearised again where it moves what is expected of it by more than this,
/// degrees, and so often at most.
const RELINEARISE_BEYOND_DEG: f64 = 2.0;
const LINEARISATION_ROUNDS: usize = 6;
/// A ship whose bx and by are beyond this is a strong magnet, population units (1500 nT).
const STRONG_MAGNET: f64 = 4.0;
/// One that is off by more than this is a wild reading, squared standard deviations.
const OUTLIER_Z_SQUARED: f64 = 9.0;

/// The share that the reference has in the heading at which rows are taken: all of it for a
/// ship so strong a magnet that her compass may turn several times as fast as she does,
/// for there what the compass has in it would explain whatever it shows.
pub(crate) fn reference_share(ship: &Unknowns) -> f64 {
    if ship[0].hypot(ship[2]) > STRONG_MAGNET {
        1.0
    } else {
        USUAL_FUSION
    }
}

/// The row linearised at the ship that `filter` takes her for once it has read it, where
/// that is far from the ship before.
pub(crate) fn relinearise(
    filter: &Filter,
    noise: &NoiseVariances,
    measure: impl Fn(&Unknowns) -> Measurement,
) -> Measurement {
    let mut m = measure(&filter.unknowns());
    let mut innovation_deg = filter.innovation_deg(&m);
    for _ in 0..LINEARISATION_ROUNDS {
        if innovation_deg < RELINEARISE_BEYOND_DEG || filter.z_squared(&m) > OUTLIER_Z_SQUARED {
            break;
        }
        let mut after = filter.clone();
        after.observe(&m, noise, None);
        m = measure(&after.unknowns());
        innovation_deg = after.innovation_deg(&m);
    }
    m
}

impl HypothesisBank {
    /// Takes row `at` in, which the other copies have taken in before, where a large step
    /// is supposed; `measure` is of any row at any ship.
    pub(crate) fn observe_large_steps(
        &mut self,
        at: usize,
        noise: &NoiseVariances,
        measure: impl Fn(usize, &Unknowns) -> Measurement,
    ) {
        if !self.other_kinds_run() {
            return;
        }
        for fork in &mut self.forks {
            let rows = if fork.hypothesis(HypothesisKind::LargeStep).is_some() {
                at..at + 1
            } else if begins_large_step(fork, at) {
                fork.set_hypothesis(
                    HypothesisKind::LargeStep,
                    apply_jump(fork.origin(), HypothesisKind::LargeStep),
                );
                fork.at..at + 1
            } else {
                continue;
            };
            let Some(hypothesis) = fork.hypothesis_mut(HypothesisKind::LargeStep) else {
                continue;
            };
            for row in rows {
                let m = relinearise(hypothesis, noise, |ship| measure(row, ship));
                hypothesis.observe(&m, noise, None);
            }
        }
    }
}

/// Whether a large step is to be supposed of that time from now on.
fn begins_large_step(fork: &Fork, at: usize) -> bool {
    fork.disturbance_deg() > LARGE_STEP_DEG && at <= fork.at + LARGE_STEP_MAX_ROWS
}
