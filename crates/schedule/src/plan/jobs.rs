//! Groups needs into jobs: needs of one ship that are due at about the same
//! time are one job.

use super::crews::seconds_up;
use crate::calls::PortCall;
use crate::input::{Checked, FormerJob, Input, JobState, Vessel};
use crate::needs::{Urgency, due};
use crate::rules::built_in_rules;
use crate::time::Instant;
use chrono::{Days, NaiveDate};
use std::collections::{BTreeMap, BTreeSet};

/// A compass that is due within the horizon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct DueNeed {
    pub(super) id: String,
    pub(super) due: NaiveDate,
    pub(super) urgency: Urgency,
    pub(super) reason: String,
}

/// Needs that are met together.
pub(super) struct Job<'a> {
    pub(super) vessel: &'a Vessel,
    /// The needs; the first due date counts for all.
    pub(super) needs: Vec<DueNeed>,
    /// The ship's calls, in order of time.
    pub(super) calls: Vec<&'a PortCall>,
    pub(super) former: Option<&'a FormerJob>,
}

impl Job<'_> {
    /// Returns the first day on which one of the needs is due; of needs whose interval may end on any
    /// day, the one to arrange it by.
    pub(super) fn due(&self) -> NaiveDate {
        let known = self
            .needs
            .iter()
            .filter(|need| need.urgency != Urgency::Unknown);
        let first = known.map(|need| need.due).min();
        first.unwrap_or(self.needs[0].due)
    }

    pub(super) fn urgency(&self) -> Urgency {
        self.needs
            .iter()
            .map(|need| need.urgency)
            .max()
            .unwrap_or(Urgency::Routine)
    }

    /// Returns true if the job may be done on any day: it is late already, however soon it is
    /// done, or the day on which its interval ends is unknown.
    pub(super) fn may_be_any_day(&self, today: NaiveDate) -> bool {
        let is_unknown = |need: &DueNeed| need.urgency == Urgency::Unknown;
        self.due() < today
            || self.urgency() == Urgency::Overdue
            || self.needs.iter().all(is_unknown)
    }

    pub(super) fn ids(&self) -> Vec<String> {
        self.needs.iter().map(|need| need.id.clone()).collect()
    }

    /// Returns the hour that a firm was asked for, or agreed to.
    pub(super) fn agreed_hour(&self) -> Option<Instant> {
        let former = self.former?;
        let is_asked = former.state != JobState::Proposed;
        former.from.filter(|_| is_asked)
    }

    /// Returns the seconds for which a firm was asked, or agreed to, if they are known.
    pub(super) fn agreed_length_s(&self) -> Option<i64> {
        let (from, to) = (self.agreed_hour()?, self.former?.to?);
        Some(seconds_up(to) - seconds_up(from))
    }

    /// Returns true if the previous plan has the job at this call, by this firm, on
    /// this day.
    pub(super) fn was_planned(&self, call: &str, firm: &str, day: NaiveDate) -> bool {
        self.former
            .is_some_and(|former| former.call == call && former.firm == firm && former.day == day)
    }
}

/// Returns the jobs of the horizon, the first due first, and the needs that are
/// due later.
pub(super) fn jobs(checked: &Checked) -> (Vec<Job<'_>>, Vec<DueNeed>) {
    let input = checked.get();
    let today = input.now.utc_date();
    let ends = today + Days::new(input.horizon_days.into());
    let mut former: BTreeMap<&str, &FormerJob> = BTreeMap::new();
    for job in &input.former {
        former.extend(job.needs.iter().map(|need| (need.as_str(), job)));
    }
    let confirmed = |id: &str| {
        former
            .get(id)
            .filter(|job| job.state == JobState::Confirmed)
            .copied()
    };
    let mut later = Vec::new();
    let mut of_vessel: BTreeMap<&str, Vec<DueNeed>> = BTreeMap::new();
    for (vessel, need) in needs(input, today) {
        // The day of an unknown need moves with today: it would never come into the horizon.
        let is_later = need.due > ends && need.urgency != Urgency::Unknown;
        if is_later && confirmed(&need.id).is_none() {
            later.push(need);
        } else {
            of_vessel.entry(vessel).or_default().push(need);
        }
    }
    let mut calls: BTreeMap<&str, Vec<&PortCall>> = BTreeMap::new();
    for call in &input.port_calls {
        calls.entry(&call.vessel).or_default().push(call);
    }
    let mut jobs = Vec::new();
    for vessel in &input.vessels {
        let mut calls = calls.remove(vessel.id.as_str()).unwrap_or_default();
        calls.sort_by_key(|call| call.eta);
        let mut open = of_vessel.remove(vessel.id.as_str()).unwrap_or_default();
        open.sort_by(|one, other| (one.due, &one.id).cmp(&(other.due, &other.id)));
        while !open.is_empty() {
            let needs = take_group(&mut open, confirmed, input.weights.join_days);
            let former = needs
                .iter()
                .find_map(|need| former.get(need.id.as_str()).copied());
            jobs.push(Job {
                vessel,
                needs,
                calls: calls.clone(),
                former,
            });
        }
    }
    jobs.sort_by(|one, other| {
        (one.due(), &one.needs[0].id).cmp(&(other.due(), &other.needs[0].id))
    });
    (jobs, later)
}

/// Takes the first need and those that go with it. Needs that a firm confirmed
/// together stay together; an unconfirmed need is joined by those due soon
/// after.
fn take_group<'a>(
    open: &mut Vec<DueNeed>,
    confirmed: impl Fn(&str) -> Option<&'a FormerJob>,
    join_days: u32,
) -> Vec<DueNeed> {
    let first = confirmed(&open[0].id);
    let latest = open[0]
        .due
        .checked_add_days(Days::new(join_days.into()))
        .unwrap_or(NaiveDate::MAX);
    let together: BTreeSet<String> = open
        .iter()
        .filter(|need| match first {
            Some(job) => job.needs.contains(&need.id),
            None => confirmed(&need.id).is_none() && need.due <= latest,
        })
        .map(|need| need.id.clone())
        .collect();
    let (group, rest) = std::mem::take(open)
        .into_iter()
        .partition(|need| together.contains(&need.id));
    *open = rest;
    group
}

/// Returns all needs with their ships: those given, and those found by the
/// rules.
fn needs(input: &Input, today: NaiveDate) -> Vec<(&str, DueNeed)> {
    let given = input.needs.iter().map(|need| {
        let urgency = need
            .urgency
            .unwrap_or_else(|| input.terms.urgency(need.due, today));
        let reason = need
            .reason
            .clone()
            .unwrap_or_else(|| format!("due {}", need.due));
        let found = DueNeed {
            id: need.id.clone(),
            due: need.due,
            urgency,
            reason,
        };
        (need.vessel.as_str(), found)
    });
    let ships: BTreeMap<&str, &Vessel> = input
        .vessels
        .iter()
        .map(|vessel| (vessel.id.as_str(), vessel))
        .collect();
    let found = input.compasses.iter().filter_map(|compass| {
        let ship = ships[compass.vessel.as_str()].ship();
        let due = due(&ship, &compass.facts, built_in_rules(), &input.terms, today)?;
        let need = DueNeed {
            id: compass.id.clone(),
            due: due.on,
            urgency: due.urgency,
            reason: due.reason,
        };
        Some((compass.vessel.as_str(), need))
    });
    given.chain(found).collect()
}
