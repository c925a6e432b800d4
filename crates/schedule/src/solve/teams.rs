//! Redirects whole teams.
//!
//! No chain of single needs can redirect a team that has several jobs a day. So each visit in
//! turn gets one more team, either a free one or another visit's of that day. The team takes the
//! best jobs there, and chains place its former jobs again.

use super::bound::Bound;
use super::ejection_chain::{Chains, Reach};
use super::problem::{Assignment, Problem};
use super::state::State;
use super::work_limit::WorkLimit;
use std::collections::BTreeSet;

/// Maximum number of rounds over all needs and all visits.
const ROUNDS: usize = 12;

/// Improves an assignment by chains and by teams until neither makes it
/// cheaper.
pub(super) fn improve(
    problem: &Problem,
    begin: Assignment,
    order: &[Vec<usize>],
    bound: &Bound,
    work: &mut WorkLimit,
) -> Assignment {
    let mut teams = Teams {
        chains: Chains::new(problem, order, &bound.worth, work),
        state: State::new(problem, begin),
        of_visit: problem.by_visit(),
        bound,
        order,
    };
    for _ in 0..ROUNDS {
        while teams.chains_from_all(Reach::Near) {}
        let far = teams.chains_from_all(Reach::Far);
        let sent = teams.send_to_all();
        if !far && !sent {
            break;
        }
    }
    teams.state.chosen
}

struct Teams<'a> {
    chains: Chains<'a>,
    state: State<'a>,
    of_visit: Vec<Vec<usize>>,
    bound: &'a Bound,
    order: &'a [Vec<usize>],
}

