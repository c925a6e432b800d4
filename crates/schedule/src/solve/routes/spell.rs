//! The stops of a spell, by day.

use crate::solve::problem::{Crew, Problem, Window};
use std::collections::BTreeMap;

/// One job, or hours that are given away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stop {
    /// The choice; none for hours that are given away.
    pub(super) choice: Option<usize>,
    pub(super) window: Window,
    pub(super) length_s: i64,
    /// The place; where the team happens to be, if absent.
    pub(super) place: Option<usize>,
    /// Cost of a team's day there.
    pub(super) travel: i64,
}

/// A day of a spell.
pub(super) struct Day {
    pub(super) teams: usize,
    pub(super) stops: Vec<Stop>,
}

/// The stops of a crew on days near each other.
pub(crate) struct Spell<'a> {
    pub(super) crew: &'a Crew,
    pub(super) days: Vec<Day>,
    pub(super) max_travel_s: i64,
}

/// A team's jobs of a day.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    jobs: u32,
    /// Those that a choice gives it.
    chosen: u32,
}

impl Load {
    /// Returns the load with one more stop, if a team may do so many jobs. What is booked may be
    /// more than that; then it gets no job beside it.
    pub(super) fn with(self, stop: &Stop, most: u32) -> Option<Load> {
        let more = Load {
            jobs: self.jobs + u32::from(stop.place.is_some()),
            chosen: self.chosen + u32::from(stop.choice.is_some()),
        };
        (more.jobs <= most || more.chosen == 0).then_some(more)
    }
}

/// A team's place, and when it is ready to leave it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Team {
    pub(super) place: Option<usize>,
    pub(super) ready: i64,
}

impl Team {
    /// A team that can be anywhere in time.
    pub(super) const FREE: Team = Team {
        place: None,
        ready: i64::MIN,
    };
}

impl<'a> Spell<'a> {
    /// Builds the spell of some choices of one crew, with the hours of these
    /// days that are given away.
    pub(crate) fn new(problem: &'a Problem, crew: usize, choices: &[usize]) -> Spell<'a> {
        let of = &problem.crews[crew];
        let mut days: BTreeMap<i32, Day> = BTreeMap::new();
        for &choice in choices {
            let chosen = problem.choices[choice];
            let visit = problem.visits[chosen.visit];
            let crew_day = problem.days[visit.day];
            let day = days.entry(crew_day.date).or_insert_with(|| Day {
                teams: crew_day.teams as usize,
                stops: Vec::new(),
            });
            day.stops.push(Stop {
                choice: Some(choice),
                window: chosen.window,
                length_s: chosen.length_s,
                place: Some(visit.place),
                travel: visit.travel,
            });
        }
        if let (Some((&first, _)), Some((&last, _))) =
            (days.first_key_value(), days.last_key_value())
        {
            // Hours given away the day before or after may keep a team away.
            let near = first - 2..=last + 2;
            for taken in of.taken.iter().filter(|taken| near.contains(&taken.date)) {
                let day = days.entry(taken.date).or_insert_with(|| Day {
                    teams: of.teams as usize,
                    stops: Vec::new(),
                });
                day.stops.push(Stop {
                    choice: None,
                    window: taken.window,
                    length_s: taken.window.to - taken.window.from,
                    place: taken.place,
                    travel: 0,
                });
            }
        }
        let mut days: Vec<Day> = days.into_values().collect();
        for day in &mut days {
            let key = |stop: &Stop| (stop.window.to, stop.window.from, stop.place, stop.choice);
            day.stops.sort_by_key(key);
        }
        Spell {
            crew: of,
            days,
            max_travel_s: max_travel_s(of),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.days.iter().map(|day| day.stops.len()).sum()
    }

    /// Returns a lower bound of the cost: each place of a day has as many teams as its jobs need
    /// by their number.
    pub(super) fn least_cost(&self) -> i64 {
        let most = self.crew.jobs_a_team;
        let mut cost = 0;
        for day in &self.days {
            let mut jobs: BTreeMap<usize, (u32, i64)> = BTreeMap::new();
            for stop in day.stops.iter().filter(|stop| stop.choice.is_some()) {
                let Some(place) = stop.place else { continue };
                let there = jobs.entry(place).or_insert((0, stop.travel));
                there.0 += 1;
            }
            let each = jobs.values();
            cost += each
                .map(|(jobs, travel)| i64::from(jobs.div_ceil(most)) * travel)
                .sum::<i64>();
        }
        cost
    }

    /// Returns the time at which a team could begin a stop; `None` where that is too
    /// late.
    pub(super) fn begin(&self, team: Team, stop: &Stop) -> Option<i64> {
        let travel_s = match (team.place, stop.place) {
            (Some(from), Some(to)) => self.crew.travel_s[from][to],
            _ => 0,
        };
        let begin = team.ready.saturating_add(travel_s).max(stop.window.from);
        (begin + stop.length_s <= stop.window.to).then_some(begin)
    }

    /// Returns where a team is after a stop that began at a time.
    pub(super) fn after(team: Team, stop: &Stop, begin: i64) -> Team {
        Team {
            place: stop.place.or(team.place),
            ready: begin + stop.length_s,
        }
    }

    /// Forgets where teams were that can be anywhere in time from the next day on.
    pub(super) fn free_by(&self, teams: &mut [Team], next_day: usize) {
        let later = || self.days[next_day..].iter().flat_map(|day| &day.stops);
        for team in teams.iter_mut().filter(|team| **team != Team::FREE) {
            let is_in_time = |stop: &Stop| {
                let travel_s = match (team.place, stop.place) {
                    (Some(from), Some(to)) => self.crew.travel_s[from][to],
                    // It may have to be anywhere after such hours.
                    (Some(_), None) => self.max_travel_s,
                    (None, _) => 0,
                };
                team.ready.saturating_add(travel_s) <= stop.window.from
            };
            if later().all(is_in_time) {
                *team = Team::FREE;
            }
        }
    }
}

/// Returns the longest travel of a crew.
pub(crate) fn max_travel_s(crew: &Crew) -> i64 {
    crew.travel_s.iter().flatten().copied().max().unwrap_or(0)
}
