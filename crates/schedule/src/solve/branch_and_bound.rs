//! Branch and bound on the choices that the bound leaves open, as mixed-integer
//! models of independent parts.
//!
//! Invariants: the returned assignment is feasible and no worse than the given
//! one. It is called optimal only where the solver finished its proof on every
//! part. Work is counted in nodes and pivots, not in seconds, so that the same
//! problem has the same answer. The work of one relaxation is known only
//! afterwards, and bounded by its part's size.

use super::open::Open;
use super::problem::{Assignment, Problem};
use super::work_limit::WorkLimit;
use microlp::{
    ComparisonOp, LinearExpr, OptimizationDirection, SolveOptions, TerminationReason, Variable,
};
use std::collections::BTreeMap;

/// The most open choices of a part for branch and bound. The relaxation of a
/// larger one takes longer than everything else, and never led to a better
/// assignment.
const LARGE_PART: usize = 5_000;
/// Work of a simplex step per choice.
const PIVOT: usize = 2;

/// The result of branch and bound.
pub(super) struct Outcome {
    pub(super) assignment: Assignment,
    /// True if no other assignment of these choices is cheaper.
    pub(super) optimal: bool,
}

/// Finds the cheapest assignment within `open`, for each part of choices that
/// share no need and no firm's day. A part of many choices may take fewer
/// nodes, and one that is too large none: `effort` is nodes times choices.
pub(super) fn solve_parts(
    problem: &Problem,
    open: &Open,
    known: Assignment,
    effort: usize,
    work: &mut WorkLimit,
) -> Outcome {
    work.spend(2 * problem.choices.len());
    let mut assignment = known;
    let mut optimal = true;
    for part in parts(problem, &open.choices) {
        // A part is settled if each need has one choice, which is made, and
        // none may stay unmet.
        let is_settled = |index: &usize| {
            let need = problem.choices[*index].need;
            assignment[need] == Some(*index) && !open.unmet[need]
        };
        if part.iter().all(is_settled) {
            continue;
        }
        if part.len() > LARGE_PART || work.is_spent() {
            optimal = false;
            continue;
        }
        let nodes = (effort / part.len().max(1)).max(1) as u64;
        let Some((found, proven)) = solve_part(problem, &part, &assignment, nodes, work) else {
            optimal = false;
            continue;
        };
        optimal &= proven;
        // No other part shares a firm's day with this one.
        let known = found.iter().map(|(need, _)| (*need, assignment[*need]));
        let known = problem.cost_of(known);
        let is_cheaper = match (problem.cost_of(found.iter().copied()), known) {
            (Some(new), Some(old)) => new < old,
            (new, _) => new.is_some(),
        };
        if is_cheaper {
            for (need, choice) in found {
                assignment[need] = choice;
            }
        }
    }
    Outcome {
        assignment,
        optimal,
    }
}

/// Splits the open choices into independent parts.
fn parts(problem: &Problem, open: &[bool]) -> Vec<Vec<usize>> {
    let needs = problem.unmet.len();
    let mut leader: Vec<usize> = (0..needs + problem.teams.len()).collect();
    for (choice, open) in problem.choices.iter().zip(open) {
        if *open {
            let day = needs + problem.visits[choice.visit].firm_day;
            let (one, other) = (find(&mut leader, choice.need), find(&mut leader, day));
            leader[one.max(other)] = one.min(other);
        }
    }
    let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (index, choice) in problem.choices.iter().enumerate() {
        if open[index] {
            parts
                .entry(find(&mut leader, choice.need))
                .or_default()
                .push(index);
        }
    }
    parts.into_values().collect()
}

fn find(leader: &mut [usize], mut of: usize) -> usize {
    while leader[of] != of {
        leader[of] = leader[leader[of]];
        of = leader[of];
    }
    of
}

type Assigned = Vec<(usize, Option<usize>)>;

/// Solves one part: its best choices and whether they are proven optimal;
/// `None` without a solution.
fn solve_part(
    problem: &Problem,
    part: &[usize],
    known: &[Option<usize>],
    nodes: u64,
    work: &mut WorkLimit,
) -> Option<(Assigned, bool)> {
    const CENTS: f64 = 100.0;
    let mut model = microlp::Problem::new(OptimizationDirection::Minimize);
    let mut warm: Vec<(Variable, f64)> = Vec::new();
    let mut of_need: BTreeMap<usize, Vec<(Variable, usize)>> = BTreeMap::new();
    let mut of_visit: BTreeMap<usize, Vec<Variable>> = BTreeMap::new();
    let mut going: BTreeMap<usize, u32> = BTreeMap::new();
    for &index in part {
        let choice = problem.choices[index];
        // A choice is worth its saving against leaving the need unmet.
        let worth = (choice.cost - problem.unmet[choice.need]) as f64 / CENTS;
        let x = model.add_binary_var(worth);
        let made = known[choice.need] == Some(index);
        warm.push((x, f64::from(u8::from(made))));
        *going.entry(choice.visit).or_default() += u32::from(made);
        of_need.entry(choice.need).or_default().push((x, index));
        of_visit.entry(choice.visit).or_default().push(x);
    }
    let mut of_day: BTreeMap<usize, LinearExpr> = BTreeMap::new();
    for (&at, jobs) in &of_visit {
        let visit = problem.visits[at];
        let most = problem.teams[visit.firm_day]
            .min(jobs.len() as u32)
            .cast_signed();
        let y = model.add_integer_var(visit.travel as f64 / CENTS, (0, most));
        warm.push((y, f64::from(going[&at].div_ceil(visit.jobs_a_team))));
        let mut capacity = LinearExpr::empty();
        capacity.add(y, -f64::from(visit.jobs_a_team));
        for &x in jobs {
            capacity.add(x, 1.0);
            if visit.jobs_a_team > 1 {
                model.add_constraint([(x, 1.0), (y, -1.0)], ComparisonOp::Le, 0.0);
            }
        }
        model.add_constraint(capacity, ComparisonOp::Le, 0.0);
        of_day
            .entry(visit.firm_day)
            .or_insert_with(LinearExpr::empty)
            .add(y, 1.0);
    }
    for choices in of_need.values() {
        let row: Vec<(Variable, f64)> = choices.iter().map(|(x, _)| (*x, 1.0)).collect();
        model.add_constraint(row, ComparisonOp::Le, 1.0);
    }
    for (day, sent) in of_day {
        model.add_constraint(sent, ComparisonOp::Le, f64::from(problem.teams[day]));
    }
    let mut options = SolveOptions::default();
    options.node_limit = Some(nodes);
    options.warm_start = Some(warm);
    let solved = model.solve_with(options).ok()?;
    let pivots = usize::try_from(solved.stats().lp_iterations).unwrap_or(usize::MAX);
    work.spend(pivots.saturating_mul(PIVOT * part.len()));
    let solved = solved.into_solution().ok()?;
    let proven = solved.termination_reason() == TerminationReason::ProvenOptimal;
    let found = of_need
        .into_iter()
        .map(|(need, choices)| {
            let made = choices.iter().find(|(x, _)| solved.var_value(*x) > 0.5);
            (need, made.map(|(_, index)| *index))
        })
        .collect();
    Some((found, proven))
}
