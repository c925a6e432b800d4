//! Solves the assignment problem: the best assignment, or a good one with its
//! gap.
//!
//! Teams are followed by the watch: what a crew does on days near each other is
//! a spell, and the oracle `routes` says whether its teams can do it, and at
//! what travel. The bound lets teams go from day to day only (`relaxation`):
//! that is never dearer. Lagrangian prices of the needs give it and a starting point. The
//! search improves that: needs displace each other. A choice whose reduced cost
//! exceeds the gap is in no better assignment. The open choices fall into small
//! parts, which branch and bound solves; what it counts and the oracle refutes
//! becomes a cut. Where a part is too large, its neighbourhoods are solved in
//! turn, and the gap is stated.
//!
//! Invariants: the answer can be done, the bound is below every assignment's
//! cost, and both depend on the problem alone. Work is counted and limited, so
//! that no problem takes much longer than the largest one foreseen.

mod bound;
mod branch_and_bound;
mod chains;
mod flow;
mod lagrangian;
mod neighbourhood;
mod open;
mod problem;
mod relaxation;
mod routes;
mod state;
mod subproblem;
mod timetable;
mod work_limit;

use bound::Bound;
use branch_and_bound::Models;
use lagrangian::Prices;
use open::Open;
use relaxation::Relaxation;
use state::{Router, State};
use work_limit::WorkLimit;

pub use problem::{Assignment, Choice, Crew, CrewDay, Problem, TakenHours, Visit, Window};
pub use timetable::{Appointment, Room, Wanted, timetable};

/// The most work of a problem, in looks at a choice: forty seconds of a
/// processor of 2026.
const MAX_WORK: u64 = 3_600_000_000;
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
    let relaxation = Relaxation::new(problem);
    let router = Router::new(problem);
    let (found, bound, mut spent) = search_by_prices(&relaxation, &router, max_work / 3);
    let mut work = WorkLimit::new(max_work / 3);
    let (assignment, optimal) = if bound.cost >= cost_of(&router, &found) {
        (found, true)
    } else {
        let mut models = Models::new(&relaxation, &router);
        branch_and_bound(&mut models, &bound, found, &mut work)
    };
    spent += work.spent();
    let cost = cost_of(&router, &assignment);
    Solved {
        assignment,
        cost,
        bound: if optimal { cost } else { bound.cost },
        work: spent,
    }
}

/// Takes each choice in the order of the list, if its need has none yet and the teams can do
/// it beside those before.
pub fn take_in_order(problem: &Problem) -> Assignment {
    let choices: Vec<usize> = (0..problem.choices.len()).collect();
    state::take_first_feasible(&Router::new(problem), &choices)
}

/// Alternates prices and search; returns an assignment, a bound, and the work
/// of both.
fn search_by_prices(
    relaxation: &Relaxation<'_>,
    router: &Router<'_>,
    max_work: u64,
) -> (Assignment, Bound, u64) {
    let problem = relaxation.problem;
    let order = problem.by_need();
    let (mut for_prices, mut work) = (WorkLimit::new(max_work), WorkLimit::new(max_work));
    let nothing = vec![None; problem.unmet.len()];
    let mut found = state::greedy(router, &nothing, &order, &mut work);
    let mut prices = Prices::new(relaxation);
    let mut bound = prices.bound();
    for _ in 0..SEARCHES {
        let known = cost_of(router, &found);
        if bound.cost >= known {
            break;
        }
        prices.improve(known, STEPS, &mut for_prices);
        bound = prices.bound();
        let begin = state::take_first_feasible(router, &prices.favoured_choices());
        let begin = state::greedy(router, &begin, &order, &mut work);
        let next = chains::improve(router, &begin, &order, &bound.prices, &mut work);
        if cost_of(router, &next) < known {
            found = next;
        }
    }
    // A good assignment is known now, so that the steps aim at the right cost.
    prices.improve(cost_of(router, &found), LAST_STEPS, &mut for_prices);
    (found, prices.bound(), for_prices.spent() + work.spent())
}

/// Branches on the open choices, and on neighbourhoods of them; returns whether
/// the result is proven optimal.
fn branch_and_bound(
    models: &mut Models<'_>,
    bound: &Bound,
    mut found: Assignment,
    work: &mut WorkLimit,
) -> (Assignment, bool) {
    for round in 0..=ROUNDS {
        let cost = cost_of(models.router, &found);
        let open = Open::from_bound(models.relaxation.problem, bound, &found, cost);
        let finished = models.solve_parts(&open, &found, EFFORT, work);
        found = finished.assignment;
        let cost = cost_of(models.router, &found);
        if finished.optimal || bound.cost >= cost {
            return (found, true);
        }
        if round == ROUNDS || open.is_enough(round, cost - bound.cost, cost) {
            break;
        }
        found = neighbourhood::improve(models, &open, found, work);
    }
    (found, false)
}

/// Returns the cost of an assignment of the search; larger than every other's where
/// the search for its routes was given up.
fn cost_of(router: &Router<'_>, assignment: &[Option<usize>]) -> i64 {
    State::new(router, assignment)
        .cost()
        .unwrap_or(i64::MAX / 4)
}
