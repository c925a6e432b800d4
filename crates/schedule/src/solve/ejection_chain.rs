//! Ejection chains: needs that displace each other.
//!
//! A need displaces another, which displaces a third, and so on, until one
//! finds a free place or stays unmet. If teams were not sent as a whole, this
//! would be the shortest augmenting path of a minimum-cost flow. Where all
//! teams of a day are sent, one with a single job may be redirected. Chains are
//! searched in the order of their cost plus the value of the places they take.
//!
//! Invariants: the assignment stays feasible, and a need is placed at exactly
//! the returned cost.

use super::chain_moves::{Move, apply};
use super::problem::Problem;
use super::state::State;
use super::work_limit::WorkLimit;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The most steps of one search.
const MAX_STEPS: usize = 300_000;
/// Larger than every cost.
const INFINITE: i64 = i64::MAX / 4;

/// Link of a chain to a visit: the need that goes there, and the visit it was
/// displaced from.
#[derive(Clone, Copy)]
struct Link {
    from: Option<usize>,
    need: usize,
    choice: usize,
}

/// Limit of a chain's search.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// Search while the cost plus the value of the places is lower.
    Near,
    /// Search while a free place elsewhere could still pay for it.
    Far,
}

/// The cheapest chains from one need to each visit.
pub(super) struct Chains<'a> {
    /// Each need's choices, the cheapest first.
    order: &'a [Vec<usize>],
    /// Value of a place on each visit.
    worth: &'a [i64],
    cost: Vec<i64>,
    by: Vec<Link>,
    queue: BinaryHeap<Reverse<(i64, usize)>>,
    /// Visits with a cost, to be cleared.
    seen: Vec<usize>,
    /// Number of choices on each visit.
    wanted: Vec<u32>,
    /// Steps of this search.
    steps: usize,
    pub(super) work: &'a mut WorkLimit,
}

/// The best end of a chain so far.
struct End {
    cost: i64,
    at: Option<usize>,
    /// The need left unmet there.
    unmet: Option<usize>,
}

impl End {
    fn offer(&mut self, cost: i64, at: usize, unmet: Option<usize>) {
        if cost < self.cost {
            (self.cost, self.at, self.unmet) = (cost, Some(at), unmet);
        }
    }
}

