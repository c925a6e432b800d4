//! The estimate itself: a robust start, noise levels from the data, and
//! Gauss–Newton on whitened rows.

use super::levels::{Pull, compass_share, fit_levels, looked_at};
use super::noise::NoiseLevels;
use super::prior::{Prior, scales, tail};
use super::products::Products;
use super::quality::{Evidence, quality, widely};
use super::row::{
    CONSTANT, Row, Station, UNKNOWNS, USUAL_FUSION, Unknowns, in_own_units, plain_residual, row,
    stations,
};
use super::start::start;
use super::whiten::{Measured, Pass, Whitened, whiten};
use crate::fit::Observation;
use crate::model::{Covariance, Identifiable, Parameters, Quality};
use crate::ship::EarthField;
use nalgebra::{SMatrix, SVector};

/// Gauss–Newton steps at most; three suffice near the solution, thirty where the
/// weights and the prior's tail move with it.
const ITERATIONS: u32 = 40;
/// Rounds of noise levels and parameters in turn: how often each level is moved,
/// and the step, in population standard deviations, below which the parameters
/// have settled.
const ROUNDS: [(u32, f64); 2] = [(3, 0.01), (1, 5e-4)];
/// The compass's part of the noise that is new in every row.
const OF_WHITE_BY_GYRO: f64 = 0.85;
const OF_WHITE_BY_SATELLITE: f64 = 0.5;
const OF_WHITE_UNTIMED: f64 = 0.6;
/// Where bx and by stand among the unknowns.
const DRIFTING: [usize; 2] = [0, 2];
/// Days whose scores are held against what the noise model says of them.
const BLOCK_S: f64 = 4.0 * 86_400.0;
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

