//! The assignment problem in numbers only, without names.
//!
//! Callers ensure that a [`Problem`] has every index within its list, no
//! negative cost, and capacity for at least one job on each visit. Costs are
//! whole cents, so that sums are exact and a bound can be rounded.

use std::collections::BTreeMap;

/// One way to meet one need: a visit and a cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Index of the need.
    pub need: usize,
    /// Index of the visit.
    pub visit: usize,
    /// Cost without the visit's travel.
    pub cost: i64,
}

/// A firm's presence in one port on one day.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Index of the firm and day.
    pub firm_day: usize,
    /// Cost of sending one team.
    pub travel: i64,
    /// Jobs per team and day there.
    pub jobs_a_team: u32,
}

/// The problem: at most one choice for each need, within the teams of each firm
/// and day.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problem {
    /// Cost of leaving each need unmet.
    pub unmet: Vec<i64>,
    /// All choices.
    pub choices: Vec<Choice>,
    /// All visits that a choice may ask for.
    pub visits: Vec<Visit>,
    /// Number of teams for each firm and day.
    pub teams: Vec<u32>,
}

/// The index of the choice for each need, or none.
pub type Assignment = Vec<Option<usize>>;

impl Problem {
    /// Returns the cost of an assignment; `None` when it needs more teams than
    /// there are.
    pub fn cost(&self, assignment: &[Option<usize>]) -> Option<i64> {
        self.cost_of(assignment.iter().copied().enumerate())
    }

    /// Returns the cost of some needs with these choices, as if there were no others.
    pub(super) fn cost_of(
        &self,
        choices: impl Iterator<Item = (usize, Option<usize>)>,
    ) -> Option<i64> {
        let mut cost = 0;
        let mut jobs: BTreeMap<usize, u32> = BTreeMap::new();
        for (need, choice) in choices {
            let Some(choice) = choice.map(|index| self.choices[index]) else {
                cost += self.unmet[need];
                continue;
            };
            cost += choice.cost;
            *jobs.entry(choice.visit).or_default() += 1;
        }
        let mut sent: BTreeMap<usize, u32> = BTreeMap::new();
        for (visit, jobs) in jobs {
            let visit = self.visits[visit];
            let teams = jobs.div_ceil(visit.jobs_a_team);
            cost += i64::from(teams) * visit.travel;
            *sent.entry(visit.firm_day).or_default() += teams;
        }
        let within = sent
            .iter()
            .all(|(firm_day, sent)| *sent <= self.teams[*firm_day]);
        within.then_some(cost)
    }

    /// Indices of each need's choices, the cheapest first.
    pub(super) fn by_need(&self) -> Vec<Vec<usize>> {
        let mut of = vec![Vec::new(); self.unmet.len()];
        for (index, choice) in self.choices.iter().enumerate() {
            of[choice.need].push(index);
        }
        for choices in &mut of {
            choices.sort_by_key(|index| (self.choices[*index].cost, *index));
        }
        of
    }

    /// Indices of each visit's choices.
    pub(super) fn by_visit(&self) -> Vec<Vec<usize>> {
        let mut of = vec![Vec::new(); self.visits.len()];
        for (index, choice) in self.choices.iter().enumerate() {
            of[choice.visit].push(index);
        }
        of
    }

    /// Indices of each firm's day's visits.
    pub(super) fn by_day(&self) -> Vec<Vec<usize>> {
        let mut of = vec![Vec::new(); self.teams.len()];
        for (index, visit) in self.visits.iter().enumerate() {
            of[visit.firm_day].push(index);
        }
        of
    }
}

/// Small problems for tests.
#[cfg(test)]
pub(super) mod test_problems {
    use super::{Choice, Problem, Visit};
    use proptest::collection::vec;
    use proptest::prelude::*;

    pub(in crate::solve) fn problems() -> impl Strategy<Value = Problem> {
        let visits = vec((0..4_usize, 0..900_i64, 1..=3_u32), 6);
        let choices = vec((0..5_usize, 0..6_usize, 0..2000_i64), 0..13);
        (vec(0..3000_i64, 5), visits, vec(0..3_u32, 4), choices).prop_map(
            |(unmet, visits, teams, choices)| Problem {
                unmet,
                visits: visits
                    .into_iter()
                    .map(|(firm_day, travel, jobs_a_team)| Visit {
                        firm_day,
                        travel,
                        jobs_a_team,
                    })
                    .collect(),
                teams,
                choices: choices
                    .into_iter()
                    .map(|(need, visit, cost)| Choice { need, visit, cost })
                    .collect(),
            },
        )
    }
}
