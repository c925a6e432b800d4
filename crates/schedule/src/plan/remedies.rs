//! Remedies: changes that would let a job be scheduled, several together where
//! one is not enough.
//!
//! Invariant: a line names everything that its way lacks.

use super::capacity::Capacity;
use super::crews::{Crew, seconds_up};
use super::jobs::Job;
use super::quote::{self, Obstacle};
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use crate::ports::{self, PortCode};
use crate::solve::Window;
use crate::time::{Eur, Instant};
use chrono::{Days, NaiveDate};
use std::collections::{BTreeMap, BTreeSet};

/// Days ahead within which an available firm is looked for.
const DAYS_AHEAD: u64 = 90;
/// The most ports listed as served.
const MAX_PORTS: usize = 12;
/// Assumed hours of a firm that is not in the input.
const USUAL_HOURS: (f64, f64) = (8.0, 18.0);

/// Everything that one way lacks.
#[derive(Default)]
pub(super) struct Remedy(Vec<String>);

impl Remedy {
    pub(super) fn teams(&mut self, firm: &Firm, port: &str, day: NaiveDate, teams: u32) {
        let name = firm.display_name();
        match teams {
            0 => {}
            1 => self
                .0
                .push(format!("one more team of {name} on {day}, at {port}")),
            _ => self
                .0
                .push(format!("{teams} more teams of {name} on {day}, at {port}")),
        }
    }

    /// Adds a price cut by `excess_price` cents and a little more.
    pub(super) fn price(&mut self, firm: &Firm, port: &str, day: NaiveDate, excess_price: i64) {
        let euros = excess_price.div_euclid(100) + 1;
        let name = firm.display_name();
        self.0.push(format!(
            "{name} coming to {port} on {day} for {euros} euros less"
        ));
    }
}

/// Remedies for one job.
pub(super) struct Remedies<'a> {
    pub(super) input: &'a Input,
    pub(super) job: &'a Job<'a>,
    pub(super) capacity: &'a Capacity<'a>,
    pub(super) planned_late: bool,
    /// Number of changes, their kind, the day, and the line.
    near: BTreeSet<(usize, u8, NaiveDate, String)>,
}

