//! Least-squares problem: Gauss–Newton steps on whitened rows, with a heavy-tailed prior.
//!
//! Once a solution has settled, the next step would be smaller than the limit. The pass
//! that showed it is the one evaluated.

use super::alignment::Turn;
use super::quality::with_wide_population;
use crate::estimate::prior::{Prior, scales, tail_factors};
use crate::estimate::products::Products;
use crate::estimate::rows::{
    CONSTANT, LinearisationPoint, Row, RowFrame, UNKNOWNS, Unknowns, frames, row,
};
use crate::estimate::undated_rows::{all_dated, design_effect, heading_cell};
use crate::estimate::whitening::{Drift, Part, Pass, Whitening, whiten};
use crate::estimate::whitening::{PriorTerms, SearchEffort, fit_levels};
use crate::observation::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;
use nalgebra::{SMatrix, SVector};

/// Greatest number of Gauss–Newton steps; three suffice near the solution, thirty where the
/// weights and the prior's tail move with it.
const ITERATIONS: u32 = 40;
/// Compass's share of the noise that is new in every row, with a gyro, with a satellite
/// compass, and without times.
const WHITE_SHARE_WITH_GYRO: f64 = 0.85;
const WHITE_SHARE_WITH_SATELLITE: f64 = 0.5;
const WHITE_SHARE_UNDATED: f64 = 0.6;
/// Indices of bx and by among the unknowns.
const DRIFTING: [usize; 2] = [0, 2];
/// Length of the blocks whose scores are compared with the noise model.
const BLOCK_S: f64 = 4.0 * 86_400.0;

pub(crate) type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
pub(crate) type Vector = SVector<f64, UNKNOWNS>;

/// Observations in order of time, with the terms that the iteration does not change.
pub(crate) struct Problem<'a> {
    pub(crate) observations: &'a [Observation],
    pub(crate) frames: Vec<RowFrame>,
    pub(crate) prior_mean: Vector,
    pub(crate) prior_information: Matrix,
}

/// Solution at one point of the iteration.
pub(crate) struct Solution {
    pub(crate) unknowns: Unknowns,
    /// Share of the reference in the heading at which rows are linearised.
    pub(crate) reference_share: f64,
    /// Information of the prior at that solution.
    pub(crate) prior_information: Matrix,
}

/// Sizes of the steps.
struct Steps {
    /// Limit below which the next step must be.
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

    /// Returns true if the step after this one would be small enough, if steps go on
    /// shrinking.
    fn end_with(&mut self, step: &Vector) -> bool {
        let size = step.amax();
        let shrunk = (size / self.last).min(1.0);
        self.last = size;
        size * shrunk < self.settled
    }
}

