//! Routes of a crew's teams: whether they can do some jobs, at what cost of
//! travel, and when.
//!
//! A spell is a crew's jobs on days so near each other that where a team was
//! on one matters on the next. After a spell every team is in time for whatever
//! is next. So the least cost of a crew's jobs is the sum over its spells, and each is found by
//! dynamic programming over its days: a state is where each team is and when it
//! is ready, with the least travel until then.
//!
//! Invariants: a route that is returned can be driven, and its cost is the
//! least where it is called exact. Work is counted and limited: a day of so
//! many jobs that the search is given up gets the best route that was found,
//! which is not called exact, or none.

mod greedy;
mod search;
mod spell;

pub(super) use spell::{Spell, max_travel_s};

/// Steps of the search of one spell.
const MAX_STEPS: usize = 5_000;

/// A stop of a team, with the time at which it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Leg {
    /// The team, from 0.
    pub(super) team: usize,
    /// The choice that is made; none for hours that are given away.
    pub(super) choice: Option<usize>,
    /// Beginning, seconds since 1970.
    pub(super) from: i64,
}

/// The routes of a spell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Routes {
    /// Cost of travel.
    pub(super) cost: i64,
    /// The stops of all teams, day by day.
    pub(super) legs: Vec<Leg>,
}

/// The answer for a spell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Answer {
    /// The best routes found; none where the teams cannot do it.
    pub(super) routes: Option<Routes>,
    /// True if no routes cost less.
    pub(super) exact: bool,
    /// Steps taken.
    pub(super) steps: usize,
}

/// Finds the cheapest routes of a spell.
pub(super) fn find(spell: &Spell<'_>) -> Answer {
    let least = spell.least_cost();
    let simple = greedy::find(spell);
    if let Some(routes) = simple.as_ref().filter(|routes| routes.cost <= least) {
        return Answer {
            routes: Some(routes.clone()),
            exact: true,
            steps: spell.len(),
        };
    }
    let mut found = search::find(spell, least, MAX_STEPS);
    if !found.exact {
        let cost = |routes: &Option<Routes>| routes.as_ref().map_or(i64::MAX, |it| it.cost);
        if cost(&simple) < cost(&found.routes) {
            found.routes = simple;
        }
    }
    found
}