impl<'a> Remedies<'a> {
    pub(super) fn new(
        input: &'a Input,
        job: &'a Job<'a>,
        capacity: &'a Capacity<'a>,
        planned_late: bool,
    ) -> Remedies<'a> {
        Remedies {
            input,
            job,
            capacity,
            planned_late,
            near: BTreeSet::new(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.near.is_empty()
    }

    pub(super) fn lines(&self, most: usize) -> Vec<String> {
        // Where one change is enough, lines with several are left out.
        let least = self.near.first().map_or(0, |(things, ..)| *things);
        let lines = self.near.iter().filter(|(things, ..)| *things == least);
        lines.take(most).map(|(.., line)| line.clone()).collect()
    }

    pub(super) fn add(&mut self, kind: u8, day: NaiveDate, Remedy(remedy): Remedy) {
        let things = remedy.len();
        if things > 0 {
            self.near.insert((things, kind, day, remedy.join(" and ")));
        }
    }

    /// Adds an extension of the due date.
    pub(super) fn add_extension(&mut self, day: NaiveDate) {
        let help = self.extension_to(day);
        self.add(4, day, Remedy(vec![help]));
    }

    fn extension_to(&self, day: NaiveDate) -> String {
        let whose = match self.job.vessel.flag {
            Some(flag) => format!("flag {}", flag.letters()),
            None => "the flag".to_owned(),
        };
        format!("an extension to {day}, from {whose}, where its rules allow one")
    }

    /// Returns true if the due date allows a job on that day.
    fn may_be_on(&self, day: NaiveDate) -> bool {
        let late_days = (day - self.job.due()).num_days();
        let in_cap = |most: u32| late_days <= i64::from(most);
        late_days <= 0
            || self.job.may_be_any_day(self.input.now.utc_date())
            || !self.planned_late && self.input.weights.late_days.is_none_or(in_cap)
    }

    /// Adds what would remove the obstacles to a firm's day of a call.
    pub(super) fn overcome(
        &mut self,
        call: &PortCall,
        at: usize,
        day: NaiveDate,
        obstacles: &[Obstacle],
    ) {
        let crew = &self.capacity.candidates.crews[at];
        let firm = crew.firm;
        if obstacles == [Obstacle::AfterDue] {
            self.add_earlier_call(firm, call.port);
        }
        let Some((mut remedy, window)) = self.remedy_of_crew(crew, call, day, obstacles) else {
            return;
        };
        let port = quote::port_of(call).name;
        let teams = self.capacity.missing_teams(at, call.port, day, window);
        remedy.teams(firm, port, day, teams);
        if let Some(excess_price) = self.excess_price(firm, call.port) {
            remedy.price(firm, port, day, excess_price);
        }
        let (mut kind, mut about) = (1, day);
        if obstacles.contains(&Obstacle::AfterDue) {
            remedy.0.push(self.extension_to(day));
            // Remedies for days that are too late are sorted by the due date.
            (kind, about) = (4, self.job.due().max(day));
        }
        self.add(kind, about, remedy);
    }

    /// Returns the remedy with the hours that it gives; `None` where nothing helps: the hours
    /// of that day are over.
    fn remedy_of_crew(
        &self,
        crew: &Crew<'_>,
        call: &PortCall,
        day: NaiveDate,
        obstacles: &[Obstacle],
    ) -> Option<(Remedy, Window)> {
        let (port, firm) = (quote::port_of(call), crew.firm);
        let (name, at) = (firm.display_name(), port.name);
        let mut remedy =
            Remedy(self.remedy_of_terms(firm, obstacles, &format!("at {at} on {day}")));
        if obstacles.contains(&Obstacle::NotWorking) {
            let weekday = day.format("%A");
            remedy
                .0
                .push(format!("{name} working at {at} on {weekday}, {day}"));
        }
        let (now, job_s) = (seconds_up(self.input.now), quote::job_s(self.input));
        let work = quote::work_hours(crew, day, port.zone);
        let is_short = obstacles.contains(&Obstacle::Stay);
        let hours = if is_short {
            remedy
                .0
                .push(format!("a longer stay at {at} on {day}, for {name}"));
            work
        } else {
            quote::alongside(call, work)
        };
        if work.to - work.from < job_s {
            return None;
        }
        let notice_h = ((hours.to - job_s - now) as f64 / 3600.0).floor();
        if hours.to - hours.from.max(now) < job_s || notice_h < 0.0 {
            return None;
        }
        let mut ready = now;
        if firm.lead_time_h > notice_h {
            remedy.0.push(format!(
                "{name} coming to {at} at {notice_h} h notice, on {day}"
            ));
            ready += (notice_h * 3600.0) as i64;
        } else {
            ready += (firm.lead_time_h * 3600.0).ceil() as i64;
        }
        let from = hours.from.max(ready);
        Some((remedy, Window { from, to: hours.to }))
    }

    /// Adds the end of a longer stay, if a team has time then.
    pub(super) fn add_longer_stay(
        &mut self,
        call: &PortCall,
        at: usize,
        day: NaiveDate,
        window: Window,
        excess_price: i64,
    ) {
        let (port, crew) = (quote::port_of(call), &self.capacity.candidates.crews[at]);
        let to = quote::work_hours(crew, day, port.zone).to;
        let longer = Window { to, ..window };
        let ends = self.capacity.earliest_end(at, call.port, day, longer);
        let Some(ends) = ends.filter(|_| to > window.to) else {
            return;
        };
        let until = port.zone.local(quote::instant(ends));
        let (name, until) = (crew.firm.display_name(), until.format("%H:%M"));
        let line = format!(
            "a longer stay at {} on {day}, until {until}, for {name}",
            port.name
        );
        let mut remedy = Remedy(vec![line]);
        if excess_price >= 0 {
            remedy.price(crew.firm, port.name, day, excess_price);
        }
        self.add(1, day, remedy);
    }

    /// Changes that a firm needs at any place.
    fn remedy_of_terms(&self, firm: &Firm, obstacles: &[Obstacle], there: &str) -> Vec<String> {
        let name = firm.display_name();
        let mut remedy = Vec::new();
        if obstacles.contains(&Obstacle::Flag) {
            let flag = self.job.vessel.describe_flag();
            remedy.push(format!("{flag} accepting {name}, {there}"));
        }
        if obstacles.contains(&Obstacle::Licence) {
            let licence = self.job.vessel.licence.as_deref().unwrap_or_default();
            remedy.push(format!("{name} holding licence {licence}, {there}"));
        }
        if obstacles.contains(&Obstacle::Declined) {
            remedy.push(format!("{name} accepting after all, {there}"));
        }
        remedy
    }

    /// Cents by which a firm costs more than an unmet need; `None` where it is
    /// worth its price on any day.
    pub(super) fn excess_price(&self, firm: &Firm, port: PortCode) -> Option<i64> {
        let more = self.job.needs.iter().skip(1);
        let extra: i64 = more.map(|_| firm.extra_compass_eur.cents()).sum();
        let price = firm.fee_eur.cents() + extra + firm.travel(port).map_or(0, Eur::cents);
        let worth = self
            .input
            .weights
            .unmet_eur
            .weight(self.job.urgency())
            .cents();
        (price >= worth).then_some(price - worth)
    }

    /// Adds a firm at a port that none serves.
    pub(super) fn add_firm_at(&mut self, call: &PortCall) {
        let (port, now) = (quote::port_of(call), self.input.now);
        let long_enough = |day: &NaiveDate| {
            let [opens, closes] =
                [USUAL_HOURS.0, USUAL_HOURS.1].map(|hour| Instant::at(*day, hour, port.zone));
            let (from, to) = (opens.max(call.eta).max(now), closes.min(call.etd));
            to.hours_since(from) >= self.input.weights.job_h
        };
        let Some(day) = quote::days(call, now).find(long_enough) else {
            return;
        };
        if self.planned_late && day > self.job.due() {
            return;
        }
        let mut remedy = Remedy(vec![format!(
            "a firm at {} ({}) on {day}",
            port.name, call.port
        )]);
        if !self.may_be_on(day) {
            remedy.0.push(self.extension_to(day));
        }
        self.add(2, day, remedy);
    }

    /// Returns the first day on which a firm could come to a port, if the ship called
    /// there and the firm's terms allowed it.
    fn first_day(&self, firm: &Firm, port: PortCode) -> Option<NaiveDate> {
        let zone = ports::zone(port);
        let now = self.input.now;
        let ready = seconds_up(now.plus_hours(firm.lead_time_h));
        let today = now.date(zone);
        let mut days = (0..DAYS_AHEAD).filter_map(|ahead| today.checked_add_days(Days::new(ahead)));
        days.find(|day| {
            let could_come = |(at, crew): (usize, &Crew<'_>)| {
                let work = quote::work_hours(crew, *day, zone);
                let from = work.from.max(ready);
                let window = Window { from, to: work.to };
                crew.serves(port)
                    && crew.works(*day)
                    && work.to - from >= quote::job_s(self.input)
                    && self.capacity.missing_teams(at, port, *day, window) == 0
            };
            self.capacity.crews_of(firm).any(could_come)
        })
    }

    /// Obstacles to a firm at any place and time.
    fn permanent_obstacles(&self, firm: &Firm) -> Vec<Obstacle> {
        let mut never = Vec::new();
        if !firm.is_accepted_by(self.job.vessel.flag) {
            never.push(Obstacle::Flag);
        }
        let licence = self.job.vessel.licence.as_ref();
        let lacks = |asked| {
            !self
                .capacity
                .crews_of(firm)
                .any(|(_, crew)| crew.holds(asked))
        };
        if licence.is_some_and(lacks) {
            never.push(Obstacle::Licence);
        }
        let has_declined = self.input.declined.iter().any(|declined| {
            declined.firm == firm.id
                && declined.call.is_none()
                && self.job.needs.iter().any(|need| need.id == declined.need)
        });
        if has_declined {
            never.push(Obstacle::Declined);
        }
        never
    }

    /// Adds a call in time where a firm could only come late.
    fn add_earlier_call(&mut self, firm: &Firm, port: PortCode) {
        let able =
            self.permanent_obstacles(firm).is_empty() && self.excess_price(firm, port).is_none();
        let Some(day) = self.first_day(firm, port).filter(|_| able) else {
            return;
        };
        let (name, at) = (
            firm.display_name(),
            ports::find(port).map_or("", |port| port.name),
        );
        let mut remedy = Remedy(vec![self.call_at(day, &format!("{at}: {name} could come"))]);
        if !self.may_be_on(day) {
            remedy.0.push(self.extension_to(day));
        }
        self.add(1, self.job.due(), remedy);
    }

    /// Returns a call at a place, where a firm could come on `first` at the earliest. A
    /// date in the past, or before `first`, is not offered.
    fn call_at(&self, first: NaiveDate, place: &str) -> String {
        let (today, due) = (self.input.now.utc_date(), self.job.due());
        if due <= today || self.job.may_be_any_day(today) || first > due {
            format!("a call as soon as possible at {place}")
        } else {
            format!("a call by {due} at {place}")
        }
    }

    /// Adds a call at any port that a firm serves.
    pub(super) fn add_call(&mut self) {
        let due = self.job.due();
        let (mut in_time, mut later) = (BTreeSet::new(), BTreeMap::new());
        for firm in &self.input.firms {
            if !self.permanent_obstacles(firm).is_empty() {
                continue;
            }
            for served in &firm.ports {
                let port = served.port;
                let Some(day) = self.first_day(firm, port) else {
                    continue;
                };
                if self.excess_price(firm, port).is_some() {
                    continue;
                }
                if day <= due || self.job.may_be_any_day(self.input.now.utc_date()) {
                    in_time.insert(port);
                } else {
                    let first = later.entry(port).or_insert(day);
                    *first = day.min(*first);
                }
            }
        }
        let named = |ports: &BTreeSet<PortCode>| {
            let ports = ports.iter().take(MAX_PORTS).map(ToString::to_string);
            format!(
                "a port that a firm serves: {}",
                ports.collect::<Vec<_>>().join(", ")
            )
        };
        if !in_time.is_empty() {
            let help = self.call_at(due, &named(&in_time));
            self.add(3, due, Remedy(vec![help]));
        } else if let Some(first) = later.values().min().copied() {
            let soonest = later.iter().filter(|(_, day)| **day == first);
            let soonest = soonest.map(|(port, _)| *port).collect();
            let mut remedy = Remedy(vec![self.call_at(first, &named(&soonest))]);
            if !self.may_be_on(first) {
                remedy.0.push(self.extension_to(first));
            }
            // A job that is planned late already would be no earlier.
            if !self.planned_late || !self.may_be_on(first) {
                self.add(3, due, remedy);
            }
        } else {
            self.add_another_firm();
        }
    }

    /// Adds the changes that each firm would need, or another firm, where none
    /// could come anywhere.
    fn add_another_firm(&mut self) {
        for firm in &self.input.firms {
            let never = self.permanent_obstacles(firm);
            let Some(served) = firm.ports.first() else {
                continue;
            };
            let Some(day) = self
                .first_day(firm, served.port)
                .filter(|_| !never.is_empty())
            else {
                continue;
            };
            let at = ports::find(served.port).map_or("", |port| port.name);
            let mut remedy = Remedy(self.remedy_of_terms(firm, &never, &format!("at {at}")));
            if let Some(excess_price) = self.excess_price(firm, served.port) {
                remedy.price(firm, at, day, excess_price);
            }
            remedy.0.push(self.call_at(day, at));
            if !self.may_be_on(day) {
                remedy.0.push(self.extension_to(day));
            }
            self.add(3, self.job.due(), remedy);
        }
        if self.is_empty() {
            let help = "another firm that may adjust the vessel, at a port where it calls for a working day";
            self.add(5, self.job.due(), Remedy(vec![help.to_owned()]));
        }
    }
}
