//! The estimate itself: a robust start, noise levels from the data, and
//! Gauss–Newton on whitened rows.

use super::levels::{Pull, fit_levels};
use super::noise::NoiseLevels;
use super::prior::{Prior, scales};
use super::row::{
    CONSTANT, Row, Station, UNKNOWNS, Unknowns, in_own_units, plain_residual, row, stations,
};
use super::start::start;
use super::whiten::{Pass, whiten};
use crate::fit::Observation;
use crate::model::{Covariance, Identifiable, Parameters};
use crate::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};

/// Gauss–Newton steps at most; three suffice near the solution.
const ITERATIONS: u32 = 12;
/// Rounds of noise levels and parameters in turn: how often each level is moved,
/// and the step, in population standard deviations, below which the parameters
/// have settled.
const ROUNDS: [(u32, f64); 2] = [(3, 0.01), (1, 5e-4)];
/// Days whose scores are held against what the noise model says of them.
const BLOCK_S: f64 = 4.0 * 86_400.0;
/// For judging what the data alone say, the population is taken this much wider.
const WIDER: f64 = 10.0;
/// A parameter is the data's when they alone leave at most this part of the
/// population's standard deviation.
const DATA_DRIVEN: f64 = 0.5;

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
    order.sort_by_key(|&i| std::cmp::Reverse(observations[i].time));
    let sorted: Vec<Observation> = order.iter().map(|&i| observations[i]).collect();
    let problem = Problem::new(&sorted, options.prior)?;
    let timed = sorted.iter().all(|o| o.time.is_some());
    let typical = if timed {
        NoiseLevels::TYPICAL
    } else {
        NoiseLevels::MEMORYLESS
    };
    let (unknowns, levels) = problem.solve(&typical)?;
    let judged = problem.judge(&unknowns, &levels)?;

    let (parameters, constant_deg) = in_own_units(&unknowns);
    let mut covariance = in_own_units_squared(&judged.covariance);
    covariance[CONSTANT][CONSTANT] += options.reference_constant_sd_deg.powi(2);
    let mut rows = vec![
        FittedRow {
            residual_deg: 0.0,
            weight: 0.0
        };
        order.len()
    ];
    for ((&index, observation), weight) in order.iter().zip(&sorted).zip(judged.weights) {
        rows[index] = FittedRow {
            residual_deg: plain_residual(observation, &unknowns),
            weight,
        };
    }
    Some(Estimate {
        parameters: Parameters::from_array(parameters),
        constant_deg,
        covariance,
        identifiable: identifiable(&judged.information),
        levels,
        rows,
    })
}

type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Vector = SVector<f64, UNKNOWNS>;

/// Observations from the latest to the earliest, with what stays the same
/// through the iteration.
struct Problem<'a> {
    observations: &'a [Observation],
    stations: Vec<Station>,
    prior_mean: Unknowns,
    prior_information: Matrix,
}

