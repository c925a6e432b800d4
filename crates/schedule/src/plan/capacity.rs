//! Capacity that a plan leaves with the firms.

use super::candidates::Way;
use super::jobs::Job;
use crate::input::{Firm, Input};
use crate::ports::PortCode;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// The ships that each firm's teams serve in a plan, by day and port.
pub(super) struct Room<'a> {
    days: BTreeMap<(&'a str, NaiveDate), BTreeMap<PortCode, Vec<&'a str>>>,
}

impl<'a> Room<'a> {
    pub(super) fn of(input: &'a Input, jobs: &[Job<'a>], made: &[Option<&Way<'a>>]) -> Room<'a> {
        let mut room = Room {
            days: BTreeMap::new(),
        };
        for way in made.iter().flatten() {
            let firm = input.firms[way.firm].id.as_str();
            let day = room.days.entry((firm, way.day)).or_default();
            let called = jobs[way.job].vessel.called();
            day.entry(way.call.port).or_default().push(called);
        }
        room
    }

    /// Number of further teams that a firm would need for one more job in a
    /// port.
    pub(super) fn lacking(&self, firm: &Firm, port: PortCode, day: NaiveDate) -> u32 {
        let none = BTreeMap::new();
        let ports = self.days.get(&(firm.id.as_str(), day)).unwrap_or(&none);
        let jobs = |port: &PortCode| ports.get(port).map_or(0, Vec::len);
        let others = ports.keys().filter(|other| **other != port);
        let teams = |jobs: usize| {
            u32::try_from(jobs)
                .unwrap_or(u32::MAX)
                .div_ceil(firm.jobs_a_team_day)
        };
        let used: u32 = others.map(|port| teams(jobs(port))).sum();
        let booked = firm.taken.iter().filter(|taken| taken.day == day);
        let booked = booked.fold(0_u32, |sum, taken| sum.saturating_add(taken.teams));
        let needed = used
            .saturating_add(teams(jobs(&port) + 1))
            .saturating_add(booked);
        needed.saturating_sub(firm.teams)
    }

    /// Names of the ships that a firm serves on a day.
    pub(super) fn others(&self, firm: &Firm, day: NaiveDate) -> Vec<&'a str> {
        let ports = self.days.get(&(firm.id.as_str(), day));
        ports
            .into_iter()
            .flat_map(BTreeMap::values)
            .flatten()
            .copied()
            .collect()
    }
}
