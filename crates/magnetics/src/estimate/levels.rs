//! How large each kind of noise is, from the data: restricted maximum
//! likelihood with a prior on every level.
//!
//! Restricted, because the unknowns are fitted to the same residuals; with a
//! prior, because a few days cannot show what wanders over weeks.

use super::noise::NoiseLevels;
use super::row::{Row, Station, UNKNOWNS};
use super::whiten::whiten;
use nalgebra::{SMatrix, SVector};

/// Standard deviations of the levels' logarithms over ships and instruments, in
/// the order of [`NoiseLevels`].
const LOG_SD: [f64; 6] = [0.7, 0.6, 0.5, 0.7, 0.5, 0.5];
/// A level is tried this far (in its logarithm) to either side.
const TRIAL: f64 = 0.3;
/// And moved at most so far in a sweep.
const LARGEST_MOVE: f64 = 0.9;
/// Rows of one stretch when there are too many for all to be looked at.
const STRETCH: usize = 1000;
/// Stretches that are looked at then.
const STRETCHES: usize = 4;

/// What is known of the unknowns beside the rows: information, and its pull at
/// where the rows were taken.
pub(crate) struct Pull {
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    pub(crate) score: SVector<f64, UNKNOWNS>,
}

/// The levels that make the rows likeliest, sought from `levels` by moving each
/// in turn, `sweeps` times.
pub(crate) fn fit_levels(
    stations: &[Station],
    rows: &[Row],
    pull: &Pull,
    typical: &NoiseLevels,
    levels: &NoiseLevels,
    sweeps: u32,
) -> NoiseLevels {
    let stretches = stretches(rows.len());
    let typical = typical.to_array().map(f64::ln);
    let objective = |logs: &[f64; 6]| {
        let tried = NoiseLevels::from_array(logs.map(f64::exp));
        let mut loss = 0.0;
        let mut information = pull.information;
        let mut score = pull.score;
        for range in &stretches {
            let pass = whiten(
                &stations[range.clone()],
                &rows[range.clone()],
                &tried,
                |_, _| (),
            );
            loss += pass.loss;
            information += pass.information;
            score += pass.score;
        }
        let Some(factor) = information.cholesky() else {
            return f64::INFINITY;
        };
        let log_determinant = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let off = (0..6).filter(|&k| typical[k].is_finite());
        let prior: f64 = off
            .map(|k| ((logs[k] - typical[k]) / LOG_SD[k]).powi(2))
            .sum();
        loss - score.dot(&factor.solve(&score)) + log_determinant + prior
    };
    let mut logs = levels.to_array().map(f64::ln);
    let mut best = objective(&logs);
    for _ in 0..sweeps {
        for k in 0..6 {
            // A level of zero (its logarithm is not finite) stays zero.
            if logs[k].is_finite() {
                best = improve(&objective, &mut logs, k, best);
            }
        }
    }
    NoiseLevels::from_array(logs.map(f64::exp))
}

/// Moves one level to the lowest point of the parabola through three tries, or
/// to the best of the tries.
fn improve(objective: &impl Fn(&[f64; 6]) -> f64, logs: &mut [f64; 6], k: usize, here: f64) -> f64 {
    let centre = logs[k];
    let mut at = |offset: f64| {
        logs[k] = centre + offset;
        objective(logs)
    };
    let (below, above) = (at(-TRIAL), at(TRIAL));
    let curvature = below + above - 2.0 * here;
    let slope = (above - below) / 2.0;
    let offset = if curvature > 0.0 {
        (-slope / curvature * TRIAL).clamp(-LARGEST_MOVE, LARGEST_MOVE)
    } else {
        LARGEST_MOVE.copysign(-slope)
    };
    let moved = at(offset);
    let tries = [
        (0.0, here),
        (-TRIAL, below),
        (TRIAL, above),
        (offset, moved),
    ];
    let (chosen, value) = tries
        .into_iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .expect("there are four tries");
    logs[k] = centre + chosen;
    value
}

/// All rows, or evenly spread stretches of them.
fn stretches(rows: usize) -> Vec<std::ops::Range<usize>> {
    if rows <= STRETCH * STRETCHES {
        return std::iter::once(0..rows).collect();
    }
    let spacing = (rows - STRETCH) / (STRETCHES - 1);
    (0..STRETCHES)
        .map(|i| i * spacing..i * spacing + STRETCH)
        .collect()
}
