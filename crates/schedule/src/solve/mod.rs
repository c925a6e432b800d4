//! The best assignment there is, or a good one and how far from the best it can be.
//!
//! Prices of the needs give a bound, and say which choices they lean to. Search begins with
//! these: needs make way for each other, and teams are sent elsewhere. A choice whose
//! reduced cost is beyond the gap between the two is in no better assignment. What is left
//! falls into small parts, which branch and bound finishes; where one is too large for that,
//! neighbourhoods of it are, each in turn, and the gap is stated.
//!
//! What always holds: the answer is feasible, the bound is below every assignment's
//! cost, and both are the same for the same problem. Work is counted and has a limit, so
//! that no problem takes much longer than the largest that was thought of.

mod bound;
mod chain;
mod days;
mod exact;
mod moves;
mod near;
mod prices;
mod problem;
mod search;
mod teams;
mod work;

use bound::Bound;
use prices::Prices;
use work::Work;

pub use problem::{Assignment, Choice, Problem, Visit};

/// Looks at a choice, or what takes as long, that a problem may take: fifteen seconds of a
/// processor of 2026 for 8,000 ships.
const MOST_WORK: u64 = 1_200_000_000;
/// Steps of the prices before each search.
const STEPS: usize = 1000;
/// Steps of the prices after the last.
const LAST_STEPS: usize = 4000;
/// Prices and searches, at most.
const SEARCHES: usize = 3;
/// Nodes of branch and bound times choices that a part may take: about a second.
const EFFORT: usize = 300_000;
/// The same for a neighbourhood.
const EFFORT_NEAR: usize = 60_000;
/// Needs of a neighbourhood.
const NEIGHBOURS: usize = 60;
/// Open choices of the largest part that is branched on: the relaxation of a larger one takes
/// longer than all else, and there was no better assignment behind it.
const LARGE_PART: usize = 5_000;
/// Rounds over all neighbourhoods, at most.
const ROUNDS: usize = 3;
/// No further round where the gap is this part of the cost, or less: half a per cent.
const SMALL_GAP: i64 = 200;
/// With more open choices than these the neighbourhoods find next to nothing.
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
    /// The work that it took, in looks at a choice.
    pub work: u64,
}

/// Solves a problem.
pub fn solve(problem: &Problem) -> Solved {
    solve_within(problem, MOST_WORK)
}

/// Solves a problem with so much work, and little more: the less, the wider the gap may be.
/// The prices have a third of it, search another, branch and bound the rest.
pub fn solve_within(problem: &Problem, most_work: u64) -> Solved {
    let (found, bound, mut spent) = search_by_prices(problem, most_work / 3);
    let cost = cost_of(problem, &found);
    let mut work = Work::new(most_work / 3);
    let (assignment, optimal) = if bound.cost >= cost {
        (found, true)
    } else {
        branch(problem, &bound, found, &mut work)
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

/// An assignment and a bound by prices and search, in turns, and the work that both took.
fn search_by_prices(problem: &Problem, most_work: u64) -> (Assignment, Bound, u64) {
    let order = problem.by_need();
    let (mut for_prices, mut work) = (Work::new(most_work), Work::new(most_work));
    let nothing = vec![None; problem.unmet.len()];
    let mut found = search::greedy(problem, nothing, &order, &mut work);
    let mut prices = Prices::new(problem);
    let mut bound = prices.bound();
    for _ in 0..SEARCHES {
        let known = cost_of(problem, &found);
        if bound.cost >= known {
            break;
        }
        prices.improve(known, STEPS, &mut for_prices);
        bound = prices.bound();
        let begin = search::take_up(problem, &prices.leanings());
        let begin = search::greedy(problem, begin, &order, &mut work);
        let next = teams::improve(problem, begin, &order, &bound, &mut work);
        if cost_of(problem, &next) < known {
            found = next;
        }
    }
    // Now that a good assignment is known, steps are no longer too long for it.
    prices.improve(cost_of(problem, &found), LAST_STEPS, &mut for_prices);
    (found, prices.bound(), for_prices.spent() + work.spent())
}

/// Branches on what is open, and on neighbourhoods of it; whether what is found is the best.
fn branch(
    problem: &Problem,
    bound: &Bound,
    mut found: Assignment,
    work: &mut Work,
) -> (Assignment, bool) {
    for round in 0..=ROUNDS {
        let open = Open::of(problem, bound, &found, cost_of(problem, &found));
        let finished = exact::finish(problem, &open, found, EFFORT, work);
        found = finished.assignment;
        let cost = cost_of(problem, &found);
        if finished.optimal || bound.cost >= cost {
            return (found, true);
        }
        if round == ROUNDS || open.is_enough(round, cost - bound.cost, cost) {
            break;
        }
        found = near::improve(problem, &open, found, work);
    }
    (found, false)
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
