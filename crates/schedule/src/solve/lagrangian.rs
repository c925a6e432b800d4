//! Lagrangian relaxation: prices of the needs, the lower bound, and the choices
//! that the prices favour.
//!
//! The constraint that a need is met at most once is given a price. The rest
//! falls into the crews, of each of which the teams take the best stays; that is
//! exact for the relaxed problem ([`super::relaxation`]). Such a bound is at least that of the linear
//! relaxation with x ≤ y for each job and its team (A. M. Geoffrion,
//! "Lagrangean relaxation for integer programming", Mathematical Programming
//! Study 2, 1974, Theorem 1). Prices follow the mean of the subproblems'
//! solutions, which tends to the solution of the relaxation (F. Barahona and R.
//! Anbil, "The volume algorithm: producing primal solutions with a subgradient
//! method", Mathematical Programming 87, 2000, section 3).
//!
//! Invariant: the bound is right for any prices. They are rounded to cents and
//! the bound is summed in integers, so that a bad price makes the bound worse,
//! never false.

use super::bound::{self, Bound};
use super::problem::Problem;
use super::relaxation::Relaxation;
use super::subproblem::{Solution, Subproblem};
use super::work_limit::WorkLimit;

/// Steps without a better bound, after which steps are made smaller.
const PATIENCE: usize = 20;
/// The initial step factor.
const FIRST_STEP: f64 = 0.1;
/// The smallest useful step factor.
const SMALLEST_STEP: f64 = 1e-5;
/// A step aims at most at this fraction above the current bound, however far
/// the known cost is.
const AIM: f64 = 0.02;
/// Steps after which the newest solution gets less weight in the mean, if the
/// bound has risen by less than a thousandth.
const SLOW: usize = 100;
/// The least such weight.
const LEAST_WEIGHT: f64 = 1e-3;

/// Prices of needs in cents, at the best bound so far.
pub(super) struct Prices<'a> {
    problem: &'a Problem,
    relaxation: &'a Relaxation<'a>,
    subproblem: Subproblem<'a>,
    at: Vec<f64>,
    cost: f64,
    /// Cost of leaving each need unmet: its highest price.
    most: Vec<f64>,
    /// Share of each choice in the mean.
    mean: Vec<f64>,
    /// Number of times that each need is met in the mean.
    met: Vec<f64>,
    /// Fraction of Polyak's step.
    factor: f64,
    /// The most weight of the newest solution in the mean.
    weight: f64,
}

