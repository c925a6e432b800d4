//! Estimator: a robust start, noise levels from the data, and Gauss–Newton on whitened
//! rows.

use super::alignment::Turn;
use super::least_squares::{Matrix, Problem, Solution};
use super::quality::{Evidence, quality};
use super::start::start;
use crate::estimate::prior::{Prior, scales};
use crate::estimate::rows::{CONSTANT, USUAL_REFERENCE_SHARE, plain_residual, to_physical_units};
use crate::estimate::undated_rows::{all_dated, are_times_plausible, heading_cell};
use crate::estimate::whitening::{SearchEffort, sampled_rows};
use crate::observation::Observation;
use binnacle_compass::model::{Caution, Covariance, Identifiable, Parameters, Quality};
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::EarthField;
use std::borrow::Cow;

/// Step, in population standard deviations, below which the parameters have settled: while
/// levels are searched, and in the end.
const ROUGHLY_SETTLED: f64 = 0.01;
const SETTLED: f64 = 1e-3;
/// Share of the residual's standard deviation that is new in every row: most of it is slow.
const NEW_SHARE: f64 = 0.2;

/// Options of an estimate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Options<'a> {
    /// Prior knowledge of the vessel.
    pub(crate) prior: &'a Prior,
    /// Standard deviation of the reference's constant error, degrees.
    pub(crate) reference_constant_sd_deg: f64,
    /// Rotation of the compass against the prior; none where it is mounted straight.
    pub(crate) turn: Option<Turn>,
}

/// Estimate of a vessel's magnetism.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    pub(crate) parameters: Parameters,
    pub(crate) constant_deg: f64,
    pub(crate) covariance: Covariance,
    pub(crate) identifiable: Identifiable,
    pub(crate) quality: Quality,
    pub(crate) levels: NoiseLevels,
    /// Outcome of each observation, in the order given.
    pub(crate) rows: Vec<FittedRow>,
}

/// Outcome of one observation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedRow {
    /// Measured less predicted, degrees, with the reference's wander still in it.
    pub(crate) residual_deg: f64,
    /// Huber's weight, 0 to 1.
    pub(crate) weight: f64,
}

/// Fits observations in any order; none when the iteration does not settle. The result
/// depends on the order only where times are equal.
pub(crate) fn estimate(observations: &[Observation], options: &Options<'_>) -> Option<Estimate> {
    let Sorted {
        observations: sorted,
        order,
    } = Sorted::new(observations);
    let straight: Cow<'_, [Observation]> = match options.turn {
        Some(turn) => Cow::Owned(turn.straighten(&sorted)),
        None => Cow::Borrowed(&*sorted),
    };
    let prior = match options.turn {
        Some(_) => Cow::Owned(Turn::prior(options.prior)),
        None => Cow::Borrowed(options.prior),
    };
    let problem = Problem::new(&straight, &prior)?;
    let level_sample = level_sample(&straight);
    let (solution, levels) = match &level_sample {
        Some(level_sample) => seek(&problem.by(level_sample), search_start(&problem))?,
        None => seek(&problem, search_start(&problem))?,
    };
    let (solution, mut evaluated) = problem.settle(solution, &levels, SETTLED)?;
    let mut before = solution.prior_covariance()?;
    if let Some(turn) = options.turn {
        evaluated.turn(turn)?;
        let matrix = turn.matrix(&scales());
        before = matrix * before * matrix.transpose();
    }

    let (parameters, constant_deg) = to_physical_units(&evaluated.at_last_row);
    let mut covariance = covariance_in_physical_units(&evaluated.covariance);
    covariance[CONSTANT][CONSTANT] += options.reference_constant_sd_deg.powi(2);
    let dated = all_dated(&sorted);
    if !dated {
        // The time over which a gyro's wander has averaged is unknown.
        covariance[CONSTANT][CONSTANT] += NoiseLevels::TYPICAL.slow_gyro_deg.powi(2);
    }
    let mut rows = vec![
        FittedRow {
            residual_deg: 0.0,
            weight: 0.0
        };
        order.len()
    ];
    for ((&index, observation), &weight) in order.iter().zip(sorted.iter()).zip(&evaluated.weights)
    {
        rows[index] = FittedRow {
            residual_deg: plain_residual(observation, &evaluated.at_last_row),
            weight,
        };
    }
    let parameters = Parameters::from_array(parameters);
    let last = sorted.last()?;
    let weighed: f64 = evaluated.weights.iter().sum();
    let squares: f64 = rows
        .iter()
        .map(|row| row.weight * row.residual_deg.powi(2))
        .sum();
    let (mut quality, identifiable) = quality(&Evidence {
        information: &evaluated.information,
        by_data: evaluated.by_data,
        independent: &evaluated.independent,
        weighed,
        row_variance: (squares / weighed).max(levels.row_variance()),
        after: &evaluated.covariance,
        before: &before,
        parameters: &parameters,
        earth: EarthField {
            h_nt: last.h_nt,
            z_nt: last.z_nt,
        },
        weakest_h_nt: sorted.iter().map(|o| o.h_nt).fold(f64::INFINITY, f64::min),
    });
    if !dated {
        quality.cautions.push(Caution::NoTimes);
    }
    Some(Estimate {
        parameters,
        constant_deg,
        covariance,
        identifiable,
        quality,
        levels,
        rows,
    })
}

