//! Cuts: what the routes forbid, and counting teams does not.
//!
//! A cut is a set of choices of one crew that its teams cannot all make, or that
//! costs more travel than their number alone says. Of jobs no two of which one
//! team can do, a crew does at most as many as it has teams: such a cut is
//! extended by every other choice that meets none of them.
//!
//! Invariant: every assignment that the teams can do keeps every cut.

use crate::solve::problem::Problem;
use crate::solve::state::Router;
use std::collections::BTreeSet;

/// A constraint on some choices of a crew.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cut {
    /// At most so many of these.
    AtMost { choices: Vec<usize>, most: usize },
    /// All of these together cost this much travel.
    Travel { choices: Vec<usize>, least: i64 },
}

impl Cut {
    pub(super) fn choices(&self) -> &[usize] {
        match self {
            Cut::AtMost { choices, .. } | Cut::Travel { choices, .. } => choices,
        }
    }
}

/// Cuts off a spell that costs more than the teams that a model counts for each visit;
/// `None` where it does not, or where the search for its routes was given up.
pub(super) fn find(
    problem: &Problem,
    router: &Router<'_>,
    open: &[bool],
    spell: &[usize],
    teams: &[u32],
) -> Option<Cut> {
    let is_cut = |choices: &[usize]| match router.cost(choices) {
        (None, exact) => exact,
        (Some(cost), exact) => exact && cost > counted_travel(problem, choices, teams),
    };
    if !is_cut(spell) {
        return None;
    }
    let mut choices = spell.to_vec();
    for at in (0..choices.len()).rev() {
        let left_out = choices.remove(at);
        if !is_cut(&choices) {
            choices.insert(at, left_out);
        }
    }
    if let Some(least) = router.cost(&choices).0 {
        return Some(Cut::Travel { choices, least });
    }
    let most = choices.len() - 1;
    extend(problem, open, &mut choices);
    Some(Cut::AtMost { choices, most })
}

/// Returns the travel of the teams that a model counts for the visits of some jobs.
fn counted_travel(problem: &Problem, choices: &[usize], teams: &[u32]) -> i64 {
    let visits = choices.iter().map(|choice| problem.choices[*choice].visit);
    let visits: BTreeSet<usize> = visits.collect();
    let each = visits
        .into_iter()
        .map(|visit| i64::from(teams[visit]) * problem.visits[visit].travel);
    each.sum()
}

/// Extends choices that need one team each by all others of which that is
/// true.
fn extend(problem: &Problem, open: &[bool], choices: &mut Vec<usize>) {
    let crew_of = |choice: usize| problem.days[problem.day_of(choice)].crew;
    let crew = crew_of(choices[0]);
    let apart = |choice: usize, others: &[usize]| {
        let mut others = others.iter();
        others.all(|other| {
            !can_follow(problem, choice, *other) && !can_follow(problem, *other, choice)
        })
    };
    let is_full = choices.len() > problem.crews[crew].teams as usize;
    let each = (1..choices.len()).all(|at| apart(choices[at], &choices[..at]));
    if !is_full || !each {
        return;
    }
    let open = open.iter().enumerate().filter(|(_, is_open)| **is_open);
    for (choice, _) in open {
        if crew_of(choice) == crew && !choices.contains(&choice) && apart(choice, choices) {
            choices.push(choice);
        }
    }
    choices.sort_unstable();
}

/// Returns true if one team could make a choice after another.
fn can_follow(problem: &Problem, first: usize, next: usize) -> bool {
    let [one, other] = [first, next].map(|choice| problem.choices[choice]);
    let [from, to] = [one, other].map(|choice| problem.visits[choice.visit]);
    let [day, next_day] = [from, to].map(|visit| problem.days[visit.day]);
    let crew = &problem.crews[day.crew];
    let in_order = day.date < next_day.date || day.date == next_day.date && crew.jobs_a_team > 1;
    let travel_s = crew.travel_s[from.place][to.place];
    let ends = one.window.from + one.length_s + travel_s + other.length_s;
    one.need != other.need && in_order && ends <= other.window.to
}
