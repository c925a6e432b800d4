//! Ejection chains: needs that displace each other.
//!
//! A need displaces another from its crew's spell, which displaces a third, and
//! so on, until one finds a free place or stays unmet. Chains are searched in
//! the order of their cost plus the least that the displaced need can cost.
//!
//! Invariant: the teams can do what is assigned, and a need is placed at
//! exactly the returned cost.

use super::problem::{Assignment, Problem};
use super::state::{LOOK, Router, State};
use super::work_limit::WorkLimit;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// The most looks of one search.
const MAX_LOOKS: usize = 20_000;
/// Maximum number of rounds over all needs.
const ROUNDS: usize = 12;

/// The most needs that are displaced at once.
const MAX_DISPLACED: usize = 4;
/// The most choices of a need that are forced.
const MAX_FORCED: usize = 40;

/// Days of a crew that mostly do not matter to each other.
const NEAR_DAYS: i32 = 1;

/// Move of a need in a chain.
#[derive(Clone, Copy)]
struct Move {
    need: usize,
    /// Its new choice; none to leave it unmet.
    choice: Option<usize>,
}

/// Limit of a chain's search.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// Search while the cost plus the price of the displaced need is lower.
    Near,
    /// Search while the displaced need could be cheaper than its price.
    Far,
}

/// Link of a chain: the need that was displaced, by which other need's choice.
#[derive(Clone, Copy)]
struct Link {
    cost: i64,
    by: usize,
    choice: usize,
}

/// Improves an assignment by chains until none makes it cheaper. The prices of the
/// needs guide the search.
pub(super) fn improve(
    router: &Router<'_>,
    begin: &[Option<usize>],
    order: &[Vec<usize>],
    prices: &[i64],
    work: &mut WorkLimit,
) -> Assignment {
    let mut chains = Chains {
        state: State::new(router, begin),
        order,
        prices,
        work,
    };
    for _ in 0..ROUNDS {
        while chains.move_all(Reach::Near) {}
        let far = chains.move_all(Reach::Far);
        let forced = chains.force_all();
        if !far && !forced {
            break;
        }
    }
    chains.state.chosen
}

/// The state under search, and what guides it.
pub(super) struct Chains<'a> {
    pub(super) state: State<'a>,
    /// Each need's choices, the cheapest first.
    pub(super) order: &'a [Vec<usize>],
    /// Price of each need.
    pub(super) prices: &'a [i64],
    pub(super) work: &'a mut WorkLimit,
}

