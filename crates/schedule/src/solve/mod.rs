//! The best assignment there is, or a good one and how far from the best it can be.
//!
//! Search gives an assignment, the linear relaxation's prices give a bound; a choice
//! whose reduced cost is beyond the gap between them is in no better assignment. What
//! is left falls into small parts, which branch and bound finishes.
//!
//! What always holds: the answer is feasible, the bound is below every assignment's
//! cost, and both are the same for the same problem.

mod bound;
mod exact;
mod problem;
mod search;

pub use problem::{Assignment, Choice, Problem, Visit};

/// Nodes of branch and bound times choices that a part may take: some seconds.
const EFFORT: usize = 1_000_000;

/// An assignment, and what is known of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Solved {
    /// For each need, its choice.
    pub assignment: Assignment,
    /// What it costs, in cents.
    pub cost: i64,
    /// What no assignment can cost less than.
    pub bound: i64,
}

/// Solves a problem.
pub fn solve(problem: &Problem) -> Solved {
    let order = problem.by_need();
    let begin = vec![None; problem.unmet.len()];
    let found = search::improve(problem, begin, &order);
    let mut cost = cost_of(problem, &found);
    let bound = bound::bound(problem);
    if bound.cost >= cost {
        return Solved {
            assignment: found,
            cost,
            bound: cost,
        };
    }
    let gap = cost - bound.cost;
    let open: Vec<bool> = bound
        .reduced
        .iter()
        .enumerate()
        .map(|(index, reduced)| *reduced < gap || found[problem.choices[index].need] == Some(index))
        .collect();
    let finished = exact::finish(problem, &open, found, EFFORT);
    cost = cost_of(problem, &finished.assignment);
    let proven = if finished.optimal { cost } else { bound.cost };
    Solved {
        assignment: finished.assignment,
        cost,
        bound: proven,
    }
}

fn cost_of(problem: &Problem, assignment: &[Option<usize>]) -> i64 {
    problem
        .cost(assignment)
        .expect("search and solver keep within the teams")
}
