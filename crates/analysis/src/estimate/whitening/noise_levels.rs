//! Noise levels from the data: restricted maximum likelihood with a prior on every level.
//!
//! It is restricted, because the unknowns are fitted to the same residuals. It has a prior,
//! because a few days cannot show what wanders over weeks.

use super::filter::{Pass, whiten};
use super::likelihood_slopes::{Slopes, slopes};
use crate::estimate::noise_process::LEVELS;
use crate::estimate::rows::{Row, RowFrame, UNKNOWNS};
use binnacle_compass::result::NoiseLevels;
use nalgebra::{SMatrix, SVector};

/// Standard deviations of the levels' logarithms over ships and instruments, in the order
/// of [`NoiseLevels`].
const LOG_SD: [f64; LEVELS] = [0.7, 0.6, 0.6, 0.5, 0.7, 0.5, 0.5, 0.6, 0.7];
/// Greatest number of steps, and greatest move of a level's logarithm.
const STEPS: u32 = 20;
const LARGEST_MOVE: f64 = 0.9;
/// Gain in −2 log likelihood below which a step is the last: while the parameters are
/// rough, and in the end.
const LITTLE_TO_GAIN: f64 = 1.0;
const NOTHING_TO_GAIN: f64 = 0.2;
/// Information on a level's logarithm (twice Fisher's) from which it is well known: the
/// unknowns' fit to the same residuals does not matter to it.
const WELL_KNOWN: f64 = 300.0;
/// Smallest part to which a bad step is halved.
const SMALLEST_STEP_SHARE: f64 = 0.05;
/// Nudge of a level's logarithm for the slope of the unknowns' part in the likelihood.
const NUDGE: f64 = 0.05;
/// Rows of one stretch where not all rows are used.
const STRETCH_ROWS: usize = 1000;
/// Number of stretches then.
const STRETCH_COUNT: usize = 4;

/// Prior information on the unknowns, and its score at the point of linearisation.
pub(crate) struct PriorTerms {
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    pub(crate) score: SVector<f64, UNKNOWNS>,
}

/// Fitted levels, with their slopes.
pub(crate) struct NoiseEstimate {
    pub(crate) levels: NoiseLevels,
    /// Slopes of the sum of log variance by the levels' logarithms.
    log_variance: [f64; LEVELS],
}

type Logs = SVector<f64, LEVELS>;

/// Effort of the search for levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SearchEffort {
    /// For unknowns known at their likeliest values.
    Rough,
    /// With the unknowns' fit to the same residuals, until nothing more is gained.
    Converged,
}

/// Returns the likeliest levels, searched from `levels` by Fisher's scoring.
pub(crate) fn fit_levels(
    frames: &[RowFrame],
    rows: &[Row],
    prior_terms: &PriorTerms,
    typical: &NoiseLevels,
    levels: &NoiseLevels,
    effort: SearchEffort,
) -> NoiseEstimate {
    let search = Search {
        effort,
        frames,
        rows,
        prior_terms,
        typical: logs_of(typical),
        moved: moved(frames, levels),
    };
    search.run(logs_of(levels))
}

struct Search<'a> {
    frames: &'a [RowFrame],
    rows: &'a [Row],
    prior_terms: &'a PriorTerms,
    typical: Logs,
    /// Indices of the levels that are fitted.
    moved: Vec<usize>,
    effort: SearchEffort,
}

/// Likelihood at some levels.
struct Trial {
    logs: Logs,
    objective: f64,
    /// Difference of the likeliest unknowns from the point of linearisation.
    known: [f64; UNKNOWNS],
    log_determinant: f64,
}

