//! Jobs at fixed hours: can a firm's teams do all of them?
//!
//! Invariants: a team is in one place at a time and has the time to travel between two
//! jobs, and does no more jobs on a day than it may. Working hours are no matter here:
//! what is booked is agreed.

use crate::input::{BERTH_H, Firm, usual_hours};
use crate::ports::PortCode;
use crate::time::Instant;
use chrono::NaiveDate;
use std::collections::BTreeSet;

/// Hours between two places of which one is no known port: a day.
const UNKNOWN_WAY_H: f64 = 24.0;
/// Longest way that a firm may state, hours; none by distance is longer.
const LONGEST_WAY_H: f64 = 72.0;
/// The most states that the search keeps: some megabytes.
const MAX_STATES: usize = 20_000;

/// A job at fixed hours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Booking {
    /// The day, in the port's time.
    pub day: NaiveDate,
    /// Beginning.
    pub from: Instant,
    /// End.
    pub to: Instant,
    /// Place, a UN/LOCODE or any other name.
    pub place: String,
    /// The team, if the firm's teams have names and it is known which.
    pub team: Option<String>,
}

/// A team after its last job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct LastJob {
    /// Index of the job; the next ones follow it.
    job: usize,
    /// Number of jobs on that job's day, with it.
    jobs_that_day: u32,
}

/// Returns the team of each booking, if the firm's teams can do all of them: an index of
/// its teams. `None` also where that is not found out within the limit of the search.
pub fn assign_teams(firm: &Firm, bookings: &[Booking]) -> Option<Vec<usize>> {
    let ways = Ways {
        firm,
        travel_s: firm.travel_s(),
    };
    let mut team_of = vec![0; bookings.len()];
    for order in spells(bookings) {
        // More teams than jobs are as good as one for each.
        let teams = match firm.teams.named() {
            [] => order.len().min(firm.teams.count() as usize),
            named => named.len(),
        };
        let mut search = Search {
            ways: &ways,
            bookings,
            order: &order,
            dead: BTreeSet::new(),
        };
        let mut chosen = Vec::new();
        if !search.go_on(&mut vec![None; teams], &mut chosen) {
            return None;
        }
        for (at, team) in order.iter().zip(chosen) {
            team_of[*at] = team;
        }
    }
    Some(team_of)
}

/// Returns the bookings in the order of their beginnings, in groups so far apart that a team can
/// be anywhere in between.
fn spells(bookings: &[Booking]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..bookings.len()).collect();
    order.sort_by_key(|at| (bookings[*at].from, bookings[*at].to, *at));
    let mut spells: Vec<Vec<usize>> = Vec::new();
    let mut ends: Option<Instant> = None;
    for at in order {
        let booking = &bookings[at];
        let is_near = |ends: Instant| booking.from.hours_since(ends) < LONGEST_WAY_H;
        match spells.last_mut() {
            Some(spell) if ends.is_some_and(is_near) => spell.push(at),
            _ => spells.push(vec![at]),
        }
        ends = ends.max(Some(booking.to));
    }
    spells
}

struct Search<'a> {
    ways: &'a Ways<'a>,
    bookings: &'a [Booking],
    /// Bookings in the order of their beginnings.
    order: &'a [usize],
    /// Teams' last jobs before a booking from which nothing leads on.
    dead: BTreeSet<(usize, Vec<Option<LastJob>>)>,
}

impl Search<'_> {
    fn go_on(&mut self, teams: &mut Vec<Option<LastJob>>, chosen: &mut Vec<usize>) -> bool {
        let Some(&job) = self.order.get(chosen.len()) else {
            return true;
        };
        let state = (chosen.len(), self.state(teams));
        if self.dead.contains(&state) || self.dead.len() >= MAX_STATES {
            return false;
        }
        for team in 0..teams.len() {
            // Teams that are alike and come from the same are tried once.
            let is_tried =
                self.ways.firm.teams.named().is_empty() && teams[..team].contains(&teams[team]);
            let before = teams[team];
            let Some(after) = self.next(team, before, job).filter(|_| !is_tried) else {
                continue;
            };
            teams[team] = Some(after);
            chosen.push(team);
            if self.go_on(teams, chosen) {
                return true;
            }
            chosen.pop();
            teams[team] = before;
        }
        self.dead.insert(state);
        false
    }

    /// Returns the teams' last jobs, in one order for teams that are alike.
    fn state(&self, teams: &[Option<LastJob>]) -> Vec<Option<LastJob>> {
        let mut state = teams.to_vec();
        if self.ways.firm.teams.named().is_empty() {
            state.sort_unstable();
        }
        state
    }

    /// Returns a team's last job after another one, if it can do that.
    fn next(&self, team: usize, before: Option<LastJob>, job: usize) -> Option<LastJob> {
        let booking = &self.bookings[job];
        if let (Some(asked), Some(team)) = (&booking.team, self.ways.firm.teams.named().get(team))
            && team.name != *asked
        {
            return None;
        }
        let first = LastJob {
            job,
            jobs_that_day: 1,
        };
        let Some(last) = before else {
            return Some(first);
        };
        let done = &self.bookings[last.job];
        let ready = done
            .to
            .plus_hours(self.ways.hours(&done.place, &booking.place));
        if booking.from < ready {
            return None;
        }
        if done.day != booking.day {
            return Some(first);
        }
        let jobs_that_day = last.jobs_that_day + 1;
        (jobs_that_day <= self.ways.firm.jobs_a_team_day).then_some(LastJob { job, jobs_that_day })
    }
}

/// Ways of a firm's teams.
struct Ways<'a> {
    firm: &'a Firm,
    /// Seconds between its ports.
    travel_s: Vec<Vec<i64>>,
}

impl Ways<'_> {
    /// Returns the hours between two places.
    fn hours(&self, from: &str, to: &str) -> f64 {
        let [one, other] = [from, to].map(|place| PortCode::parse(place).ok());
        let (Some(one), Some(other)) = (one, other) else {
            return if from == to { BERTH_H } else { UNKNOWN_WAY_H };
        };
        let index = |port| self.firm.ports.iter().position(|own| own.port == port);
        match (index(one), index(other)) {
            (Some(one), Some(other)) => self.travel_s[one][other] as f64 / 3600.0,
            _ => usual_hours(one, other),
        }
    }
}