impl Chains<'_> {
    /// Returns true if any need found a cheaper place; false when no work is left. For far
    /// chains the needs come first that cost most beyond their price.
    fn move_all(&mut self, reach: Reach) -> bool {
        let mut moved = false;
        let needs = match reach {
            Reach::Near => (0..self.order.len()).collect(),
            Reach::Far => self.dear_needs(),
        };
        for need in needs {
            if self.work.is_spent() {
                return false;
            }
            moved |= self.improve_one(need, reach);
            self.state.settle();
        }
        moved
    }

    /// Returns the needs that cost more than their price, the dearest first.
    fn dear_needs(&self) -> Vec<usize> {
        let excess = |need: usize| {
            let problem = self.state.problem;
            let choice = self.state.chosen[need];
            let cost = choice.map_or(problem.unmet[need], |choice| problem.choices[choice].cost);
            cost - self.prices[need]
        };
        let mut needs: Vec<usize> = (0..self.order.len())
            .filter(|need| excess(*need) > 0)
            .collect();
        needs.sort_by_key(|need| (Reverse(excess(*need)), *need));
        needs
    }

    /// Gives dear needs a place by displacing several others at once: a team on its way
    /// to a far port leaves out those before and after. Returns true if that is cheaper for
    /// any.
    fn force_all(&mut self) -> bool {
        let mut moved = false;
        for need in self.dear_needs() {
            if self.work.is_spent() {
                return false;
            }
            let order = self.order;
            let mark = self.state.mark();
            let saved = self.state.take(need);
            let choices = order[need].iter().copied();
            let problem = self.state.problem;
            let cheaper = choices.take_while(|choice| problem.choices[*choice].cost < saved);
            let is_placed = cheaper
                .take(MAX_FORCED)
                .any(|choice| self.force(need, choice, saved));
            if !is_placed {
                self.state.undo_to(mark);
            }
            moved |= is_placed;
            self.state.settle();
        }
        moved
    }

    /// Makes a choice for an unplaced need, and places those that it displaces again, if that
    /// costs less than `limit` in all.
    fn force(&mut self, need: usize, choice: usize, limit: i64) -> bool {
        let (problem, router) = (self.state.problem, self.state.router);
        let spell = self.state.spell_around(choice);
        self.work.spend((1 + spell.len()) * LOOK);
        // The dearest to displace stay first.
        let mut others = spell.clone();
        let need_of = |choice: usize| problem.choices[choice].need;
        others.sort_by_key(|other| (Reverse(self.prices[need_of(*other)]), *other));
        let mut kept = vec![choice];
        let mut displaced = Vec::new();
        for other in others {
            let at = kept.partition_point(|kept| *kept < other);
            kept.insert(at, other);
            if router.cost(&kept).0.is_none() {
                kept.remove(at);
                displaced.push(need_of(other));
            }
        }
        if displaced.is_empty() || displaced.len() > MAX_DISPLACED {
            return false;
        }
        let mark = self.state.mark();
        let mut cost = 0;
        for other in &displaced {
            cost -= self.state.take(*other);
        }
        let Some(price) = self.state.put(need, choice) else {
            self.state.undo_to(mark);
            return false;
        };
        cost += price;
        let mut left: i64 = displaced.iter().map(|other| self.floor(*other)).sum();
        for other in displaced {
            left -= self.floor(other);
            let budget = limit - cost - left;
            let Some(price) = self.place(other, budget, Reach::Near) else {
                self.state.undo_to(mark);
                return false;
            };
            cost += price;
        }
        if cost < limit {
            return true;
        }
        self.state.undo_to(mark);
        false
    }

    /// Moves a need where a chain from it reduces the total cost.
    fn improve_one(&mut self, need: usize, reach: Reach) -> bool {
        let mark = self.state.mark();
        let saved = self.state.take(need);
        if self.place(need, saved, reach).is_some() {
            return true;
        }
        self.state.undo_to(mark);
        false
    }

    /// Returns the least that a need costs.
    fn floor(&self, need: usize) -> i64 {
        let problem = self.state.problem;
        let cheapest = self.order[need].first();
        let cheapest = cheapest.map_or(i64::MAX, |choice| problem.choices[*choice].cost);
        cheapest.min(problem.unmet[need])
    }

    /// Places an unplaced need if that costs less than `limit`, and returns the
    /// cost with all displaced needs.
    pub(super) fn place(&mut self, need: usize, limit: i64, reach: Reach) -> Option<i64> {
        let mut search = Search {
            links: BTreeMap::new(),
            queue: BinaryHeap::from([Reverse((self.prices[need], need))]),
            cost: limit,
            last: None,
            looks: 0,
        };
        while let Some(Reverse((key, at))) = search.queue.pop() {
            let so_far = search.links.get(&at).map_or(0, |link| link.cost);
            let is_far = reach == Reach::Near && key >= search.cost;
            if is_far || search.looks > MAX_LOOKS {
                break;
            }
            if key == so_far + self.prices[at] && so_far + self.floor(at) < search.cost {
                self.extend(&mut search, need, at, so_far);
            }
        }
        self.work
            .spend(search.looks * LOOK + self.state.router.work.take());
        apply(&mut self.state, need, &search.links, search.last?, limit)
    }

    /// Extends a chain from a displaced need to all places where it may go.
    fn extend(&self, search: &mut Search, root: usize, at: usize, so_far: i64) {
        let (state, problem) = (&self.state, self.state.problem);
        let unmet = Move {
            need: at,
            choice: None,
        };
        search.offer(so_far + problem.unmet[at], unmet);
        let used = search.used_days(problem, at);
        for &choice in &self.order[at] {
            search.looks += 1;
            let cost = so_far + problem.choices[choice].cost;
            if cost >= search.cost {
                break;
            }
            // The chain counts on what is there only once.
            let day = problem.days[problem.day_of(choice)];
            let mut near = used.iter();
            if near.any(|(crew, date)| *crew == day.crew && (date - day.date).abs() <= NEAR_DAYS) {
                continue;
            }
            let spell = state.spell_around(choice);
            if let Some(price) = state.price_within(&spell, choice, None) {
                let placed = Move {
                    need: at,
                    choice: Some(choice),
                };
                search.offer(so_far + price, placed);
            }
            for &other in &spell {
                let had = problem.choices[other];
                let displaced = had.need;
                // At best the team of the other is no longer sent.
                let least = cost - had.cost - problem.visits[had.visit].travel;
                let is_hopeless = least + self.floor(displaced) >= search.cost;
                if displaced == root || is_hopeless || is_in_chain(&search.links, at, displaced) {
                    continue;
                }
                search.looks += 1;
                let Some(price) = state.price_within(&spell, choice, Some(other)) else {
                    continue;
                };
                let cost = so_far + price - had.cost;
                let known = search.links.get(&displaced);
                if known.is_none_or(|link| cost < link.cost)
                    && cost + self.floor(displaced) < search.cost
                {
                    search.links.insert(
                        displaced,
                        Link {
                            cost,
                            by: at,
                            choice,
                        },
                    );
                    search
                        .queue
                        .push(Reverse((cost + self.prices[displaced], displaced)));
                }
            }
        }
    }
}

