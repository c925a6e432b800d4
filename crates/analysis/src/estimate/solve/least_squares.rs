//! The estimate as a problem of least squares: Gauss and Newton's steps on whitened
//! rows, with a prior whose tails give way.
//!
//! What always holds: when a solution has settled, the next step would be smaller than
//! was asked for; what is judged is the pass that told so.

use super::quality::widely;
use crate::estimate::prior::{Prior, scales, tail};
use crate::estimate::products::Products;
use crate::estimate::rows::{CONSTANT, Point, Row, Station, UNKNOWNS, Unknowns, row, stations};
use crate::estimate::undated_rows::{all_timed, cell_of, design_effect};
use crate::estimate::whitening::{Drift, Part, Pass, Whitening, whiten};
use crate::estimate::whitening::{Pull, Sought, fit_levels};
use crate::observation::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;
use nalgebra::{SMatrix, SVector};

/// Gauss–Newton steps at most; three suffice near the solution, thirty where the
/// weights and the prior's tail move with it.
const ITERATIONS: u32 = 40;
/// The compass's part of the noise that is new in every row.
const OF_WHITE_BY_GYRO: f64 = 0.85;
const OF_WHITE_BY_SATELLITE: f64 = 0.5;
const OF_WHITE_UNTIMED: f64 = 0.6;
/// Where bx and by stand among the unknowns.
const DRIFTING: [usize; 2] = [0, 2];
/// Days whose scores are held against what the noise model says of them.
const BLOCK_S: f64 = 4.0 * 86_400.0;

pub(crate) type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
pub(crate) type Vector = SVector<f64, UNKNOWNS>;

/// Observations from the earliest to the latest, with what stays the same
/// through the iteration.
pub(crate) struct Problem<'a> {
    pub(crate) observations: &'a [Observation],
    pub(crate) stations: Vec<Station>,
    pub(crate) prior_mean: Vector,
    pub(crate) prior_information: Matrix,
}

/// Where the iteration is.
pub(crate) struct Solution {
    pub(crate) unknowns: Unknowns,
    /// The reference's share in the heading at which rows are taken.
    pub(crate) fusion: f64,
    /// The prior's information there.
    pub(crate) prior_information: Matrix,
}

/// How large the steps were.
struct Steps {
    /// The next is to be smaller than this.
    settled: f64,
    last: f64,
}

impl Steps {
    fn new(settled: f64) -> Steps {
        Steps {
            settled,
            last: f64::INFINITY,
        }
    }

    /// Returns true if the step after this one would be small enough, if steps go on to
    /// shrink as they do.
    fn end_with(&mut self, step: &Vector) -> bool {
        let size = step.amax();
        let shrunk = (size / self.last).min(1.0);
        self.last = size;
        size * shrunk < self.settled
    }
}

/// What the last pass says of a solution.
pub(crate) struct Judged {
    /// Parameters as they were at the last observation, in population units.
    pub(crate) at_last: Unknowns,
    pub(crate) information: Matrix,
    pub(crate) covariance: Matrix,
    /// The same by the data alone.
    pub(crate) by_data: Option<Matrix>,
    /// What the rows would tell were their errors independent and of one degree.
    pub(crate) independent: Matrix,
    pub(crate) weights: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(crate) fn new(observations: &'a [Observation], prior: &Prior) -> Option<Problem<'a>> {
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

    /// The same ship's problem by other observations.
    pub(crate) fn by<'b>(&self, observations: &'b [Observation]) -> Problem<'b> {
        Problem {
            observations,
            stations: stations(observations),
            prior_mean: self.prior_mean,
            prior_information: self.prior_information,
        }
    }

    /// The levels at a solution, sought from `levels`, and the share that the
    /// reference has by them in the heading at which rows are taken.
    pub(crate) fn levels_at(
        &self,
        solution: &Solution,
        typical: &NoiseLevels,
        levels: &NoiseLevels,
        sought: Sought,
    ) -> (NoiseLevels, f64) {
        let rows = self.rows(solution);
        let pull = self.pull(solution);
        let found = fit_levels(&self.stations, &rows, &pull, typical, levels, sought);
        let of_white = compass_part_of_white(self.observations);
        (found.levels, found.compass_share(&self.stations, of_white))
    }

    /// Gauss–Newton from a solution until it settles, and the parameters' drift then.
    pub(crate) fn descend(
        &self,
        mut solution: Solution,
        levels: &NoiseLevels,
        settled: f64,
    ) -> Option<(Solution, Drift)> {
        let mut steps = Steps::new(settled);
        for _ in 0..ITERATIONS {
            let rows = self.rows(&solution);
            let pass = whiten(&self.stations, &rows, levels);
            let step = self.step(&mut solution, &pass)?;
            if steps.end_with(&step) {
                return Some((solution, pass.drift.after(&step)));
            }
        }
        None
    }