/// What the final pass says of a solution.
struct Judged {
    information: Matrix,
    covariance: Matrix,
    weights: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(observations: &'a [Observation], prior: &Prior) -> Option<Problem<'a>> {
        let (mean, information) = prior.in_population_units()?;
        let mut prior_mean = [0.0; UNKNOWNS];
        prior_mean[..=CONSTANT].copy_from_slice(&mean);
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

    fn solve(&self, typical: &NoiseLevels) -> Option<(Unknowns, NoiseLevels)> {
        let (mut unknowns, sd) = start(
            self.observations,
            &self.stations,
            &self.prior_mean,
            &self.prior_information,
        );
        // Most of what is left after a fit is slow; some half of it is new in
        // every row.
        let mut levels = *typical;
        levels.white_deg = (sd / 2.0).clamp(0.02, 10.0);
        for (sweeps, settled) in ROUNDS {
            let rows = self.rows(&unknowns);
            let pull = self.pull(&unknowns);
            levels = fit_levels(&self.stations, &rows, &pull, typical, &levels, sweeps);
            unknowns = self.descend(unknowns, &levels, settled)?;
        }
        Some((unknowns, levels))
    }

    /// Gauss–Newton from `unknowns` until it settles.
    fn descend(
        &self,
        mut unknowns: Unknowns,
        levels: &NoiseLevels,
        settled: f64,
    ) -> Option<Unknowns> {
        for _ in 0..ITERATIONS {
            let pass = whiten(&self.stations, &self.rows(&unknowns), levels, |_, _| ());
            let pull = self.pull(&unknowns);
            let step = (pass.information + pull.information)
                .cholesky()?
                .solve(&(pass.score + pull.score));
            for (u, d) in unknowns.iter_mut().zip(step.iter()) {
                *u += d;
            }
            if !unknowns.iter().all(|u| u.is_finite()) {
                return None;
            }
            if step.amax() < settled {
                return Some(unknowns);
            }
        }
        None
    }

    fn judge(&self, unknowns: &Unknowns, levels: &NoiseLevels) -> Option<Judged> {
        let rows = self.rows(unknowns);
        let mut weights = Vec::with_capacity(rows.len());
        let mut blocks = Blocks::new(self.observations);
        let pass: Pass = whiten(&self.stations, &rows, levels, |index, whitened| {
            weights.push(whitened.weight);
            let columns = Vector::from(whitened.columns);
            blocks.add(index, &columns, whitened.weight, whitened.innovation);
        });
        let covariance = (pass.information + self.prior_information)
            .cholesky()?
            .inverse();
        Some(Judged {
            covariance: covariance * blocks.inflation(&covariance),
            information: pass.information,
            weights,
        })
    }

    fn rows(&self, unknowns: &Unknowns) -> Vec<Row> {
        self.observations
            .iter()
            .zip(&self.stations)
            .map(|(o, s)| row(o, s, unknowns))
            .collect()
    }

    fn pull(&self, unknowns: &Unknowns) -> Pull {
        let off = Vector::from(self.prior_mean) - Vector::from(*unknowns);
        Pull {
            information: self.prior_information,
            score: self.prior_information * off,
        }
    }
}

/// Scores and information of stretches of days: were the noise model right,
/// each stretch's score would vary as its information says.
struct Blocks<'a> {
    observations: &'a [Observation],
    of: Vec<(i64, Vector, Matrix)>,
}

impl<'a> Blocks<'a> {
    fn new(observations: &'a [Observation]) -> Blocks<'a> {
        Blocks {
            observations,
            of: Vec::new(),
        }
    }

    fn add(&mut self, index: usize, columns: &Vector, weight: f64, innovation: f64) {
        let Some(time) = self.observations[index].time else {
            return;
        };
        let block = (time.micros() as f64 / 1e6 / BLOCK_S).floor() as i64;
        if self.of.last().is_none_or(|last| last.0 != block) {
            self.of.push((block, Vector::zeros(), Matrix::zeros()));
        }
        let last = self
            .of
            .last_mut()
            .expect("one was pushed if there was none");
        last.1 += columns * (weight * innovation);
        last.2 += columns * columns.transpose() * weight;
    }

    /// How many times larger the scores' squares are than the noise model says,
    /// at least 1, the fit's own part taken off.
    fn inflation(&self, covariance: &Matrix) -> f64 {
        let (mut seen, mut expected) = (0.0, 0.0);
        for (_, score, information) in &self.of {
            let share = information * covariance;
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

/// Which parameters the data alone tell, the population taken much wider than
/// it is. A is (χ21 − χ12)/2 and cannot be told from the constant, so that of
/// χ12 and χ21 headings tell the sum, E, and neither by itself.
fn identifiable(information: &Matrix) -> Identifiable {
    let mut alone = *information;
    for j in 0..UNKNOWNS {
        let own = if j < PARAMETERS {
            1.0 / (WIDER * WIDER)
        } else {
            1.0
        };
        alone[(j, j)] += own;
    }
    let by_data = alone.cholesky().map(|factor| factor.inverse());
    let told = |j: usize| by_data.is_some_and(|covariance| covariance[(j, j)].sqrt() < DATA_DRIVEN);
    // What is permanent is known only when what the dip induces is.
    let (fore_and_aft, athwart) = (told(0) && told(1), told(2) && told(3));
    Identifiable {
        bx_nt: fore_and_aft,
        chi13: fore_and_aft,
        by_nt: athwart,
        chi23: athwart,
        chi11_minus_chi22: told(4),
        chi12: told(5),
        chi21: told(6),
        constant_deg: false,
    }
}