/// Observations in order of time; where times are implausible, without times and ordered by
/// cell.
struct Sorted<'a> {
    observations: Cow<'a, [Observation]>,
    /// Original place of each observation.
    order: Vec<usize>,
}

impl<'a> Sorted<'a> {
    fn new(observations: &'a [Observation]) -> Sorted<'a> {
        let mut order: Vec<usize> = (0..observations.len()).collect();
        if !are_times_plausible(observations) {
            order.sort_by_key(|&i| heading_cell(&observations[i]));
            let undated = |&i: &usize| Observation {
                time: None,
                ..observations[i]
            };
            return Sorted {
                observations: order.iter().map(undated).collect(),
                order,
            };
        }
        order.sort_by_key(|&i| observations[i].time);
        let observations = if order.is_sorted() {
            Cow::Borrowed(observations)
        } else {
            order.iter().map(|&i| observations[i]).collect()
        };
        Sorted {
            observations,
            order,
        }
    }
}

/// Returns a sample of the observations for the levels, where not all are needed.
fn level_sample(observations: &[Observation]) -> Option<Vec<Observation>> {
    let chosen = sampled_rows(observations.len())?;
    Some(chosen.map(|i| observations[i]).collect())
}

/// Start of the search.
struct SearchStart {
    solution: Solution,
    typical: NoiseLevels,
    levels: NoiseLevels,
}

fn search_start(problem: &Problem<'_>) -> SearchStart {
    let begun = start(
        problem.observations,
        &problem.frames,
        &problem.prior_mean.into(),
        &problem.prior_information,
    );
    let typical = if all_dated(problem.observations) {
        NoiseLevels::TYPICAL
    } else {
        NoiseLevels::MEMORYLESS
    };
    SearchStart {
        solution: Solution {
            unknowns: begun.unknowns,
            reference_share: USUAL_REFERENCE_SHARE,
            prior_information: problem.prior_information,
        },
        typical,
        levels: NoiseLevels {
            white_deg: (NEW_SHARE * begun.sd_deg).clamp(0.02, 10.0),
            ..typical
        },
    }
}

/// Returns levels, searched roughly and then until nothing more is gained, and the parameters
/// between.
fn seek(problem: &Problem<'_>, begun: SearchStart) -> Option<(Solution, NoiseLevels)> {
    let SearchStart {
        mut solution,
        typical,
        mut levels,
    } = begun;
    (levels, solution.reference_share) =
        problem.levels_at(&solution, &typical, &levels, SearchEffort::Rough);
    (solution, _) = problem.descend(solution, &levels, ROUGHLY_SETTLED)?;
    (levels, solution.reference_share) =
        problem.levels_at(&solution, &typical, &levels, SearchEffort::Converged);
    Some((solution, levels))
}

fn covariance_in_physical_units(covariance: &Matrix) -> Covariance {
    let scale = scales();
    let mut out = [[0.0; 8]; 8];
    for i in 0..8 {
        for j in 0..8 {
            let mean = f64::midpoint(covariance[(i, j)], covariance[(j, i)]);
            out[i][j] = mean * (scale[i] * scale[j]);
        }
    }
    out
}