impl Search<'_> {
    fn run(&self, logs: Logs) -> NoiseEstimate {
        let mut found = NoiseEstimate {
            levels: levels_of(&logs),
            log_variance: [0.0; LEVELS],
        };
        let Some(mut here) = self.at(logs) else {
            return found;
        };
        let mut unknowns_part = None;
        for _ in 0..STEPS {
            let slopes = self.slopes(&here);
            found.log_variance = slopes.log_variance;
            // It hardly changes on the way.
            let part = unknowns_part.get_or_insert_with(|| self.unknowns_part(&here, &slopes));
            let Some((step, gain)) = self.step(&here, &slopes, part) else {
                break;
            };
            if gain < self.enough() {
                found.levels = levels_of(&(here.logs + step));
                break;
            }
            let Some(next) = self.descend(&here, &step) else {
                break;
            };
            here = next;
            found.levels = levels_of(&here.logs);
        }
        found
    }

    fn enough(&self) -> f64 {
        match self.effort {
            SearchEffort::Rough => LITTLE_TO_GAIN,
            SearchEffort::Converged => NOTHING_TO_GAIN,
        }
    }

    /// Evaluates the likelihood; none where the information is not positive definite.
    fn at(&self, logs: Logs) -> Option<Trial> {
        let pass = self.whiten(&logs);
        let factor = (self.prior_terms.information + pass.information).cholesky()?;
        let score = self.prior_terms.score + pass.score;
        let known = factor.solve(&score);
        let log_determinant = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let distance_from_typical = self
            .moved
            .iter()
            .map(|&k| self.distance_from_typical(&logs, k).powi(2));
        Some(Trial {
            logs,
            objective: pass.loss - score.dot(&known)
                + log_determinant
                + distance_from_typical.sum::<f64>(),
            known: known.into(),
            log_determinant,
        })
    }

    /// Returns the distance of a level from its typical value, in standard deviations.
    fn distance_from_typical(&self, logs: &Logs, k: usize) -> f64 {
        (logs[k] - self.typical[k]) / LOG_SD[k]
    }

    fn whiten(&self, logs: &Logs) -> Pass {
        whiten(self.frames, self.rows, &levels_of(logs))
    }

    /// Returns the slopes at the likeliest unknowns, whose own moves add nothing to them.
    fn slopes(&self, here: &Trial) -> Slopes {
        let levels = levels_of(&here.logs);
        slopes(self.frames, self.rows, &levels, &self.moved, &here.known)
    }

    /// Returns the slopes of the log determinant of the unknowns' information, where they
    /// matter.
    fn unknowns_part(&self, here: &Trial, slopes: &Slopes) -> Logs {
        let mut part = Logs::zeros();
        if self.effort == SearchEffort::Rough {
            return part;
        }
        let matters = |k: &&usize| slopes.information[**k][**k] < WELL_KNOWN;
        for &k in self.moved.iter().filter(matters) {
            let mut logs = here.logs;
            logs[k] += NUDGE;
            let information = self.prior_terms.information + self.whiten(&logs).information;
            if let Some(factor) = information.cholesky() {
                let nudged = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
                part[k] = (nudged - here.log_determinant) / NUDGE;
            }
        }
        part
    }

    /// Returns a step and its expected gain.
    fn step(&self, here: &Trial, slopes: &Slopes, unknowns_part: &Logs) -> Option<(Logs, f64)> {
        let mut slope = Logs::from(slopes.loss) + unknowns_part;
        let mut curvature = SMatrix::from(slopes.information);
        for k in 0..LEVELS {
            if self.moved.contains(&k) {
                slope[k] += 2.0 * self.distance_from_typical(&here.logs, k) / LOG_SD[k];
                curvature[(k, k)] += 2.0 / LOG_SD[k].powi(2);
            } else {
                slope[k] = 0.0;
                curvature[(k, k)] = 1.0;
            }
        }
        let step = -curvature.cholesky()?.solve(&slope);
        let gain = -0.5 * step.dot(&slope);
        let largest = step.amax().max(LARGEST_MOVE);
        Some((step * (LARGEST_MOVE / largest), gain))
    }

    /// Returns the largest part of a step that is an improvement.
    fn descend(&self, here: &Trial, step: &Logs) -> Option<Trial> {
        let mut part = 1.0;
        while part > SMALLEST_STEP_SHARE {
            let next = self.at(here.logs + step * part);
            if let Some(next) = next.filter(|next| next.objective < here.objective) {
                return Some(next);
            }
            part /= 2.0;
        }
        None
    }
}

/// Returns the fitted levels: a level of zero (its logarithm is not finite) stays zero, and
/// one that no row shows stays typical.
fn moved(frames: &[RowFrame], levels: &NoiseLevels) -> Vec<usize> {
    let gyro = frames.iter().any(RowFrame::reads_gyro);
    let satellite = frames.iter().any(RowFrame::reads_satellite);
    let both = frames.iter().any(RowFrame::reads_both);
    let shown = [true, gyro, gyro, gyro, true, true, true, satellite, both];
    let levels = levels.to_array();
    (0..LEVELS)
        .filter(|&k| shown[k] && levels[k] > 0.0)
        .collect()
}

fn logs_of(levels: &NoiseLevels) -> Logs {
    Logs::from(levels.to_array().map(f64::ln))
}

fn levels_of(logs: &Logs) -> NoiseLevels {
    NoiseLevels::from_array(std::array::from_fn(|k| logs[k].exp()))
}

impl NoiseEstimate {
    /// Returns the compass's share of the noise that separates rows: the trace of V⁻¹
    /// V_compass over that of V⁻¹ V, where V is the noise's covariance.
    ///
    /// With this share of the reference in a row's heading, the residual is uncorrelated
    /// with its slopes; with any other, errors in the heading would bias the fit.
    pub(crate) fn compass_share(&self, frames: &[RowFrame], white_share: f64) -> f64 {
        let [white, _, _, _, swing, ..] = self.log_variance;
        let sum = |of: fn(&RowFrame) -> f64| frames.iter().map(of).sum::<f64>();
        let by_level = self.levels.white_deg.powi(2) * sum(|s| s.white.factor);
        // The scatter is white, too, and the card's.
        let scatter = white * sum(|s| s.white.scatter) / by_level.max(f64::MIN_POSITIVE);
        // By the logarithm of the variance, which is twice the level's.
        let twice = white_share * white + scatter + swing;
        (twice / (2.0 * frames.len() as f64)).clamp(0.0, 1.0)
    }
}

/// Returns the places of the rows that are used, in evenly spaced stretches; none where all
/// are.
pub(crate) fn sampled_rows(rows: usize) -> Option<impl Iterator<Item = usize>> {
    if rows <= STRETCH_ROWS * STRETCH_COUNT {
        return None;
    }
    let spacing = (rows - STRETCH_ROWS) / (STRETCH_COUNT - 1);
    Some((0..STRETCH_COUNT).flat_map(move |i| i * spacing..i * spacing + STRETCH_ROWS))
}