impl Teams<'_> {
    /// Returns true if any need found a cheaper place; false when no work is
    /// left.
    fn chains_from_all(&mut self, reach: Reach) -> bool {
        let mut moved = false;
        let mut needs: Vec<usize> = (0..self.order.len()).collect();
        if reach == Reach::Far {
            needs.retain(|need| self.excess_cost(*need) > 0);
            needs.sort_by_key(|need| (std::cmp::Reverse(self.excess_cost(*need)), *need));
        }
        for need in needs {
            if self.chains.work.is_spent() {
                return false;
            }
            moved |= self.chains.improve(&mut self.state, need, reach);
            self.state.settle();
        }
        moved
    }

    /// Returns true if any visit got one more team; false when no work is left.
    fn send_to_all(&mut self) -> bool {
        let mut sent = false;
        for visit in 0..self.of_visit.len() {
            if self.chains.work.is_spent() {
                return false;
            }
            sent |= self.send_one_more(visit);
            self.state.settle();
        }
        sent
    }

    fn send_one_more(&mut self, visit: usize) -> bool {
        let problem = self.state.problem;
        let day = problem.visits[visit].firm_day;
        let choices = self.find_best_choices(visit);
        if self.state.sent[day] < problem.teams[day] {
            return self.send(visit, &choices, &[]);
        }
        let others = self.state.visits_of[day].clone();
        others.into_iter().any(|other| {
            let redirected = self.last_load(other);
            other != visit && !redirected.is_empty() && self.send(visit, &choices, &redirected)
        })
    }

    /// Returns the jobs of the team that is least missed on a visit.
    fn last_load(&self, visit: usize) -> Vec<usize> {
        let jobs = self.state.jobs[visit];
        if jobs == 0 {
            return Vec::new();
        }
        let mut needs = self.state.at_visit[visit].clone();
        needs.sort_by_key(|need| (self.excess_cost(*need), *need));
        let load = (jobs - 1) % self.state.problem.visits[visit].jobs_a_team + 1;
        needs.split_off(needs.len() - load as usize)
    }

    /// Excess of a need's choice over the bound.
    fn excess_cost(&self, need: usize) -> i64 {
        self.state.chosen[need].map_or(self.bound.reduced_unmet[need], |choice| {
            self.bound.reduced[choice]
        })
    }

    /// Sends a team to a visit and places its former jobs again, if that is
    /// cheaper in total.
    fn send(&mut self, visit: usize, choices: &[usize], redirected: &[usize]) -> bool {
        let problem = self.state.problem;
        let mark = self.state.mark();
        self.chains.work.spend(choices.len() + redirected.len());
        let (mut cost, mut capacity) = (0, 0);
        for &need in redirected {
            cost -= self.state.take(need);
        }
        for &choice in choices {
            let need = problem.choices[choice].need;
            if !redirected.contains(&need) {
                capacity = capacity.max(self.chains.worth_of_place(&self.state, need));
                cost -= self.state.take(need);
            }
            cost += self.state.put(need, choice);
        }
        let mut displaced = redirected.to_vec();
        displaced.retain(|need| self.state.chosen[*need].is_none());
        let day = problem.visits[visit].firm_day;
        let fits = self.state.sent[day] <= problem.teams[day];
        if fits && self.place_displaced(&displaced, cost, capacity) {
            return true;
        }
        self.state.undo_to(mark);
        false
    }

    /// Returns the choices that gain most on a visit, up to the capacity of a team.
    fn find_best_choices(&mut self, visit: usize) -> Vec<usize> {
        let problem = self.state.problem;
        let mut gains: Vec<(i64, usize)> = Vec::new();
        self.chains.work.spend(self.of_visit[visit].len());
        for &choice in &self.of_visit[visit] {
            let to = problem.choices[choice];
            let had = self.state.chosen[to.need].map(|had| problem.choices[had]);
            let gain = to.cost - had.map_or(problem.unmet[to.need], |had| had.cost);
            if gain < 0 && had.is_none_or(|had| had.visit != visit) {
                gains.push((gain, choice));
            }
        }
        gains.sort_unstable();
        let most = problem.visits[visit].jobs_a_team as usize;
        // Of two choices of one need on a visit, the cheaper.
        let mut needs = BTreeSet::new();
        let choices = gains.into_iter().map(|(_, choice)| choice);
        choices
            .filter(|choice| needs.insert(problem.choices[*choice].need))
            .take(most)
            .collect()
    }

    /// Places needs one after the other; true if `cost` plus their costs is
    /// negative.
    fn place_displaced(&mut self, displaced: &[usize], mut cost: i64, capacity: i64) -> bool {
        let mut left: i64 = displaced.iter().map(|need| self.min_cost(*need)).sum();
        for &need in displaced {
            left -= self.min_cost(need);
            let limit = -cost - left;
            match self.chains.place(&mut self.state, need, limit, capacity) {
                Some(placed) => cost += placed,
                None => return false,
            }
        }
        cost < 0
    }

    /// Returns the cost of a need with the first choice of all teams.
    fn min_cost(&self, need: usize) -> i64 {
        let problem = self.state.problem;
        let cheapest = self.order[need].first();
        let cheapest = cheapest.map_or(i64::MAX, |choice| problem.choices[*choice].cost);
        cheapest.min(problem.unmet[need])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::lagrangian::Prices;
    use crate::solve::problem::test_problems::problems;
    use crate::solve::state::greedy;
    use crate::solve::{Choice, Visit, bound};
    use proptest::prelude::*;

    #[test]
    fn a_team_with_two_jobs_is_called_away_for_one_that_has_no_other() {
        let visit = |firm_day| Visit {
            firm_day,
            travel: 100,
            jobs_a_team: 2,
        };
        let choice = |need, visit, cost| Choice { need, visit, cost };
        let problem = Problem {
            unmet: vec![5_000, 5_000, 9_000],
            visits: vec![visit(0), visit(0), visit(1)],
            teams: vec![1, 1],
            choices: vec![
                choice(0, 0, 100),
                choice(1, 0, 100),
                choice(2, 1, 100),
                choice(0, 2, 300),
                choice(1, 2, 300),
            ],
        };
        let begin = vec![Some(0), Some(1), None];
        let order = problem.by_need();
        let bound = bound::compute(&problem, &[5_000, 5_000, 9_000]);
        let found = improve(&problem, begin, &order, &bound, &mut WorkLimit::new(10_000));
        assert_eq!(found, [Some(3), Some(4), Some(2)]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_result_is_feasible_and_no_more_expensive_than_the_start(problem in problems()) {
            let order = problem.by_need();
            let nothing = vec![None; problem.unmet.len()];
            let mut work = WorkLimit::new(1_000_000);
            for begin in [nothing.clone(), greedy(&problem, nothing, &order, &mut work)] {
                let before = problem.cost(&begin).unwrap();
                let mut prices = Prices::new(&problem);
                for steps in [0, 10, 300] {
                    prices.improve(before, steps, &mut work);
                    let bound = prices.bound();
                    let found = improve(&problem, begin.clone(), &order, &bound, &mut work);
                    let after = problem.cost(&found);
                    prop_assert!(after.is_some_and(|after| after <= before), "{after:?} {before}");
                    prop_assert!(after.is_some_and(|after| after >= bound.cost));
                }
            }
        }
    }
}
