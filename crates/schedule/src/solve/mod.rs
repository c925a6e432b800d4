//! The best assignment there is, or a good one and how far from the best it can be.
//!
//! Prices give a bound: the linear relaxation's, or for a problem that is too large for it
//! those of a subgradient. Search, which these prices guide, gives an assignment: needs
//! make way for each other, and teams are sent elsewhere. A choice whose reduced cost is
//! beyond the gap between the two is in no better assignment. What is left falls into
//! small parts, which branch and bound finishes; where one is too large for that,
//! neighbourhoods of it are, each in turn, and the gap is stated.
//!
//! What always holds: the answer is feasible, the bound is below every assignment's
//! cost, and both are the same for the same problem.

mod bound;
mod chain;
mod exact;
mod near;
mod prices;
mod problem;
mod search;
mod teams;

use bound::Bound;

pub use problem::{Assignment, Choice, Problem, Visit};

/// Nodes of branch and bound times choices that a part may take: about a second.
const EFFORT: usize = 300_000;
/// The same for a neighbourhood.
const EFFORT_NEAR: usize = 60_000;
/// Needs of a neighbourhood.
const NEIGHBOURS: usize = 60;
/// With more choices than these the linear relaxation alone takes minutes.
const LARGE: usize = 20_000;
/// Open choices of the largest part that is branched on: the relaxation of a larger one takes
/// longer than all else, and there was no better assignment behind it.
const LARGE_PART: usize = 15_000;
/// Rounds over all neighbourhoods, at most.
const ROUNDS: usize = 3;
/// No further round where the gap is this part of the cost, or less: half a per cent.
const SMALL_GAP: i64 = 200;
/// With more open choices than these the neighbourhoods take minutes.
const MANY_OPEN: usize = 5_000;
/// None with so many, where the gap is this part of the cost, or less: one per cent.
const SMALL_GAP_OF_MANY: i64 = 100;

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
    let mut found = search::greedy(problem, begin, &order);
    let large = problem.choices.len() > LARGE;
    let bound = if large {
        prices::bound(problem, cost_of(problem, &found))
    } else {
        bound::bound(problem)
    };
    found = teams::improve(problem, found, &order, &bound);
    for round in 0..=ROUNDS {
        let cost = cost_of(problem, &found);
        if bound.cost >= cost {
            return Solved {
                assignment: found,
                cost,
                bound: cost,
            };
        }
        let open = Open::of(problem, &bound, &found, cost);
        let finished = exact::finish(problem, &open, found, EFFORT);
        found = finished.assignment;
        if finished.optimal {
            let cost = cost_of(problem, &found);
            return Solved {
                assignment: found,
                cost,
                bound: cost,
            };
        }
        let cost = cost_of(problem, &found);
        if round == ROUNDS || open.is_enough(round, cost - bound.cost, cost) {
            break;
        }
        found = near::improve(problem, &open, found);
    }
    let cost = cost_of(problem, &found);
    Solved {
        assignment: found,
        cost,
        bound: bound.cost,
    }
}

/// What a better assignment may have.
struct Open {
    /// Each choice, those of the assignment in hand among them.
    choices: Vec<bool>,
    /// Whether each need may be left unmet.
    unmet: Vec<bool>,
}

impl Open {
    /// Whether the gap is too small for a round over the neighbourhoods. A small problem has
    /// one in any case, for it may be proven by it.
    fn is_enough(&self, round: usize, gap: i64, cost: i64) -> bool {
        let many = self.choices.iter().filter(|open| **open).count() > MANY_OPEN;
        if many {
            gap * SMALL_GAP_OF_MANY <= cost
        } else {
            round > 0 && gap * SMALL_GAP <= cost
        }
    }

    fn of(problem: &Problem, bound: &Bound, found: &[Option<usize>], cost: i64) -> Open {
        let gap = cost - bound.cost;
        let choices = problem.choices.iter().zip(&bound.reduced).enumerate();
        Open {
            choices: choices
                .map(|(index, (choice, reduced))| {
                    *reduced < gap || found[choice.need] == Some(index)
                })
                .collect(),
            unmet: bound.reduced_unmet.iter().map(|it| *it < gap).collect(),
        }
    }
}

fn cost_of(problem: &Problem, assignment: &[Option<usize>]) -> i64 {
    problem
        .cost(assignment)
        .expect("search and solver keep within the teams")
}
