//! What no assignment can cost less than, and what each choice costs beyond it.
//!
//! The linear relaxation has, for each visit, how many teams are sent (y): no job
//! without a team (x ≤ y), no more jobs than the teams do (Σx ≤ k·y), no more teams
//! than the firm has that day. Its dual is solved, for what is wanted are prices: π of
//! a need, μ of a firm's day, α and β of a visit's two kinds of row.
//!
//! What always holds: the bound is right whatever the solver answered. Its prices are
//! rounded to cents, made feasible, and the bound added up from them in whole numbers
//! (weak duality), so that a wrong price makes the bound worse, never false.

use super::problem::{Problem, Visit};
use microlp::{ComparisonOp, LinearExpr, OptimizationDirection, Variable};

/// A lower bound, and each choice's reduced cost against it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Bound {
    /// No assignment costs less.
    pub(super) cost: i64,
    /// An assignment with this choice costs at least so much more than the bound.
    pub(super) reduced: Vec<i64>,
    /// What one more job's place on each visit is worth at these prices; it guides search
    /// and proves nothing.
    pub(super) worth: Vec<i64>,
    /// One that leaves this need unmet, too.
    pub(super) reduced_unmet: Vec<i64>,
}

/// The prices, in cents.
struct Prices {
    /// Of a firm's day.
    mu: Vec<i64>,
    /// Of a visit's room.
    beta: Vec<i64>,
    /// Of a choice's "no job without a team".
    alpha: Vec<i64>,
}

/// The bound by the relaxation's prices; by no prices at all where the solver fails.
pub(super) fn bound(problem: &Problem) -> Bound {
    let shared = shared_visits(problem);
    let mut prices = solve(problem, &shared).unwrap_or_else(|| Prices {
        mu: vec![0; problem.teams.len()],
        beta: vec![0; problem.visits.len()],
        alpha: vec![0; problem.choices.len()],
    });
    make_feasible(problem, &shared, &mut prices);
    add_up(problem, &shared, &prices)
}

/// Whether several jobs may share a team's travel on a visit.
fn shared_visits(problem: &Problem) -> Vec<bool> {
    let of = problem.by_visit();
    let visits = problem.visits.iter().zip(&of);
    visits
        .map(|(visit, choices)| visit.jobs_a_team > 1 && choices.len() > 1)
        .collect()
}

/// What the solver says; in euros there, so that numbers are of a like size.
fn solve(problem: &Problem, shared: &[bool]) -> Option<Prices> {
    const CENTS: f64 = 100.0;
    let mut dual = microlp::Problem::new(OptimizationDirection::Maximize);
    let pi: Vec<Variable> = problem
        .unmet
        .iter()
        .map(|unmet| dual.add_var(1.0, (0.0, *unmet as f64 / CENTS)))
        .collect();
    let mu: Vec<Variable> = problem
        .teams
        .iter()
        .map(|teams| dual.add_var(-f64::from(*teams), (0.0, f64::INFINITY)))
        .collect();
    let beta: Vec<Option<Variable>> = shared
        .iter()
        .map(|shared| shared.then(|| dual.add_var(0.0, (0.0, f64::INFINITY))))
        .collect();
    let mut alpha = vec![None; problem.choices.len()];
    let mut team: Vec<LinearExpr> = vec![LinearExpr::empty(); problem.visits.len()];
    for (index, choice) in problem.choices.iter().enumerate() {
        let visit = problem.visits[choice.visit];
        let mut row = LinearExpr::empty();
        row.add(pi[choice.need], 1.0);
        if let Some(beta) = beta[choice.visit] {
            let own = dual.add_var(0.0, (0.0, f64::INFINITY));
            alpha[index] = Some(own);
            team[choice.visit].add(own, 1.0);
            row.add(own, -1.0);
            row.add(beta, -1.0);
            dual.add_constraint(row, ComparisonOp::Le, choice.cost as f64 / CENTS);
        } else {
            row.add(mu[visit.firm_day], -1.0);
            let cost = (choice.cost + visit.travel) as f64 / CENTS;
            dual.add_constraint(row, ComparisonOp::Le, cost);
        }
    }
    for ((visit, row), beta) in problem.visits.iter().zip(team).zip(&beta) {
        let Some(beta) = *beta else { continue };
        let mut row = row;
        row.add(beta, f64::from(visit.jobs_a_team));
        row.add(mu[visit.firm_day], -1.0);
        dual.add_constraint(row, ComparisonOp::Le, visit.travel as f64 / CENTS);
    }
    let solved = dual.solve().ok()?.into_solution().ok()?;
    let cents =
        |variable: Variable| (solved.var_value_raw(variable).max(0.0) * CENTS).round() as i64;
    let each = |variables: &[Option<Variable>]| -> Vec<i64> {
        variables.iter().map(|v| v.map_or(0, cents)).collect()
    };
    Some(Prices {
        mu: mu.iter().map(|variable| cents(*variable)).collect(),
        beta: each(&beta),
        alpha: each(&alpha),
    })
}

/// Raises a firm's day's price where rounding left a visit's row too dear.
fn make_feasible(problem: &Problem, shared: &[bool], prices: &mut Prices) {
    let mut due: Vec<i64> = vec![0; problem.visits.len()];
    for (choice, alpha) in problem.choices.iter().zip(&prices.alpha) {
        due[choice.visit] += alpha;
    }
    for (index, visit) in problem.visits.iter().enumerate() {
        if shared[index] {
            let asked = due[index] + i64::from(visit.jobs_a_team) * prices.beta[index];
            let mu = &mut prices.mu[visit.firm_day];
            *mu = (*mu).max(asked - visit.travel);
        }
    }
}

fn add_up(problem: &Problem, shared: &[bool], prices: &Prices) -> Bound {
    let dear: Vec<i64> = problem
        .choices
        .iter()
        .enumerate()
        .map(|(index, choice)| {
            let visit = problem.visits[choice.visit];
            if shared[choice.visit] {
                choice.cost + prices.alpha[index] + prices.beta[choice.visit]
            } else {
                choice.cost + visit.travel + prices.mu[visit.firm_day]
            }
        })
        .collect();
    let mut pi = problem.unmet.clone();
    for (choice, dear) in problem.choices.iter().zip(&dear) {
        let pi = &mut pi[choice.need];
        *pi = (*pi).min(*dear);
    }
    let days: i64 = problem
        .teams
        .iter()
        .zip(&prices.mu)
        .map(|(teams, mu)| i64::from(*teams) * mu)
        .sum();
    let worth =
        |visit: &Visit| (visit.travel + prices.mu[visit.firm_day]) / i64::from(visit.jobs_a_team);
    Bound {
        worth: problem.visits.iter().map(worth).collect(),
        cost: pi.iter().sum::<i64>() - days,
        reduced: problem
            .choices
            .iter()
            .zip(&dear)
            .map(|(choice, dear)| dear - pi[choice.need])
            .collect(),
        reduced_unmet: problem
            .unmet
            .iter()
            .zip(&pi)
            .map(|(unmet, pi)| unmet - pi)
            .collect(),
    }
}