    /// The same, judged.
    pub(crate) fn settle(
        &self,
        mut solution: Solution,
        levels: &NoiseLevels,
        settled: f64,
    ) -> Option<(Solution, Judged)> {
        let timed = all_timed(self.observations);
        let block_of = if timed { days_of } else { cell_of };
        let mut steps = Steps::new(settled);
        let mut blocks = Vec::new();
        let mut sizes = Vec::new();
        let mut weights = Vec::with_capacity(self.observations.len());
        for _ in 0..ITERATIONS {
            blocks.clear();
            sizes.clear();
            weights.clear();
            let mut whitening: Whitening = Whitening::new(levels);
            let mut independent = Products::new();
            let mut block = None;
            let point = Point::at(&solution.unknowns, solution.fusion);
            for (o, station) in self.observations.iter().zip(&self.stations) {
                let number = block_of(o);
                if block != Some(number) {
                    let told = whitening.cut();
                    blocks.extend(block.map(|_| told));
                    sizes.push(0.0);
                    block = Some(number);
                }
                if let Some(size) = sizes.last_mut() {
                    *size += 1.0;
                }
                let row = row(o, station, &point);
                let weight = whitening.take(station, &row);
                independent.add(&row.columns, weight);
                weights.push(weight);
            }
            let told = whitening.cut();
            blocks.extend(block.map(|_| told));
            let mut pass = whitening.pass();
            let step = self.step(&mut solution, &pass)?;
            if steps.end_with(&step) {
                if !timed {
                    let covariance = covariance(&solution, &pass)?;
                    let seen = inflation(&blocks, &covariance);
                    pass.information /= seen.max(design_effect(sizes.into_iter()));
                    blocks.clear();
                }
                let judged = judge(&solution, &pass, &step, &blocks, &independent, weights)?;
                return Some((solution, judged));
            }
        }
        None
    }

    fn rows(&self, solution: &Solution) -> Vec<Row> {
        let point = Point::at(&solution.unknowns, solution.fusion);
        self.observations
            .iter()
            .zip(&self.stations)
            .map(|(o, s)| row(o, s, &point))
            .collect()
    }

    /// One step of Gauss and Newton's; none where it leads nowhere.
    fn step(&self, solution: &mut Solution, pass: &Pass) -> Option<Vector> {
        let pull = self.pull(solution);
        let covariance = (pass.information + pull.information).cholesky()?.inverse();
        let step = covariance * (pass.score + pull.score);
        for (u, d) in solution.unknowns.iter_mut().zip(step.iter()) {
            *u += d;
        }
        if !solution.unknowns.iter().all(|u| u.is_finite()) {
            return None;
        }
        solution.prior_information = self.prior_at(&solution.unknowns, &covariance);
        Some(step)
    }

    fn pull(&self, solution: &Solution) -> Pull {
        let off = self.prior_mean - Vector::from(solution.unknowns);
        Pull {
            information: solution.prior_information,
            score: solution.prior_information * off,
        }
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

impl Solution {
    /// What was known of parameters and constant before the data.
    pub(crate) fn prior_covariance(&self) -> Option<SMatrix<f64, 8, 8>> {
        let information = self.prior_information.fixed_view::<8, 8>(0, 0);
        Some(information.into_owned().cholesky()?.inverse())
    }

    /// From the first observation, where drift begins, to the last.
    pub(crate) fn at_last(&self, drift: &Drift) -> Unknowns {
        let scale = scales();
        let mut at_last = self.unknowns;
        for (a, i) in DRIFTING.into_iter().enumerate() {
            at_last[i] += drift.nt[a] / scale[i];
        }
        at_last
    }
}

/// The stretch of days that an observation with a time is of.
fn days_of(o: &Observation) -> i64 {
    let micros = o.time.map_or(0, Timestamp::micros);
    (micros as f64 / 1e6 / BLOCK_S).floor() as i64
}

/// What a pass says of the solution that `step` led to.
fn judge(
    solution: &Solution,
    pass: &Pass,
    step: &Vector,
    blocks: &[Part],
    independent: &Products<UNKNOWNS>,
    weights: Vec<f64>,
) -> Option<Judged> {
    let drift = pass.drift.after(step);
    let covariance = covariance(solution, pass)?;
    let covariance = covariance * inflation(blocks, &covariance);
    // From where the filter began to where the ship is now.
    let scale = scales();
    let mut follows = Matrix::identity();
    let mut drifted = Matrix::zeros();
    for (a, i) in DRIFTING.into_iter().enumerate() {
        for (j, per_unknown) in drift.per_unknown[a].iter().enumerate() {
            follows[(i, j)] -= per_unknown / scale[i];
        }
        for (b, j) in DRIFTING.into_iter().enumerate() {
            drifted[(i, j)] = drift.covariance[a][b] / (scale[i] * scale[j]);
        }
    }
    let now = |then: Matrix| follows * then * follows.transpose() + drifted;
    Some(Judged {
        at_last: solution.at_last(&drift),
        information: pass.information,
        covariance: now(covariance),
        by_data: widely(&pass.information)
            .cholesky()
            .map(|factor| now(factor.inverse())),
        independent: independent.to_matrix(),
        weights,
    })
}

/// What rows and prior leave open where the filter began.
fn covariance(solution: &Solution, pass: &Pass) -> Option<Matrix> {
    let information = pass.information + solution.prior_information;
    Some(information.cholesky()?.inverse())
}

/// How many times larger the squares of the stretches' scores are than the noise
/// model says, at least 1, the fit's own part taken off: were the model right, each
/// stretch's score would vary as its information says.
fn inflation(blocks: &[Part], covariance: &Matrix) -> f64 {
    let (mut seen, mut expected) = (0.0, 0.0);
    for Part { information, score } in blocks {
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

/// What part of the noise that is new in every row is the compass's: a gyro is
/// steadier than a compass, a satellite compass is not. Without times all noise
/// passes for new, the reference's wander too.
fn compass_part_of_white(observations: &[Observation]) -> f64 {
    if !all_timed(observations) {
        return OF_WHITE_UNTIMED;
    }
    let by_gyro: f64 = observations.iter().map(|o| o.gyro_share).sum();
    let gyro_share = by_gyro / observations.len() as f64;
    OF_WHITE_BY_SATELLITE + gyro_share * (OF_WHITE_BY_GYRO - OF_WHITE_BY_SATELLITE)
}