/// Fits the ship to observations in any order; none when the iteration does not
/// settle. The result depends on the order only where times are equal.
pub(crate) fn estimate(observations: &[Observation], options: &Options<'_>) -> Option<Estimate> {
    let mut order: Vec<usize> = (0..observations.len()).collect();
    order.sort_by_key(|&i| observations[i].time);
    let sorted: Vec<Observation> = order.iter().map(|&i| observations[i]).collect();
    let problem = Problem::new(&sorted, options.prior)?;
    let timed = sorted.iter().all(|o| o.time.is_some());
    let typical = if timed {
        NoiseLevels::TYPICAL
    } else {
        NoiseLevels::MEMORYLESS
    };
    let (solution, levels) = problem.solve(&typical)?;
    let judged = problem.judge(&solution, &levels)?;

    let (parameters, constant_deg) = in_own_units(&judged.at_last);
    let mut covariance = in_own_units_squared(&judged.covariance);
    covariance[CONSTANT][CONSTANT] += options.reference_constant_sd_deg.powi(2);
    let mut rows = vec![
        FittedRow {
            residual_deg: 0.0,
            weight: 0.0
        };
        order.len()
    ];
    for ((&index, observation), &weight) in order.iter().zip(&sorted).zip(&judged.weights) {
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
    let (quality, identifiable) = quality(&Evidence {
        information: &judged.information,
        by_data: judged.by_data,
        rows: &judged.rows,
        weights: &judged.weights,
        row_variance: (squares / weighed).max(levels.of_a_row()),
        after: &judged.covariance,
        before: &Problem::prior_covariance(&solution)?,
        parameters: &parameters,
        earth: EarthField {
            h_nt: last.h_nt,
            z_nt: last.z_nt,
        },
        weakest_h_nt: sorted.iter().map(|o| o.h_nt).fold(f64::INFINITY, f64::min),
    });
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

type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Vector = SVector<f64, UNKNOWNS>;

/// Observations from the earliest to the latest, with what stays the same
/// through the iteration.
struct Problem<'a> {
    observations: &'a [Observation],
    stations: Vec<Station>,
    prior_mean: Vector,
    prior_information: Matrix,
}

/// Where the iteration is.
struct Solution {
    unknowns: Unknowns,
    /// The reference's share in the heading at which rows are taken.
    fusion: f64,
    /// The prior's information there.
    prior_information: Matrix,
}

/// What the final pass says of a solution.
struct Judged {
    /// Parameters as they were at the last observation, in population units.
    at_last: Unknowns,
    information: Matrix,
    covariance: Matrix,
    /// The same by the data alone.
    by_data: Option<Matrix>,
    rows: Vec<Row>,
    weights: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(observations: &'a [Observation], prior: &Prior) -> Option<Problem<'a>> {
        let (mean, information) = prior.in_population_units()?;
        let mut prior_mean = Vector::zeros();
        prior_mean.as_mut_slice()[..=CONSTANT].copy_from_slice(&mean);
        // What is neither parameter nor constant is in units of its own prior.
        let mut prior_information = Matrix::identity();
        prior_information
            .fixed_view_mut::<8, 8>(0, 0)
            .copy_from(&information);
        Some(Problem {
            observations,
            stations: stations(observations),
            prior_mean,
            prior_information,
        })
    }

    fn solve(&self, typical: &NoiseLevels) -> Option<(Solution, NoiseLevels)> {
        let (unknowns, sd) = start(
            self.observations,
            &self.stations,
            &self.prior_mean.into(),
            &self.prior_information,
        );
        let mut solution = Solution {
            unknowns,
            fusion: USUAL_FUSION,
            prior_information: self.prior_information,
        };
        // Most of what is left after a fit is slow; some half of it is new in
        // every row.
        let mut levels = *typical;
        levels.white_deg = (sd / 2.0).clamp(0.02, 10.0);
        let chosen: Vec<Observation> = looked_at(self.observations.len())
            .into_iter()
            .map(|i| self.observations[i])
            .collect();
        let chosen_stations = stations(&chosen);
        let of_white = compass_part_of_white(&chosen);
        for (sweeps, settled) in ROUNDS {
            let rows = rows(&chosen, &chosen_stations, &solution);
            let pull = self.pull(&solution);
            levels = fit_levels(&chosen_stations, &rows, &pull, typical, &levels, sweeps);
            solution.fusion = compass_share(&chosen_stations, &rows, &levels, of_white);
            solution = self.descend(solution, &levels, settled)?;
        }
        Some((solution, levels))
    }

    /// Gauss–Newton from a solution until it settles.
    fn descend(
        &self,
        mut solution: Solution,
        levels: &NoiseLevels,
        settled: f64,
    ) -> Option<Solution> {
        for _ in 0..ITERATIONS {
            let rows = rows(self.observations, &self.stations, &solution);
            let pass = whiten(&self.stations, &rows, levels, |_, _, _| ());
            let pull = self.pull(&solution);
            let covariance = (pass.information + pull.information).cholesky()?.inverse();
            let step = covariance * (pass.score + pull.score);
            for (u, d) in solution.unknowns.iter_mut().zip(step.iter()) {
                *u += d;
            }
            if !solution.unknowns.iter().all(|u| u.is_finite()) {
                return None;
            }
            solution.prior_information = self.prior_at(&solution.unknowns, &covariance);
            if step.amax() < settled {
                return Some(solution);
            }
        }
        None
    }

    fn judge(&self, solution: &Solution, levels: &NoiseLevels) -> Option<Judged> {
        let rows = rows(self.observations, &self.stations, solution);
        let mut weights = Vec::with_capacity(rows.len());
        let mut blocks = Blocks::new(self.observations);
        let pass: Pass = whiten(
            &self.stations,
            &rows,
            levels,
            |index, measured, whitened| {
                if measured == Measured::Deviation {
                    weights.push(whitened.weight);
                }
                blocks.add(index, whitened);
            },
        );
        let covariance = (pass.information + solution.prior_information)
            .cholesky()?
            .inverse();
        let covariance = covariance * blocks.inflation(&covariance);
        // From where the filter began to where the ship is now.
        let scale = scales();
        let mut at_last = solution.unknowns;
        let mut follows = Matrix::identity();
        let mut drifted = Matrix::zeros();
        for (a, i) in DRIFTING.into_iter().enumerate() {
            at_last[i] += pass.drift.nt[a] / scale[i];
            for (j, per_unknown) in pass.drift.per_unknown[a].iter().enumerate() {
                follows[(i, j)] -= per_unknown / scale[i];
            }
            for (b, j) in DRIFTING.into_iter().enumerate() {
                drifted[(i, j)] = pass.drift.covariance[a][b] / (scale[i] * scale[j]);
            }
        }
        let now = |then: Matrix| follows * then * follows.transpose() + drifted;
        Some(Judged {
            at_last,
            information: pass.information,
            covariance: now(covariance),
            by_data: widely(&pass.information)
                .cholesky()
                .map(|factor| now(factor.inverse())),
            rows,
            weights,
        })
    }

    fn pull(&self, solution: &Solution) -> Pull {
        let off = self.prior_mean - Vector::from(solution.unknowns);
        Pull {
            information: solution.prior_information,
            score: solution.prior_information * off,
        }
    }

    /// What was known of parameters and constant before the data.
    fn prior_covariance(solution: &Solution) -> Option<SMatrix<f64, 8, 8>> {
        let information = solution.prior_information.fixed_view::<8, 8>(0, 0);
        Some(information.into_owned().cholesky()?.inverse())
    }

    /// The prior's information, less where a solution lies out in its tail.
    fn prior_at(&self, unknowns: &Unknowns, covariance: &Matrix) -> Matrix {
        let off = Vector::from(*unknowns) - self.prior_mean;
        let factors = tail(
            &off.fixed_rows::<8>(0).into_owned(),
            &covariance.fixed_view::<8, 8>(0, 0).into_owned(),
            &self.prior_information.fixed_view::<8, 8>(0, 0).into_owned(),
        );
        let mut information = self.prior_information;
        for i in 0..8 {
            for j in 0..8 {
                information[(i, j)] /= factors[i] * factors[j];
            }
        }
        information
    }
}

fn rows(observations: &[Observation], stations: &[Station], solution: &Solution) -> Vec<Row> {
    observations
        .iter()
        .zip(stations)
        .map(|(o, s)| row(o, s, &solution.unknowns, solution.fusion))
        .collect()
}

/// What part of the noise that is new in every row is the compass's: a gyro is
/// steadier than a compass, a satellite compass is not. Without times all noise
/// passes for new, the reference's wander too.
fn compass_part_of_white(observations: &[Observation]) -> f64 {
    if observations.iter().any(|o| o.time.is_none()) {
        return OF_WHITE_UNTIMED;
    }
    let by_gyro: f64 = observations.iter().map(|o| o.gyro_share).sum();
    let gyro_share = by_gyro / observations.len() as f64;
    OF_WHITE_BY_SATELLITE + gyro_share * (OF_WHITE_BY_GYRO - OF_WHITE_BY_SATELLITE)
}

/// Scores and information of stretches of days: were the noise model right,
/// each stretch's score would vary as its information says.
struct Blocks<'a> {
    observations: &'a [Observation],
    of: Vec<Block>,
}

struct Block {
    /// Its place among all stretches since 1970.
    number: i64,
    score: [f64; UNKNOWNS],
    information: Products<UNKNOWNS>,
}

impl<'a> Blocks<'a> {
    fn new(observations: &'a [Observation]) -> Blocks<'a> {
        Blocks {
            observations,
            of: Vec::new(),
        }
    }

    fn add(&mut self, index: usize, whitened: &Whitened) {
        let Some(time) = self.observations[index].time else {
            return;
        };
        let number = (time.micros() as f64 / 1e6 / BLOCK_S).floor() as i64;
        if self.of.last().is_none_or(|last| last.number != number) {
            self.of.push(Block {
                number,
                score: [0.0; UNKNOWNS],
                information: Products::new(),
            });
        }
        let last = self
            .of
            .last_mut()
            .expect("one was pushed if there was none");
        let columns = whitened.columns();
        let weight = whitened.weight_per_variance;
        let pull = weight * whitened.innovation();
        for (sum, column) in last.score.iter_mut().zip(&columns) {
            *sum += pull * column;
        }
        last.information.add(&columns, weight);
    }

    /// How many times larger the scores' squares are than the noise model says,
    /// at least 1, the fit's own part taken off.
    fn inflation(&self, covariance: &Matrix) -> f64 {
        let (mut seen, mut expected) = (0.0, 0.0);
        for block in &self.of {
            let score = Vector::from(block.score);
            let share = block.information.to_matrix() * covariance;
            seen += score.dot(&(covariance * score));
            expected += share.trace() - (share * share).trace();
        }
        // Too few stretches say nothing.
        if expected > 1.0 {
            (seen / expected).max(1.0)
        } else {
            1.0
        }
    }
}

fn in_own_units_squared(covariance: &Matrix) -> Covariance {
    let scale = scales();
    let mut out = [[0.0; 8]; 8];
    for i in 0..8 {
        for j in 0..8 {
            let mean = f64::midpoint(covariance[(i, j)], covariance[(j, i)]);
            out[i][j] = mean * scale[i] * scale[j];
        }
    }
    out
}