impl<'a> Chains<'a> {
    pub(super) fn new(
        problem: &Problem,
        order: &'a [Vec<usize>],
        worth: &'a [i64],
        work: &'a mut WorkLimit,
    ) -> Chains<'a> {
        let mut wanted = vec![0; worth.len()];
        for choice in &problem.choices {
            wanted[choice.visit] += 1;
        }
        let none = Link {
            from: None,
            need: 0,
            choice: 0,
        };
        Chains {
            order,
            worth,
            cost: vec![INFINITE; worth.len()],
            by: vec![none; worth.len()],
            queue: BinaryHeap::new(),
            seen: Vec::new(),
            wanted,
            steps: 0,
            work,
        }
    }

    /// Moves a need where a chain from it reduces the total cost.
    pub(super) fn improve(&mut self, state: &mut State<'_>, need: usize, reach: Reach) -> bool {
        let mark = state.mark();
        let mut home = self.worth_of_place(state, need);
        if reach == Reach::Far {
            home = home.max(self.best_free_place(state));
        }
        let saved = state.take(need);
        if self.place(state, need, saved, home).is_some() {
            return true;
        }
        state.undo_to(mark);
        false
    }

    /// Returns the value of the place that a need occupies.
    pub(super) fn worth_of_place(&self, state: &State<'_>, need: usize) -> i64 {
        state.chosen[need].map_or(0, |choice| self.worth[state.problem.choices[choice].visit])
    }

    /// Places an unplaced need if that costs less than `limit`, and returns the
    /// cost with all displaced needs. Capacity freed on the way is worth at
    /// most `capacity`.
    pub(super) fn place(
        &mut self,
        state: &mut State<'_>,
        need: usize,
        limit: i64,
        capacity: i64,
    ) -> Option<i64> {
        let end = self.search(state, need, limit, capacity);
        if end.cost >= limit {
            return None;
        }
        let mut moves: Vec<Move> = Vec::new();
        moves.extend(end.unmet.map(|need| Move { need, choice: None }));
        let mut at = end.at;
        while let Some(visit) = at {
            let link = self.by[visit];
            moves.push(Move {
                need: link.need,
                choice: Some(link.choice),
            });
            at = link.from;
        }
        apply(state, need, &moves, limit)
    }

    /// Returns the largest value, beyond its cost, of a free place that some need could
    /// take.
    fn best_free_place(&mut self, state: &State<'_>) -> i64 {
        self.work.spend(self.worth.len() / 2);
        let worth = |at: usize| {
            let price = state.price_of_place(at)?;
            (self.wanted[at] > state.jobs[at]).then(|| self.worth[at] - price)
        };
        (0..self.worth.len()).filter_map(worth).max().unwrap_or(0)
    }

    fn search(&mut self, state: &State<'_>, need: usize, limit: i64, capacity: i64) -> End {
        for visit in self.seen.drain(..) {
            self.cost[visit] = INFINITE;
        }
        self.queue.clear();
        self.steps = 0;
        let mut end = End {
            cost: limit.min(state.problem.unmet[need]),
            at: None,
            unmet: None,
        };
        self.extend(state, need, None, 0, &mut end, capacity);
        while let Some(Reverse((key, at))) = self.queue.pop() {
            if key >= end.cost.saturating_add(capacity) || self.steps > MAX_STEPS {
                break;
            }
            let cost = self.cost[at];
            if key == cost + self.worth[at] {
                self.arrive(state, at, cost, &mut end, capacity);
            }
        }
        self.work.spend(self.steps);
        end
    }

    /// Ends a chain on a visit, or displaces a need there.
    fn arrive(&mut self, state: &State<'_>, at: usize, cost: i64, end: &mut End, capacity: i64) {
        let problem = state.problem;
        let visit = problem.visits[at];
        for &beside in &state.visits_of[visit.firm_day] {
            self.steps += 1;
            let other = problem.visits[beside];
            let cost = if beside == at {
                cost
            } else if state.has_single(beside) {
                // The team with one job there comes here.
                cost + visit.travel - other.travel
            } else {
                continue;
            };
            for &need in &state.at_visit[beside] {
                let Some(had) = state.chosen[need] else {
                    continue;
                };
                let cost = cost - problem.choices[had].cost;
                end.offer(cost + problem.unmet[need], at, Some(need));
                self.extend(state, need, Some(at), cost, end, capacity);
            }
        }
    }

    /// Extends a chain from a displaced need to all visits where it may go.
    fn extend(
        &mut self,
        state: &State<'_>,
        need: usize,
        from: Option<usize>,
        cost: i64,
        end: &mut End,
        capacity: i64,
    ) {
        let order = self.order;
        for &choice in &order[need] {
            self.steps += 1;
            let to = state.problem.choices[choice];
            let cost = cost + to.cost;
            let most = end.cost.saturating_add(capacity);
            if cost >= most {
                break;
            }
            // A chain ends at a free place, whatever the place is worth.
            let key = cost + self.worth[to.visit];
            let place = state.price_of_place(to.visit);
            let leads = match place {
                Some(price) => cost + price < end.cost,
                None => key < most,
            };
            if !leads || cost >= self.cost[to.visit] || self.has_used_day(state, from, to.visit) {
                continue;
            }
            if self.cost[to.visit] == INFINITE {
                self.seen.push(to.visit);
            }
            self.cost[to.visit] = cost;
            self.by[to.visit] = Link { from, need, choice };
            match place {
                Some(price) => end.offer(cost + price, to.visit, None),
                None => self.queue.push(Reverse((key, to.visit))),
            }
        }
    }

    /// Returns true if a chain has used a visit's day before; it counts on that day's
    /// teams only once.
    fn has_used_day(&mut self, state: &State<'_>, from: Option<usize>, visit: usize) -> bool {
        let day = state.problem.visits[visit].firm_day;
        let mut at = from;
        while let Some(passed) = at {
            self.steps += 1;
            if state.problem.visits[passed].firm_day == day {
                return true;
            }
            at = self.by[passed].from;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::lagrangian::Prices;
    use crate::solve::problem::test_problems::problems;
    use crate::solve::state::greedy;
    use crate::solve::{Choice, Visit};
    use proptest::prelude::*;

    fn visit(firm_day: usize) -> Visit {
        Visit {
            firm_day,
            travel: 0,
            jobs_a_team: 2,
        }
    }

    #[test]
    fn three_needs_change_places_where_no_two_could() {
        let choice = |need, visit, cost| Choice { need, visit, cost };
        let one_job = |firm_day| Visit {
            jobs_a_team: 1,
            ..visit(firm_day)
        };
        let problem = Problem {
            unmet: vec![1_000; 3],
            visits: (0..3).map(one_job).collect(),
            teams: vec![1; 3],
            choices: vec![
                choice(0, 0, 20),
                choice(0, 1, 10),
                choice(1, 1, 20),
                choice(1, 2, 10),
                choice(2, 2, 20),
                choice(2, 0, 10),
            ],
        };
        let mut state = State::new(&problem, vec![Some(0), Some(2), Some(4)]);
        let order = problem.by_need();
        let mut work = WorkLimit::new(1_000);
        assert!(Chains::new(&problem, &order, &[0; 3], &mut work).improve(
            &mut state,
            0,
            Reach::Near
        ));
        assert_eq!(state.chosen, [Some(1), Some(3), Some(5)]);
    }

    #[test]
    fn a_team_with_one_job_is_called_to_another_port() {
        let choice = |need, visit, cost| Choice { need, visit, cost };
        let problem = Problem {
            unmet: vec![1_000, 5_000],
            visits: vec![visit(0), visit(0), visit(1)],
            teams: vec![1, 1],
            choices: vec![choice(0, 0, 10), choice(0, 2, 90), choice(1, 1, 10)],
        };
        let mut state = State::new(&problem, vec![Some(0), None]);
        let order = problem.by_need();
        let mut work = WorkLimit::new(1_000);
        assert!(Chains::new(&problem, &order, &[0; 3], &mut work).improve(
            &mut state,
            1,
            Reach::Near
        ));
        assert_eq!(state.chosen, [Some(1), Some(2)]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_need_is_placed_at_the_returned_cost_or_nothing_changes(problem in problems()) {
            let order = problem.by_need();
            let mut work = WorkLimit::new(1_000_000);
            let begin = greedy(&problem, vec![None; problem.unmet.len()], &order, &mut work);
            let mut prices = Prices::new(&problem);
            prices.improve(problem.cost(&begin).unwrap(), 300, &mut work);
            let worth = prices.bound().worth;
            for worth in [worth.clone(), vec![0; worth.len()]] {
                let mut chains = Chains::new(&problem, &order, &worth, &mut work);
                let mut state = State::new(&problem, begin.clone());
                for need in 0..problem.unmet.len() {
                    let home = chains.worth_of_place(&state, need);
                    state.take(need);
                    let taken = state.chosen.clone();
                    let without = problem.cost(&taken).unwrap() - problem.unmet[need];
                    if let Some(cost) = chains.place(&mut state, need, i64::MAX / 8, home) {
                        prop_assert_eq!(problem.cost(&state.chosen), Some(without + cost));
                    } else {
                        prop_assert_eq!(&state.chosen, &taken);
                    }
                }
            }
        }
    }
}
