//! The estimate itself: a robust start, noise levels from the data, and
//! Gauss–Newton on whitened rows.

use super::levels::{Sought, looked_at};
use super::prior::{Prior, scales};
use super::problem::{Matrix, Problem, Solution};
use super::quality::{Evidence, quality};
use super::row::{CONSTANT, USUAL_FUSION, in_own_units, plain_residual};
use super::start::start;
use super::untimed::{all_timed, are_times_believed, cell_of};
use crate::fit::Observation;
use binnacle_compass::model::{Caution, Covariance, Identifiable, Parameters, Quality};
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::EarthField;
use std::borrow::Cow;

/// The step, in population standard deviations, below which the parameters have
/// settled: while levels are sought, and in the end.
const ROUGHLY_SETTLED: f64 = 0.01;
const SETTLED: f64 = 1e-3;
/// Most of what is left after a fit is slow; about this part of it, in standard
/// deviation, is new in every row.
const NEW: f64 = 0.2;

/// What an estimate starts from beside the observations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Options<'a> {
    /// What was known before.
    pub(crate) prior: &'a Prior,
    /// Standard deviation of the reference's constant error, degrees.
    pub(crate) reference_constant_sd_deg: f64,
}

/// A fitted ship.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    pub(crate) parameters: Parameters,
    pub(crate) constant_deg: f64,
    pub(crate) covariance: Covariance,
    pub(crate) identifiable: Identifiable,
    pub(crate) quality: Quality,
    pub(crate) levels: NoiseLevels,
    /// For each observation, in the order given.
    pub(crate) rows: Vec<FittedRow>,
}

/// What became of one observation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedRow {
    /// Measured less predicted, degrees, the reference's wander still in it.
    pub(crate) residual_deg: f64,
    /// Huber's weight, 0 to 1.
    pub(crate) weight: f64,
}

/// What a rough estimate tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rough {
    pub(crate) parameters: Parameters,
    pub(crate) constant_deg: f64,
    pub(crate) levels: NoiseLevels,
}

