//! How large each kind of noise is, from the data: restricted maximum
//! likelihood with a prior on every level.
//!
//! Restricted, because the unknowns are fitted to the same residuals; with a
//! prior, because a few days cannot show what wanders over weeks.

use super::noise::{LEVELS, NoiseLevels};
use super::row::{Row, Station, UNKNOWNS};
use super::whiten::whiten;
use nalgebra::{SMatrix, SVector};

/// Standard deviations of the levels' logarithms over ships and instruments, in
/// the order of [`NoiseLevels`].
const LOG_SD: [f64; LEVELS] = [0.7, 0.6, 0.6, 0.5, 0.7, 0.5, 0.5, 0.6, 0.7];
/// A level is tried this far (in its logarithm) to either side.
const TRIAL: f64 = 0.3;
/// And moved at most so far in a sweep.
const LARGEST_MOVE: f64 = 0.9;
/// For the slope of the likelihood by a level.
const NUDGE: f64 = 0.05;
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
    let typical = typical.to_array().map(f64::ln);
    let objective = |logs: &[f64; LEVELS]| {
        let tried = NoiseLevels::from_array(logs.map(f64::exp));
        let pass = whiten(stations, rows, &tried, |_, _, _| ());
        let information = pull.information + pass.information;
        let score = pull.score + pass.score;
        let Some(factor) = information.cholesky() else {
            return f64::INFINITY;
        };
        let log_determinant = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let off = (0..LEVELS).filter(|&k| typical[k].is_finite());
        let prior: f64 = off
            .map(|k| ((logs[k] - typical[k]) / LOG_SD[k]).powi(2))
            .sum();
        pass.loss - score.dot(&factor.solve(&score)) + log_determinant + prior
    };
    let mut logs = levels.to_array().map(f64::ln);
    let shown = shown(stations);
    let mut best = objective(&logs);
    for _ in 0..sweeps {
        for k in 0..LEVELS {
            // A level of zero (its logarithm is not finite) stays zero, and one
            // that no row shows stays what it usually is.
            if logs[k].is_finite() && shown[k] {
                best = improve(&objective, &mut logs, k, best);
            }
        }
    }
    NoiseLevels::from_array(logs.map(f64::exp))
}

/// Which levels have a part in the rows at all, in the order of [`NoiseLevels`].
fn shown(stations: &[Station]) -> [bool; LEVELS] {
    let gyro = stations.iter().any(Station::reads_gyro);
    let satellite = stations.iter().any(Station::reads_satellite);
    let both = stations.iter().any(Station::reads_both);
    [true, gyro, gyro, gyro, true, true, true, satellite, both]
}

/// What part of the rows' noise is the compass's, of what tells rows apart: the
/// trace of V⁻¹ V_compass over that of V⁻¹ V, where V is the noise's covariance.
///
/// A row taken at a heading with so much of the reference in it has a residual
/// that its slopes know nothing of; with any other, errors in the heading would
/// lean on the fit.
pub(crate) fn compass_share(
    stations: &[Station],
    rows: &[Row],
    levels: &NoiseLevels,
    of_white: f64,
) -> f64 {
    let log_variance = |white: f64, swing: f64| {
        let tried = NoiseLevels {
            white_deg: levels.white_deg * white.exp(),
            compass_swing_deg: levels.compass_swing_deg * swing.exp(),
            ..*levels
        };
        whiten(stations, rows, &tried, |_, _, _| ()).log_variance
    };
    // By the logarithm of the variance, which is twice the level's.
    let (white, swing) = (of_white * NUDGE, NUDGE);
    let slope = (log_variance(white, swing) - log_variance(-white, -swing)) / (4.0 * NUDGE);
    (slope / rows.len() as f64).clamp(0.0, 1.0)
}

/// Moves one level to the lowest point of the parabola through three tries, or
/// to the best of the tries.
fn improve(
    objective: &impl Fn(&[f64; LEVELS]) -> f64,
    logs: &mut [f64; LEVELS],
    k: usize,
    here: f64,
) -> f64 {
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

/// Which of `rows` rows are looked at: all, or evenly spread stretches.
pub(crate) fn looked_at(rows: usize) -> Vec<usize> {
    if rows <= STRETCH * STRETCHES {
        return (0..rows).collect();
    }
    let spacing = (rows - STRETCH) / (STRETCHES - 1);
    (0..STRETCHES)
        .flat_map(|i| i * spacing..i * spacing + STRETCH)
        .collect()
}