/// A search of chains from one need.
struct Search {
    links: BTreeMap<usize, Link>,
    /// Displaced needs, by the cost so far and their price.
    queue: BinaryHeap<Reverse<(i64, usize)>>,
    /// Cost of the best chain.
    cost: i64,
    /// Its last move.
    last: Option<Move>,
    looks: usize,
}

impl Search {
    /// Returns the crews' days that a chain has used on the way to a displaced need.
    fn used_days(&self, problem: &Problem, mut at: usize) -> Vec<(usize, i32)> {
        let mut used = Vec::new();
        while let Some(link) = self
            .links
            .get(&at)
            .filter(|_| used.len() <= self.links.len())
        {
            let day = problem.days[problem.day_of(link.choice)];
            used.push((day.crew, day.date));
            at = link.by;
        }
        used
    }

    fn offer(&mut self, cost: i64, last: Move) {
        if cost < self.cost {
            (self.cost, self.last) = (cost, Some(last));
        }
    }
}

/// Returns true if a need was displaced on the way to another.
fn is_in_chain(links: &BTreeMap<usize, Link>, mut at: usize, need: usize) -> bool {
    let mut passed = BTreeSet::new();
    while passed.insert(at) {
        if at == need {
            return true;
        }
        let Some(link) = links.get(&at) else {
            return false;
        };
        at = link.by;
    }
    // A link on the way was replaced meanwhile: the chain is not one.
    true
}

/// Applies a chain's moves. Applies none if they are not possible together for
/// less than the limit: two of them may meet in one spell.
fn apply(
    state: &mut State<'_>,
    need: usize,
    links: &BTreeMap<usize, Link>,
    last: Move,
    limit: i64,
) -> Option<i64> {
    let mut moves = vec![last];
    let mut at = last.need;
    while at != need {
        let link = links.get(&at)?;
        if moves.len() > links.len() {
            return None;
        }
        moves.push(Move {
            need: link.by,
            choice: Some(link.choice),
        });
        at = link.by;
    }
    let mark = state.mark();
    let mut cost = 0;
    for moved in &moves {
        if moved.need != need {
            cost -= state.take(moved.need);
        }
    }
    for moved in moves {
        let price = match moved.choice {
            Some(choice) => state.put(moved.need, choice),
            None => Some(state.problem.unmet[moved.need]),
        };
        let Some(price) = price else {
            state.undo_to(mark);
            return None;
        };
        cost += price;
    }
    if cost < limit {
        return Some(cost);
    }
    state.undo_to(mark);
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::problem::test_problems::problems;
    use crate::solve::problem::{Choice, Crew, CrewDay, Visit, Window};
    use crate::solve::state::greedy;
    use proptest::prelude::*;

    #[test]
    fn three_needs_change_places_where_no_two_could() {
        let choice = |need, visit, cost| Choice {
            need,
            visit,
            cost,
            window: Window { from: 0, to: 10 },
            length_s: 10,
        };
        let problem = Problem {
            job_s: 10,
            unmet: vec![1_000; 3],
            visits: (0..3)
                .map(|day| Visit {
                    day,
                    place: 0,
                    travel: 0,
                })
                .collect(),
            days: (0..3)
                .map(|crew| CrewDay {
                    crew,
                    date: 0,
                    teams: 1,
                })
                .collect(),
            crews: vec![
                Crew {
                    teams: 1,
                    jobs_a_team: 1,
                    travel_s: vec![vec![0]],
                    taken: Vec::new(),
                };
                3
            ],
            choices: vec![
                choice(0, 0, 20),
                choice(0, 1, 10),
                choice(1, 1, 20),
                choice(1, 2, 10),
                choice(2, 2, 20),
                choice(2, 0, 10),
            ],
        };
        let router = Router::new(&problem);
        let begin = [Some(0), Some(2), Some(4)];
        let mut work = WorkLimit::new(100_000);
        let found = improve(&router, &begin, &problem.by_need(), &[0; 3], &mut work);
        assert_eq!(found, [Some(1), Some(3), Some(5)]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_need_is_placed_at_the_returned_cost_or_nothing_changes(problem in problems()) {
            let order = problem.by_need();
            let router = Router::new(&problem);
            let mut work = WorkLimit::new(1_000_000);
            let begin = greedy(&router, &vec![None; problem.unmet.len()], &order, &mut work);
            let mut chains = Chains {
                state: State::new(&router, &begin),
                order: &order,
                prices: &problem.unmet,
                work: &mut work,
            };
            for need in 0..problem.unmet.len() {
                chains.state.take(need);
                let taken = chains.state.chosen.clone();
                let without = chains.state.cost().unwrap() - problem.unmet[need];
                if let Some(cost) = chains.place(need, i64::MAX / 8, Reach::Far) {
                    prop_assert_eq!(chains.state.cost(), Some(without + cost));
                } else {
                    prop_assert_eq!(&chains.state.chosen, &taken);
                }
            }
        }
    }
}