impl<'a> Prices<'a> {
    /// Starts with the cost of each need's cheapest choice alone.
    pub(super) fn new(relaxation: &'a Relaxation<'a>) -> Prices<'a> {
        let problem = relaxation.problem;
        let subproblem = Subproblem::new(relaxation);
        let most: Vec<f64> = problem.unmet.iter().map(|unmet| *unmet as f64).collect();
        let mut at = most.clone();
        for choice in &problem.choices {
            let visit = problem.visits[choice.visit];
            let alone = (choice.cost + visit.travel) as f64;
            at[choice.need] = at[choice.need].min(alone);
        }
        let solution = subproblem.solve(&at);
        let mut mean = vec![0.0; problem.choices.len()];
        for choice in &solution.choices {
            mean[*choice] = 1.0;
        }
        Prices {
            met: met(problem, &solution),
            problem,
            relaxation,
            subproblem,
            at,
            cost: solution.cost,
            most,
            mean,
            factor: FIRST_STEP,
            weight: 0.1,
        }
    }

    /// Raises the bound by at most `steps` steps, towards an assignment of cost
    /// `known`.
    pub(super) fn improve(&mut self, known: i64, steps: usize, work: &mut WorkLimit) {
        let each = self.mean.len() + self.at.len();
        let (mut since, mut before) = (0, self.cost);
        // The step factor starts again: it may have become small on the way to
        // a worse assignment's cost.
        self.factor = FIRST_STEP;
        for step in 1..=steps.min(work.steps(each)) {
            work.spend(each);
            let Some(trial) = self.trial(known as f64) else {
                return;
            };
            let solution = self.subproblem.solve(&trial);
            let met = met(self.problem, &solution);
            let slopes_agree = self.slopes_agree(&met);
            self.add_to_mean(&solution, &met, &trial);
            if solution.cost > self.cost {
                (self.at, self.cost, since) = (trial, solution.cost, 0);
                if slopes_agree {
                    self.factor = (self.factor * 1.1).min(2.0);
                }
            } else {
                since += 1;
            }
            if since >= PATIENCE {
                (self.factor, since) = (self.factor * 0.66, 0);
                if self.factor < SMALLEST_STEP {
                    return;
                }
            }
            if step % SLOW == 0 {
                if self.cost - before < 1e-3 * self.cost.abs() {
                    self.weight = (self.weight / 2.0).max(LEAST_WEIGHT);
                }
                before = self.cost;
            }
        }
    }

    /// Returns the next prices; `None` where the mean meets each need once or the gap
    /// is closed.
    fn trial(&self, known: f64) -> Option<Vec<f64>> {
        let slopes: Vec<f64> = (0..self.at.len()).map(|need| self.slope(need)).collect();
        let length: f64 = slopes.iter().map(|slope| slope * slope).sum();
        if length < 1e-9 || known - self.cost < 0.5 {
            return None;
        }
        let aim = known.min(self.cost + AIM * self.cost.abs().max(1.0));
        let step = self.factor * (aim - self.cost) / length;
        let prices = self.at.iter().zip(&slopes).zip(&self.most);
        Some(
            prices
                .map(|((price, slope), most)| (price + step * slope).clamp(0.0, *most))
                .collect(),
        )
    }

    /// Returns the slope of a need's price by the mean: positive for a need that is met too
    /// seldom.
    fn slope(&self, need: usize) -> f64 {
        let slope = 1.0 - self.met[need];
        let ended = if slope > 0.0 {
            self.at[need] >= self.most[need]
        } else {
            self.at[need] <= 0.0
        };
        // A price at its limit moves no further.
        if ended { 0.0 } else { slope }
    }

    /// Returns true if the newest slope agrees with the mean's.
    fn slopes_agree(&self, met: &[f64]) -> bool {
        let each = met.iter().enumerate();
        each.map(|(need, met)| (1.0 - met) * self.slope(need))
            .sum::<f64>()
            > 0.0
    }

    /// Adds the newest solution with the weight that makes the mean's slope the
    /// shortest.
    fn add_to_mean(&mut self, solution: &Solution, met: &[f64], prices: &[f64]) {
        let (mut down, mut square) = (0.0, 0.0);
        for need in 0..met.len() {
            let (mut mean, mut new) = (1.0 - self.met[need], 1.0 - met[need]);
            if prices[need] >= self.most[need] {
                (mean, new) = (mean.min(0.0), new.min(0.0));
            }
            down += mean * (mean - new);
            square += (mean - new) * (mean - new);
        }
        let best = if square > 0.0 {
            down / square
        } else {
            self.weight
        };
        let weight = best.clamp(self.weight / 10.0, self.weight);
        for mean in &mut self.mean {
            *mean *= 1.0 - weight;
        }
        for choice in &solution.choices {
            self.mean[*choice] += weight;
        }
        for (mean, new) in self.met.iter_mut().zip(met) {
            *mean = *mean * (1.0 - weight) + weight * new;
        }
    }

    /// Choices with a share of at least a twentieth in the mean, the largest
    /// share first.
    pub(super) fn favoured_choices(&self) -> Vec<usize> {
        let mut choices: Vec<usize> = (0..self.mean.len())
            .filter(|choice| self.mean[*choice] > 0.05)
            .collect();
        choices.sort_by(|one, other| {
            let by_mean = self.mean[*other].total_cmp(&self.mean[*one]);
            by_mean.then(one.cmp(other))
        });
        choices
    }

    /// Returns the bound at these prices, in whole cents.
    pub(super) fn bound(&self) -> Bound {
        let prices = self.at.iter().zip(&self.problem.unmet);
        let whole: Vec<i64> = prices
            .map(|(price, unmet)| (price.round() as i64).clamp(0, *unmet))
            .collect();
        bound::compute(self.relaxation, &whole)
    }
}

/// Returns the number of times that each need is met.
fn met(problem: &Problem, solution: &Solution) -> Vec<f64> {
    let mut met = vec![0.0; problem.unmet.len()];
    for choice in &solution.choices {
        met[problem.choices[*choice].need] += 1.0;
    }
    met
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::problem::test_problems::problems;
    use crate::solve::solve;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        // The solver is checked against every assignment in a test of its own.
        #[test]
        fn no_best_assignment_costs_less_nor_has_a_choice_beyond_the_gap(
            problem in problems(),
            steps in 0..200_usize,
        ) {
            let best = solve(&problem);
            let relaxation = Relaxation::new(&problem);
            let mut prices = Prices::new(&relaxation);
            prices.improve(best.cost, steps, &mut WorkLimit::new(1_000_000));
            let found = prices.bound();
            prop_assert!(found.cost <= best.cost, "{} {}", found.cost, best.cost);
            for (need, choice) in best.assignment.iter().enumerate() {
                let reduced = choice.map_or(found.reduced_unmet[need], |choice| found.reduced[choice]);
                prop_assert!(reduced <= best.cost - found.cost);
            }
        }

        #[test]
        fn more_steps_make_the_bound_no_worse(problem in problems(), steps in 0..100_usize) {
            let known = problem.unmet.iter().sum();
            let relaxation = Relaxation::new(&problem);
            let mut prices = Prices::new(&relaxation);
            let mut work = WorkLimit::new(1_000_000);
            prices.improve(known, steps, &mut work);
            let before = prices.cost;
            prices.improve(known, steps, &mut work);
            prop_assert!(prices.cost >= before);
        }
    }
}
