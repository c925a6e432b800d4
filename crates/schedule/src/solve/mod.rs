//! Solves the assignment problem: the best assignment, or a good one with its
//! gap.
//!
//! Lagrangian prices of the needs give a bound and a starting point. The search
//! improves it: needs displace each other, and teams are redirected. A choice
//! whose reduced cost exceeds the gap is in no better assignment. The open
//! choices fall into small parts, which branch and bound solves. Where a part
//! is too large, its neighbourhoods are solved in turn, and the gap is stated.
//!
//! Invariants: the answer is feasible, the bound is below every assignment's
//! cost, and both depend on the problem alone. Work is counted and limited, so
//! that no problem takes much longer than the largest one foreseen.

mod bound;
mod branch_and_bound;
mod chain_moves;
mod ejection_chain;
mod lagrangian;
mod neighbourhood;
mod open;
mod problem;
mod state;
mod subproblem;
mod teams;
mod work_limit;

use bound::Bound;
use lagrangian::Prices;
use open::Open;
use work_limit::WorkLimit;

pub use problem::{Assignment, Choice, Problem, Visit};

/// The most work of a problem, in looks at a choice: fifteen seconds of a
/// processor of 2026 for 8,000 ships.
const MAX_WORK: u64 = 1_200_000_000;
/// Price steps before each search.
const STEPS: usize = 1000;
/// Price steps after the last search.
const LAST_STEPS: usize = 4000;
/// The most rounds of prices and search.
const SEARCHES: usize = 3;
/// Work of branch and bound on a part, in nodes times choices: about a second.
const EFFORT: usize = 300_000;
/// The most rounds over all neighbourhoods.
const ROUNDS: usize = 3;

/// An assignment with its cost and bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Solved {
    /// The choice of each need.
    pub assignment: Assignment,
    /// Cost in cents.
    pub cost: i64,
    /// Lower bound of the cost of any assignment.
    pub bound: i64,
    /// Work done, in looks at a choice.
    pub work: u64,
}

/// Solves a problem.
pub fn solve(problem: &Problem) -> Solved {
    solve_within(problem, MAX_WORK)
}

/// Solves a problem within about `max_work`; less work may leave a wider gap.
/// Prices get a third of it, search another, branch and bound the rest.
pub fn solve_within(problem: &Problem, max_work: u64) -> Solved {
    let (found, bound, mut spent) = search_by_prices(problem, max_work / 3);
    let cost = cost_of(problem, &found);
    let mut work = WorkLimit::new(max_work / 3);
    let (assignment, optimal) = if bound.cost >= cost {
        (found, true)
    } else {
        branch_and_bound(problem, &bound, found, &mut work)
    };
    spent += work.spent();
    let cost = cost_of(problem, &assignment);
    Solved {
        assignment,
        cost,
        bound: if optimal { cost } else { bound.cost },
        work: spent,
    }
}

/// Alternates prices and search; returns an assignment, a bound, and the work
/// of both.
fn search_by_prices(problem: &Problem, max_work: u64) -> (Assignment, Bound, u64) {
    let order = problem.by_need();
    let (mut for_prices, mut work) = (WorkLimit::new(max_work), WorkLimit::new(max_work));
    let nothing = vec![None; problem.unmet.len()];
    let mut found = state::greedy(problem, nothing, &order, &mut work);
    let mut prices = Prices::new(problem);
    let mut bound = prices.bound();
    for _ in 0..SEARCHES {
        let known = cost_of(problem, &found);
        if bound.cost >= known {
            break;
        }
        prices.improve(known, STEPS, &mut for_prices);
        bound = prices.bound();
        let begin = state::take_first_feasible(problem, &prices.favoured_choices());
        let begin = state::greedy(problem, begin, &order, &mut work);
        let next = teams::improve(problem, begin, &order, &bound, &mut work);
        if cost_of(problem, &next) < known {
            found = next;
        }
    }
    // A good assignment is known now, so that the steps aim at the right cost.
    prices.improve(cost_of(problem, &found), LAST_STEPS, &mut for_prices);
    (found, prices.bound(), for_prices.spent() + work.spent())
}

/// Branches on the open choices, and on neighbourhoods of them; returns whether
/// the result is proven optimal.
fn branch_and_bound(
    problem: &Problem,
    bound: &Bound,
    mut found: Assignment,
    work: &mut WorkLimit,
) -> (Assignment, bool) {
    for round in 0..=ROUNDS {
        let open = Open::from_bound(problem, bound, &found, cost_of(problem, &found));
        let finished = branch_and_bound::solve_parts(problem, &open, found, EFFORT, work);
        found = finished.assignment;
        let cost = cost_of(problem, &found);
        if finished.optimal || bound.cost >= cost {
            return (found, true);
        }
        if round == ROUNDS || open.is_enough(round, cost - bound.cost, cost) {
            break;
        }
        found = neighbourhood::improve(problem, &open, found, work);
    }
    (found, false)
}

fn cost_of(problem: &Problem, assignment: &[Option<usize>]) -> i64 {
    problem
        .cost(assignment)
        .expect("search and solver keep within the teams")
}
