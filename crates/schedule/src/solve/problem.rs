//! The assignment problem in numbers only, without names.
//!
//! A crew is a number of teams that are alike: with the same hours, places and
//! skills. A choice gives a need to a crew's day, within a window. A team does
//! one job after the other, and travels in between; its days follow each other
//! in the calendar's order.
//!
//! Callers ensure that a [`Problem`] has every index within its list, no
//! negative cost or time, capacity for at least one job a day, and a window
//! long enough for the job of each choice. Travel times keep the triangle
//! inequality, so that a job less never makes a route longer. Costs are whole
//! cents and times whole seconds, so that sums are exact and a bound can be
//! rounded.

/// One way to meet one need: a visit, a window and a cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Index of the need.
    pub need: usize,
    /// Index of the visit.
    pub visit: usize,
    /// Cost without the visit's travel.
    pub cost: i64,
    /// Hours within which the whole job is done.
    pub window: Window,
    /// Seconds of the job.
    pub length_s: i64,
}

/// A span of time, seconds since 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Window {
    /// Beginning.
    pub from: i64,
    /// End.
    pub to: i64,
}

/// A crew's presence at one place on one day.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Index of the crew's day.
    pub day: usize,
    /// The place, an index of the crew's travel times.
    pub place: usize,
    /// Cost of sending one team.
    pub travel: i64,
}

/// A day of a crew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrewDay {
    /// Index of the crew.
    pub crew: usize,
    /// The day, in the calendar's order.
    pub date: i32,
    /// Number of teams at work.
    pub teams: u32,
}

/// Teams that are alike.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crew {
    /// Number of teams.
    pub teams: u32,
    /// The most jobs of a team on a day.
    pub jobs_a_team: u32,
    /// Seconds from each place to each, and between two berths of one.
    pub travel_s: Vec<Vec<i64>>,
    /// Hours of a team that are given away.
    pub taken: Vec<TakenHours>,
}

/// Hours of one team that are given away: one of its jobs of that day, if they have a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TakenHours {
    /// The day.
    pub date: i32,
    /// The hours.
    pub window: Window,
    /// The place; where the team happens to be, if absent.
    pub place: Option<usize>,
}

/// The problem: at most one choice for each need, such that the teams of each
/// crew can be where they are to be.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problem {
    /// Seconds of the shortest job.
    pub job_s: i64,
    /// Cost of leaving each need unmet.
    pub unmet: Vec<i64>,
    /// All choices.
    pub choices: Vec<Choice>,
    /// All visits that a choice may ask for.
    pub visits: Vec<Visit>,
    /// All crews' days that a visit is on.
    pub days: Vec<CrewDay>,
    /// All crews.
    pub crews: Vec<Crew>,
}

/// The index of the choice for each need, or none.
pub type Assignment = Vec<Option<usize>>;

impl Problem {
    /// Returns the cost of an assignment without travel.
    pub(super) fn cost_without_travel(&self, assignment: &[Option<usize>]) -> i64 {
        let each = assignment.iter().zip(&self.unmet);
        each.map(|(choice, unmet)| choice.map_or(*unmet, |choice| self.choices[choice].cost))
            .sum()
    }

    /// Returns the crew's day of a choice.
    pub(super) fn day_of(&self, choice: usize) -> usize {
        self.visits[self.choices[choice].visit].day
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

    /// Indices of each crew's day's visits.
    pub(super) fn by_day(&self) -> Vec<Vec<usize>> {
        let mut of = vec![Vec::new(); self.days.len()];
        for (index, visit) in self.visits.iter().enumerate() {
            of[visit.day].push(index);
        }
        of
    }
}

/// Small problems for tests.
#[cfg(test)]
pub(super) mod test_problems {
    use super::{Choice, Crew, CrewDay, Problem, Visit, Window};
    use proptest::collection::vec;
    use proptest::prelude::*;

    const HOUR: i64 = 3600;

    /// Up to five needs of two hours, two crews of two places each, three days.
    pub(in crate::solve) fn problems() -> impl Strategy<Value = Problem> {
        let crew = (0..3_u32, 1..=3_u32, 0..12_i64);
        let choice = (0..5_usize, 0..12_usize, 0..2000_i64, 8..16_i64, 0..8_i64);
        let travel = vec(0..900_i64, 12);
        (
            vec(0..3000_i64, 5),
            vec(crew, 2),
            travel,
            vec(choice, 0..13),
        )
            .prop_map(|(unmet, crews, travel, choices)| Problem {
                job_s: 2 * HOUR,
                unmet,
                // Visit 6c + 2d + p is crew c, day d, place p.
                visits: travel
                    .into_iter()
                    .enumerate()
                    .map(|(at, travel)| Visit {
                        day: at / 2,
                        place: at % 2,
                        travel,
                    })
                    .collect(),
                days: (0..6)
                    .map(|day| CrewDay {
                        crew: day / 3,
                        date: i32::try_from(day % 3).unwrap(),
                        teams: crews[day / 3].0,
                    })
                    .collect(),
                crews: crews
                    .into_iter()
                    .map(|(teams, jobs_a_team, apart_h)| Crew {
                        teams,
                        jobs_a_team,
                        travel_s: vec![
                            vec![HOUR / 2, apart_h * HOUR],
                            vec![apart_h * HOUR, HOUR / 2],
                        ],
                        taken: Vec::new(),
                    })
                    .collect(),
                choices: choices
                    .into_iter()
                    .map(|(need, visit, cost, from_h, more_h)| {
                        let midnight = i64::try_from(visit / 2 % 3).unwrap() * 24 * HOUR;
                        let from = midnight + from_h * HOUR;
                        let to = from + (2 + more_h) * HOUR;
                        let window = Window { from, to };
                        Choice {
                            need,
                            visit,
                            cost,
                            window,
                            length_s: 2 * HOUR,
                        }
                    })
                    .collect(),
            })
    }
}
