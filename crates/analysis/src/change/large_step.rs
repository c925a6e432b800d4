//! Large steps: lightning can change a vessel's magnetism many times more than cargo does.
//!
//! A vessel without a large disturbance has none of these hypotheses, so that small changes
//! are judged without them. Each reads every row linearised at its own state, because
//! deviation is not linear in a large step.

use super::filter::{Filter, Measurement, NoiseVariances};
use super::hypotheses::{Fork, HypothesisBank};
use super::hypothesis_kind::HypothesisKind;
use super::jump_models::apply_jump;
use crate::change::thresholds::{LARGE_STEP_DEG, LARGE_STEP_MAX_ROWS};
use crate::estimate::{USUAL_REFERENCE_SHARE, Unknowns};

/// Change of the expected deviation from which a row is linearised again, degrees, and the
/// greatest number of rounds.
const RELINEARISE_BEYOND_DEG: f64 = 2.0;
const LINEARISATION_ROUNDS: usize = 6;
/// Size of bx and by from which a vessel is a strong magnet, population units (1500 nT).
const STRONG_MAGNET: f64 = 4.0;
/// Innovation from which a reading is an outlier, squared standard deviations.
const OUTLIER_Z_SQUARED: f64 = 9.0;

/// Returns the reference's share in the heading at which rows are linearised. On a strong
/// magnet the compass may turn several times as fast as the vessel, so that its own reading
/// would explain whatever it shows: the share is 1.
pub(crate) fn reference_share(vessel: &Unknowns) -> f64 {
    if vessel[0].hypot(vessel[2]) > STRONG_MAGNET {
        1.0
    } else {
        USUAL_REFERENCE_SHARE
    }
}

/// Returns the row linearised at the state of `filter` after reading it, where that is far
/// from the state before.
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
    /// Reads row `at` with the hypotheses of large steps, after all others have read it;
    /// `measure` gives any row at any state.
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
                let m = relinearise(hypothesis, noise, |vessel| measure(row, vessel));
                hypothesis.observe(&m, noise, None);
            }
        }
    }
}

/// Returns true if a hypothesis of a large step begins at this fork now.
fn begins_large_step(fork: &Fork, at: usize) -> bool {
    fork.disturbance_deg() > LARGE_STEP_DEG && at <= fork.at + LARGE_STEP_MAX_ROWS
}
