//! Collection of all changes.

use super::detected::change;
use super::disturbed::record_disturbed;
use super::evidence::Facts;
use super::logged_work::{has_both_sides, logged_change};
use super::size::{Disturbance, Sides, disturbance};
use crate::constants::{DAY_S, SAME_S};
use crate::hypotheses::kinds::Kind;
use crate::report::causes::{likeliest_cause, reported};
use crate::report::epochs::{Boundaries, Span, begins_an_epoch};
use crate::report::faults::end;
use crate::report::kept::LoggedWork;
use crate::report::past::Past;
use crate::report::row_times::RowTimes;
use crate::state_space::ship_state::ShipState;
use crate::weighing::records::{Class, Detected};
use binnacle_analysis::readings::logbook_rules::reported_cause;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, Change, Epoch};
use binnacle_compass::time::Timestamp;

/// Everything that changes are made of.
pub(crate) struct Findings<'a> {
    pub(crate) detected: &'a [Detected],
    pub(crate) suspected: &'a [Detected],
    pub(crate) works: &'a [LoggedWork],
    pub(crate) boundaries: &'a Boundaries<'a>,
    pub(crate) spans: &'a [Span<'a>],
    pub(crate) epochs: &'a [Epoch],
    /// Readings that are not settled.
    pub(crate) readings: &'a [Reading],
    pub(crate) past: &'a Past,
    pub(crate) times: &'a RowTimes<'a>,
    pub(crate) logbook: &'a [LogbookEntry],
    /// Ship after the last row.
    pub(crate) current: Option<&'a ShipState>,
}

/// Changes by the samples and by the logbook.
pub(crate) struct Changes {
    /// Changes by detected events, each with the event's place.
    pub(crate) events: Vec<(usize, Change)>,
    /// Suspected changes, and those by work in the logbook.
    pub(crate) others: Vec<Change>,
}

/// Returns the changes by the samples and by the logbook.
pub(crate) fn changes(findings: &Findings<'_>) -> Changes {
    let detected = findings.detected.iter().enumerate();
    let detected = detected.filter(|(place, _)| !findings.boundaries.logged.contains(place));
    let change = |(place, detected)| match findings.past.change(detected) {
        Some(settled) => (place, settled.clone()),
        None => (place, findings.change(detected, Some(place))),
    };
    let suspected = findings.suspected.iter();
    let suspected = suspected.map(|suspected| findings.change(suspected, None));
    Changes {
        events: detected.map(change).collect(),
        others: suspected.chain(findings.logged_changes()).collect(),
    }
}

