//! Crews: those teams of a firm that are alike, or one team with a name.

use crate::input::{Firm, Input, Team, Teams};
use crate::ports::PortCode;
use crate::solve::{self, TakenHours, Window};
use crate::time::Instant;
use chrono::{Datelike, NaiveDate};

/// A crew of a firm.
pub(super) struct Crew<'a> {
    /// Index of the firm.
    pub(super) at: usize,
    pub(super) firm: &'a Firm,
    /// The team, if it has a name.
    pub(super) team: Option<&'a Team>,
}

/// Returns the crews of all firms, in their order.
pub(super) fn crews(input: &Input) -> Vec<Crew<'_>> {
    let firms = input.firms.iter().enumerate();
    firms.flat_map(|(at, firm)| of_firm(at, firm)).collect()
}

/// Returns the crews of a firm.
pub(super) fn of_firm(at: usize, firm: &Firm) -> Vec<Crew<'_>> {
    match &firm.teams {
        Teams::Alike(_) => vec![Crew {
            at,
            firm,
            team: None,
        }],
        Teams::Named(teams) => {
            let teams = teams.iter().map(Some);
            teams.map(|team| Crew { at, firm, team }).collect()
        }
    }
}

impl Crew<'_> {
    pub(super) fn serves(&self, port: PortCode) -> bool {
        let ports = self.team.and_then(|team| team.ports.as_ref());
        ports.is_none_or(|ports| ports.contains(&port)) && self.firm.travel(port).is_some()
    }

    pub(super) fn holds(&self, licence: &String) -> bool {
        let own = self.team.and_then(|team| team.licences.as_ref());
        own.unwrap_or(&self.firm.licences).contains(licence)
    }

    pub(super) fn first_hour(&self) -> f64 {
        let own = self.team.and_then(|team| team.first_hour);
        own.unwrap_or(self.firm.first_hour)
    }

    pub(super) fn last_hour(&self) -> f64 {
        let own = self.team.and_then(|team| team.last_hour);
        own.unwrap_or(self.firm.last_hour)
    }

    /// Returns true on a working day.
    pub(super) fn works(&self, day: NaiveDate) -> bool {
        let own = self.team.and_then(|team| team.working_days.as_ref());
        let days = own.unwrap_or(&self.firm.working_days);
        days.contains(&day.weekday()) && !self.firm.closed.contains(&day)
    }

    /// Returns the number of teams.
    pub(super) fn teams(&self) -> u32 {
        match self.team {
            Some(_) => 1,
            None => self.firm.teams.count(),
        }
    }

    /// Returns the number of teams that are booked for the whole of a day.
    pub(super) fn booked(&self, day: NaiveDate) -> u32 {
        let taken = self.firm.taken.iter().filter(|taken| {
            let is_own = taken.team.as_ref() == self.team.map(|team| &team.name);
            taken.day == day && taken.hours.is_none() && is_own
        });
        taken.fold(0, |sum, taken| sum.saturating_add(taken.teams))
    }

    /// Returns the number of jobs of a day that are booked by the hour.
    pub(super) fn booked_jobs(&self, day: NaiveDate) -> u32 {
        let taken = self.firm.taken.iter().filter(|taken| {
            let is_own = taken.team.as_ref() == self.team.map(|team| &team.name);
            let port = taken.hours.and_then(|hours| hours.port);
            taken.day == day && is_own && port.is_some()
        });
        taken.fold(0, |sum, taken| sum.saturating_add(taken.teams))
    }

    /// Returns the name of a team, by its index.
    pub(super) fn team_name(&self, index: usize) -> String {
        match self.team {
            Some(team) => team.name.clone(),
            None => (index + 1).to_string(),
        }
    }

    /// Returns the index of a port among the firm's.
    pub(super) fn place(&self, port: PortCode) -> usize {
        let at = self
            .firm
            .ports
            .iter()
            .position(|served| served.port == port);
        at.expect("only ports that the firm serves are asked for")
    }

    /// Returns the crew in numbers.
    pub(super) fn numbers(&self) -> solve::Crew {
        let own = self.firm.taken.iter();
        let own = own.filter(|taken| taken.team.as_ref() == self.team.map(|team| &team.name));
        let taken = own.flat_map(|taken| {
            let hours = taken.hours.map(|hours| TakenHours {
                date: date(taken.day),
                window: Window {
                    from: seconds_down(hours.from),
                    to: seconds_up(hours.to),
                },
                place: hours.port.map(|port| self.place(port)),
            });
            std::iter::repeat_n(hours, taken.teams as usize).flatten()
        });
        solve::Crew {
            teams: self.teams(),
            jobs_a_team: self.firm.jobs_a_team_day,
            travel_s: self.firm.travel_s(),
            taken: taken.collect(),
        }
    }
}

/// Returns a day as a number, in the calendar's order.
pub(super) fn date(day: NaiveDate) -> i32 {
    day.num_days_from_ce()
}

/// Returns the last whole second of an instant.
pub(super) fn seconds_down(at: Instant) -> i64 {
    at.0.micros().div_euclid(1_000_000)
}

/// Returns the first whole second from an instant on.
pub(super) fn seconds_up(at: Instant) -> i64 {
    -(-at.0.micros()).div_euclid(1_000_000)
}