/// Evaluated solution of the last pass.
pub(crate) struct EvaluatedSolution {
    /// Parameters at the last observation, in population units.
    pub(crate) at_last_row: Unknowns,
    pub(crate) information: Matrix,
    pub(crate) covariance: Matrix,
    /// Covariance by the data alone.
    pub(crate) by_data: Option<Matrix>,
    /// Information of the rows for independent errors of one degree.
    pub(crate) independent: Matrix,
    pub(crate) weights: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(crate) fn new(observations: &'a [Observation], prior: &Prior) -> Option<Problem<'a>> {
        let (mean, information) = prior.in_population_units()?;
        let mut prior_mean = Vector::zeros();
        prior_mean.as_mut_slice()[..=CONSTANT].copy_from_slice(&mean);
        // Nuisances are in units of their own prior.
        let mut prior_information = Matrix::identity();
        prior_information
            .fixed_view_mut::<8, 8>(0, 0)
            .copy_from(&information);
        Some(Problem {
            observations,
            frames: frames(observations),
            prior_mean,
            prior_information,
        })
    }

    /// Returns the same vessel's problem with other observations.
    pub(crate) fn by<'b>(&self, observations: &'b [Observation]) -> Problem<'b> {
        Problem {
            observations,
            frames: frames(observations),
            prior_mean: self.prior_mean,
            prior_information: self.prior_information,
        }
    }

    /// Returns the levels at a solution, searched from `levels`, and the reference's share
    /// that follows from them.
    pub(crate) fn levels_at(
        &self,
        solution: &Solution,
        typical: &NoiseLevels,
        levels: &NoiseLevels,
        effort: SearchEffort,
    ) -> (NoiseLevels, f64) {
        let rows = self.rows(solution);
        let prior_terms = self.prior_terms(solution);
        let found = fit_levels(&self.frames, &rows, &prior_terms, typical, levels, effort);
        let white_share = compass_part_of_white(self.observations);
        (found.levels, found.compass_share(&self.frames, white_share))
    }

    /// Returns the settled solution of Gauss–Newton, and the drift of the parameters.
    pub(crate) fn descend(
        &self,
        mut solution: Solution,
        levels: &NoiseLevels,
        settled: f64,
    ) -> Option<(Solution, Drift)> {
        let mut steps = Steps::new(settled);
        for _ in 0..ITERATIONS {
            let rows = self.rows(&solution);
            let pass = whiten(&self.frames, &rows, levels);
            let step = self.step(&mut solution, &pass)?;
            if steps.end_with(&step) {
                return Some((solution, pass.drift.after(&step)));
            }
        }
        None
    }

    /// Returns the settled solution of Gauss–Newton with its evaluation.
    pub(crate) fn settle(
        &self,
        mut solution: Solution,
        levels: &NoiseLevels,
        settled: f64,
    ) -> Option<(Solution, EvaluatedSolution)> {
        let dated = all_dated(self.observations);
        let block_of = if dated { days_of } else { heading_cell };
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
            let point = LinearisationPoint::at(&solution.unknowns, solution.reference_share);
            for (o, frame) in self.observations.iter().zip(&self.frames) {
                let number = block_of(o);
                if block != Some(number) {
                    let shown = whitening.cut();
                    blocks.extend(block.map(|_| shown));
                    sizes.push(0.0);
                    block = Some(number);
                }
                if let Some(size) = sizes.last_mut() {
                    *size += 1.0;
                }
                let row = row(o, frame, &point);
                let weight = whitening.observe(frame, &row);
                independent.add(&row.columns, weight);
                weights.push(weight);
            }
            let shown = whitening.cut();
            blocks.extend(block.map(|_| shown));
            let mut pass = whitening.pass();
            let step = self.step(&mut solution, &pass)?;
            if steps.end_with(&step) {
                if !dated {
                    let covariance = covariance(&solution, &pass)?;
                    let seen = inflation(&blocks, &covariance);
                    pass.information /= seen.max(design_effect(sizes.into_iter()));
                    blocks.clear();
                }
                let evaluated = evaluate(&solution, &pass, &step, &blocks, &independent, weights)?;
                return Some((solution, evaluated));
            }
        }
        None
    }

    fn rows(&self, solution: &Solution) -> Vec<Row> {
        let point = LinearisationPoint::at(&solution.unknowns, solution.reference_share);
        self.observations
            .iter()
            .zip(&self.frames)
            .map(|(o, s)| row(o, s, &point))
            .collect()
    }

    /// Takes one Gauss–Newton step; none where it fails.
    fn step(&self, solution: &mut Solution, pass: &Pass) -> Option<Vector> {
        let prior_terms = self.prior_terms(solution);
        let covariance = (pass.information + prior_terms.information)
            .cholesky()?
            .inverse();
        let step = covariance * (pass.score + prior_terms.score);
        for (u, d) in solution.unknowns.iter_mut().zip(step.iter()) {
            *u += d;
        }
        if !solution.unknowns.iter().all(|u| u.is_finite()) {
            return None;
        }
        solution.prior_information = self.prior_at(&solution.unknowns, &covariance);
        Some(step)
    }

    fn prior_terms(&self, solution: &Solution) -> PriorTerms {
        let off = self.prior_mean - Vector::from(solution.unknowns);
        PriorTerms {
            information: solution.prior_information,
            score: solution.prior_information * off,
        }
    }

    /// Returns the prior's information, less in its tail.
    fn prior_at(&self, unknowns: &Unknowns, covariance: &Matrix) -> Matrix {
        let off = Vector::from(*unknowns) - self.prior_mean;
        let factors = tail_factors(
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
    /// Returns the prior covariance of parameters and constant.
    pub(crate) fn prior_covariance(&self) -> Option<SMatrix<f64, 8, 8>> {
        let information = self.prior_information.fixed_view::<8, 8>(0, 0);
        Some(information.into_owned().cholesky()?.inverse())
    }

    /// Returns the unknowns at the last observation: drift begins at the first.
    pub(crate) fn at_last_row(&self, drift: &Drift) -> Unknowns {
        let scale = scales();
        let mut at_last_row = self.unknowns;
        for (a, i) in DRIFTING.into_iter().enumerate() {
            at_last_row[i] += drift.nt[a] / scale[i];
        }
        at_last_row
    }
}

impl EvaluatedSolution {
    /// Takes the solution of a straightened compass to that of the compass as mounted; none
    /// where a matrix is singular.
    pub(crate) fn turn(&mut self, turn: Turn) -> Option<()> {
        let scale = scales();
        let mut there = Matrix::identity();
        there
            .fixed_view_mut::<8, 8>(0, 0)
            .copy_from(&turn.matrix(&scale));
        let back = there.try_inverse()?;
        self.at_last_row = (there * Vector::from(self.at_last_row)).into();
        let constant_deg = self.at_last_row[CONSTANT] * scale[CONSTANT];
        self.at_last_row[CONSTANT] = turn.constant_deg(constant_deg) / scale[CONSTANT];
        let covariance = |of: &Matrix| there * of * there.transpose();
        let information = |of: &Matrix| back.transpose() * of * back;
        self.covariance = covariance(&self.covariance);
        self.by_data = self.by_data.as_ref().map(covariance);
        self.information = information(&self.information);
        self.independent = information(&self.independent);
        Some(())
    }
}

/// Returns the block of days of an observation with a time.
fn days_of(o: &Observation) -> i64 {
    let micros = o.time.map_or(0, Timestamp::micros);
    (micros as f64 / 1e6 / BLOCK_S).floor() as i64
}

/// Evaluates a pass for the solution that `step` led to.
fn evaluate(
    solution: &Solution,
    pass: &Pass,
    step: &Vector,
    blocks: &[Part],
    independent: &Products<UNKNOWNS>,
    weights: Vec<f64>,
) -> Option<EvaluatedSolution> {
    let drift = pass.drift.after(step);
    let covariance = covariance(solution, pass)?;
    let covariance = covariance * inflation(blocks, &covariance);
    // From the first observation to the last.
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
    Some(EvaluatedSolution {
        at_last_row: solution.at_last_row(&drift),
        information: pass.information,
        covariance: now(covariance),
        by_data: with_wide_population(&pass.information)
            .cholesky()
            .map(|factor| now(factor.inverse())),
        independent: independent.to_matrix(),
        weights,
    })
}

/// Returns the covariance by rows and prior at the first observation.
fn covariance(solution: &Solution, pass: &Pass) -> Option<Matrix> {
    let information = pass.information + solution.prior_information;
    Some(information.cholesky()?.inverse())
}

/// Returns the ratio, at least 1, of the squares of the blocks' scores to the noise model,
/// without the fit's own part: in a correct model each score varies as its information
/// says.
fn inflation(blocks: &[Part], covariance: &Matrix) -> f64 {
    let (mut seen, mut expected) = (0.0, 0.0);
    for Part { information, score } in blocks {
        let share = information * covariance;
        seen += score.dot(&(covariance * score));
        expected += share.trace() - (share * share).trace();
    }
    // Too few blocks say nothing.
    if expected > 1.0 {
        (seen / expected).max(1.0)
    } else {
        1.0
    }
}

/// Returns the compass's share of the noise that is new in every row: a gyro is steadier
/// than a compass, a satellite compass is not. Without times all noise counts as new, the
/// reference's wander, too.
fn compass_part_of_white(observations: &[Observation]) -> f64 {
    if !all_dated(observations) {
        return WHITE_SHARE_UNDATED;
    }
    let by_gyro: f64 = observations.iter().map(|o| o.gyro_share).sum();
    let gyro_share = by_gyro / observations.len() as f64;
    WHITE_SHARE_WITH_SATELLITE + gyro_share * (WHITE_SHARE_WITH_GYRO - WHITE_SHARE_WITH_SATELLITE)
}