/// Fits the ship to observations in any order; none when the iteration does not
/// settle. The result depends on the order only where times are equal.
pub(crate) fn estimate(observations: &[Observation], options: &Options<'_>) -> Option<Estimate> {
    let Sorted {
        observations: sorted,
        order,
    } = Sorted::new(observations);
    let problem = Problem::new(&sorted, options.prior)?;
    let few = few(&sorted);
    let (solution, levels) = match &few {
        Some(few) => seek(&problem.by(few), begin(&problem, None), Sought::Well)?,
        None => seek(&problem, begin(&problem, None), Sought::Well)?,
    };
    let (solution, judged) = problem.settle(solution, &levels, SETTLED)?;

    let (parameters, constant_deg) = in_own_units(&judged.at_last);
    let mut covariance = in_own_units_squared(&judged.covariance);
    covariance[CONSTANT][CONSTANT] += options.reference_constant_sd_deg.powi(2);
    let timed = all_timed(&sorted);
    if !timed {
        // Over which days a gyro's wander has averaged nobody knows.
        covariance[CONSTANT][CONSTANT] += NoiseLevels::TYPICAL.slow_gyro_deg.powi(2);
    }
    let mut rows = vec![
        FittedRow {
            residual_deg: 0.0,
            weight: 0.0
        };
        order.len()
    ];
    for ((&index, observation), &weight) in order.iter().zip(sorted.iter()).zip(&judged.weights) {
        rows[index] = FittedRow {
            residual_deg: plain_residual(observation, &judged.at_last),
            weight,
        };
    }
    let parameters = Parameters::from_array(parameters);
    let last = sorted.last()?;
    let weighed: f64 = judged.weights.iter().sum();
    let squares: f64 = rows
        .iter()
        .map(|row| row.weight * row.residual_deg.powi(2))
        .sum();
    let (mut quality, identifiable) = quality(&Evidence {
        information: &judged.information,
        by_data: judged.by_data,
        independent: &judged.independent,
        weighed,
        row_variance: (squares / weighed).max(levels.row_variance()),
        after: &judged.covariance,
        before: &solution.prior_covariance()?,
        parameters: &parameters,
        earth: EarthField {
            h_nt: last.h_nt,
            z_nt: last.z_nt,
        },
        weakest_h_nt: sorted.iter().map(|o| o.h_nt).fold(f64::INFINITY, f64::min),
    });
    if !timed {
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

/// The levels of noise, and about what the parameters are at the last observation;
/// `before` are levels from which there is not far to go.
pub(crate) fn rough(
    observations: &[Observation],
    prior: &Prior,
    before: Option<&NoiseLevels>,
) -> Option<Rough> {
    let sorted = Sorted::new(observations).observations;
    let few = few(&sorted);
    let problem = Problem::new(few.as_deref().unwrap_or(&sorted), prior)?;
    let (solution, levels) = seek(&problem, begin(&problem, before), Sought::Fairly)?;
    let (solution, drift) = problem.descend(solution, &levels, ROUGHLY_SETTLED)?;
    let (parameters, constant_deg) = in_own_units(&solution.at_last(&drift));
    Some(Rough {
        parameters: Parameters::from_array(parameters),
        constant_deg,
        levels,
    })
}

/// Observations from the earliest to the latest; where times are not to be believed
/// without them, from cell to cell.
struct Sorted<'a> {
    observations: Cow<'a, [Observation]>,
    /// The place that each had.
    order: Vec<usize>,
}

impl<'a> Sorted<'a> {
    fn new(observations: &'a [Observation]) -> Sorted<'a> {
        let mut order: Vec<usize> = (0..observations.len()).collect();
        if !are_times_believed(observations) {
            order.sort_by_key(|&i| cell_of(&observations[i]));
            let untimed = |&i: &usize| Observation {
                time: None,
                ..observations[i]
            };
            return Sorted {
                observations: order.iter().map(untimed).collect(),
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

/// Those by which levels are sought, where it need not be all.
fn few(observations: &[Observation]) -> Option<Vec<Observation>> {
    let chosen = looked_at(observations.len())?;
    Some(chosen.map(|i| observations[i]).collect())
}

/// Where the search begins.
struct Begun {
    solution: Solution,
    typical: NoiseLevels,
    levels: NoiseLevels,
    /// How well levels are sought before the last time.
    first: Option<Sought>,
}

fn begin(problem: &Problem<'_>, before: Option<&NoiseLevels>) -> Begun {
    let (unknowns, sd) = start(
        problem.observations,
        &problem.stations,
        &problem.prior_mean.into(),
        &problem.prior_information,
    );
    let typical = if all_timed(problem.observations) {
        NoiseLevels::TYPICAL
    } else {
        NoiseLevels::MEMORYLESS
    };
    let by_start = NoiseLevels {
        white_deg: (NEW * sd).clamp(0.02, 10.0),
        ..typical
    };
    Begun {
        solution: Solution {
            unknowns,
            fusion: USUAL_FUSION,
            prior_information: problem.prior_information,
        },
        typical,
        levels: before.copied().unwrap_or(by_start),
        first: before.is_none().then_some(Sought::Roughly),
    }
}

/// Levels, in the end as well as `last` says, and parameters in turn; the parameters
/// by the last levels are the caller's to find.
fn seek(problem: &Problem<'_>, begun: Begun, last: Sought) -> Option<(Solution, NoiseLevels)> {
    let Begun {
        mut solution,
        typical,
        mut levels,
        first,
    } = begun;
    if let Some(sought) = first {
        (levels, solution.fusion) = problem.levels_at(&solution, &typical, &levels, sought);
        (solution, _) = problem.descend(solution, &levels, ROUGHLY_SETTLED)?;
    }
    (levels, solution.fusion) = problem.levels_at(&solution, &typical, &levels, last);
    Some((solution, levels))
}

fn in_own_units_squared(covariance: &Matrix) -> Covariance {
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