impl Findings<'_> {
    /// Returns the changes by work in the logbook that have samples on both sides.
    fn logged_changes(&self) -> impl Iterator<Item = Change> {
        let places = 0..self.spans.len();
        places.filter_map(|place| {
            let span = &self.spans[place];
            let (work, at) = span.work.zip(span.from)?;
            if !has_both_sides(self.spans, place) {
                return None;
            }
            let fitted = |epoch: usize| self.epochs[epoch].model.is_some();
            let sides = (fitted(place - 1) && fitted(place))
                .then(|| self.sides(place))
                .flatten();
            Some(logged_change(
                &self.works[work],
                at,
                sides,
                self.times.earth(at),
            ))
        })
    }

    /// Returns the change of a detected event with its place, or of a suspected one.
    fn change(&self, detected: &Detected, place: Option<usize>) -> Change {
        let sides = self.sides_of(detected, place);
        let earth = self.times.earth(detected.at);
        let facts = self.facts(
            detected,
            place.is_some(),
            sides.zip(earth).map(|(s, e)| s.worst_change_deg(e)),
        );
        let mut change = change(detected, &facts, sides, earth, self.times, self.logbook);
        record_disturbed(&mut change, self.readings, self.epochs);
        change
    }

    /// Returns the ship before an event and as it is known later; none of an event that is not
    /// the ship's.
    fn sides_of<'b>(&'b self, detected: &'b Detected, place: Option<usize>) -> Option<Sides<'b>> {
        if detected.class != Class::Ship {
            return None;
        }
        let begun = place.and_then(|place| {
            let begins = |span: &Span<'_>| span.event == Some(place) && !span.is_return;
            self.spans.iter().position(begins)
        });
        if let Some(sides) = begun.and_then(|span| self.sides(span)) {
            return Some(sides);
        }
        let event = &detected.event;
        let after = event.ship_at_end.as_deref().or(self.current)?;
        Some(Sides {
            before: &event.ship_before,
            after,
        })
    }

    /// Returns the ship at the ends of the epoch before a span and of the span itself.
    fn sides(&self, span: usize) -> Option<Sides<'_>> {
        let before = self.spans[span.checked_sub(1)?].ship?;
        let after = self.spans[span].ship?;
        Some(Sides { before, after })
    }

    fn facts(&self, detected: &Detected, is_certain: bool, worst_deg: Option<f64>) -> Facts {
        let end = self.times.last().and_then(|now| end(detected, now));
        let is_ship = detected.class == Class::Ship;
        let is_open = end.is_none() && is_ship;
        let possible_end = detected.posterior.end.filter(|_| is_open);
        Facts {
            worst_deg,
            disturbance: self.disturbance(detected, end),
            lasted_s: end.map(|end| end.seconds_since(self.times.date(detected.event.from))),
            ended_in_port: end
                .filter(|_| is_ship)
                .map(|end| self.times.is_port_call_after(end)),
            possible_end: possible_end.and_then(|end| self.times.next(end)),
            one_reference: self.has_one_reference(detected.event.from, end),
            changes_within_a_day: self.changes_within_a_day(detected),
            is_reported: !reported(detected, self.logbook).is_empty(),
            is_discharge: self.is_discharge(detected),
            work_before_s: self.work_before_s(detected),
            is_certain,
        }
    }

    /// Returns the readings after a row until a time.
    fn during(&self, from: Timestamp, end: Option<Timestamp>) -> impl Iterator<Item = &Reading> {
        let place = |time: Timestamp| self.readings.partition_point(|r| r.sample().time <= time);
        let last = end.map_or(self.readings.len(), place);
        self.readings[place(from).min(last)..last].iter()
    }

    /// Returns the error of the compass during a passing disturbance.
    fn disturbance(&self, detected: &Detected, end: Option<Timestamp>) -> Option<Disturbance> {
        if detected.class != Class::Passing {
            return None;
        }
        let from = detected.event.from;
        let mut epochs = self.epochs.iter().rev();
        let epoch = epochs.find(|epoch| epoch.from.is_none_or(|begun| begun <= from))?;
        disturbance(self.during(from, end), epoch.model.as_ref()?)
    }

    /// Returns true if no reading during an event has both references.
    fn has_one_reference(&self, from: Timestamp, end: Option<Timestamp>) -> bool {
        let has_both = |r: &Reading| r.gyro.is_some() && r.sample().satellite.is_some();
        !self.past.has_both(from, end) && !self.during(from, end).any(has_both)
    }

    /// Returns the number of sudden changes of the ship within a day of one, itself included.
    fn changes_within_a_day(&self, detected: &Detected) -> usize {
        let is_sudden = |other: &Detected| {
            let cause = likeliest_cause(other, self.logbook);
            begins_an_epoch(other, cause) && other.event.kind != Kind::ShipDrift
        };
        if !is_sudden(detected) {
            return 0;
        }
        let from = detected.event.from;
        let near = |other: &&Detected| other.event.from.seconds_since(from).abs() < DAY_S;
        let others = self.detected.iter().filter(near);
        others.filter(|other| is_sudden(other)).count()
    }

    /// Returns true if the logbook has cargo discharged, and none loaded, at a change in port.
    fn is_discharge(&self, detected: &Detected) -> bool {
        let event = &detected.event;
        if !event.in_port || likeliest_cause(detected, self.logbook) != Cause::MagneticCargo {
            return false;
        }
        let latest = self.times.next(event.from).unwrap_or(event.from);
        let is_then = |time: Timestamp| {
            event.from.seconds_since(time) < SAME_S && latest.seconds_since(time) > -SAME_S
        };
        let cargo = || {
            let entries = self.logbook.iter();
            entries.filter(|entry| reported_cause(entry.kind) == Some(Cause::MagneticCargo))
        };
        cargo().filter_map(|entry| entry.to).any(is_then)
            && !cargo().any(|entry| is_then(entry.from))
    }

    /// Returns the time since work in the logbook that does not explain a change at sea, seconds.
    fn work_before_s(&self, detected: &Detected) -> Option<f64> {
        let is_step = detected.event.kind == Kind::Strike;
        if !is_step || likeliest_cause(detected, self.logbook) == Cause::AdjustmentOrRepair {
            return None;
        }
        let at = self.times.date(detected.event.from);
        let work = self
            .logbook
            .iter()
            .filter(|entry| entry.kind.ends_an_epoch());
        let after_s = work.map(|entry| at.seconds_since(entry.to.unwrap_or(entry.from)));
        after_s
            .filter(|after_s| (0.0..DAY_S).contains(after_s))
            .reduce(f64::min)
    }
}
