//! Capacity that a plan leaves with the firms.

use super::candidates::Candidate;
use super::jobs::Job;
use crate::input::{Firm, Input};
use crate::ports::PortCode;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// The ships that each firm's teams serve in a plan, by day and port.
pub(super) struct Capacity<'a> {
    days: BTreeMap<(&'a str, NaiveDate), BTreeMap<PortCode, Vec<&'a str>>>,
}

impl<'a> Capacity<'a> {
    pub(super) fn from_plan(
        input: &'a Input,
        jobs: &[Job<'a>],
        made: &[Option<&Candidate<'a>>],
    ) -> Capacity<'a> {
        let mut capacity = Capacity {
            days: BTreeMap::new(),
        };
        for candidate in made.iter().flatten() {
            let firm = input.firms[candidate.firm].id.as_str();
            let day = capacity.days.entry((firm, candidate.day)).or_default();
            let called = jobs[candidate.job].vessel.display_name();
            day.entry(candidate.call.port).or_default().push(called);
        }
        capacity
    }

    /// Returns the number of further teams that a firm would need for one more job in a
    /// port.
    pub(super) fn missing_teams(&self, firm: &Firm, port: PortCode, day: NaiveDate) -> u32 {
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

    /// Returns the names of the ships that a firm serves on a day.
    pub(super) fn ships_served(&self, firm: &Firm, day: NaiveDate) -> Vec<&'a str> {
        let ports = self.days.get(&(firm.id.as_str(), day));
        ports
            .into_iter()
            .flat_map(BTreeMap::values)
            .flatten()
            .copied()
            .collect()
    }
}
