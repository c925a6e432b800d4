//! Puts events into words and dates.

use super::change_size as size;
use super::evidence::evidence;
use super::findings::{Begun, Ended, Misled};
use crate::analyse::logbook_rules::cause_of;
use crate::change::{
    Circumstances, Event, EventKind, PossibleReturn, SAILED_SINCE_ROWS, Snapshot, UndetectedStep,
    causes, follows_port_call, rows_since,
};
use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, Change};
use binnacle_compass::ship::{EarthField, PARAMETERS};
use binnacle_compass::time::Timestamp;

/// People write down when they noticed, not when it happened; cargo is not on board
/// before it is loaded, but for the clerk's haste.
const REPORT_S: f64 = 2.0 * 86_400.0;
/// What happens at sea after work has ended was hardly the work, but for a clock that is
/// wrong; in port it may be so much later than was planned.
const WORKED_BEFORE_S: f64 = 6.0 * 3600.0;
const PLANNED_S: f64 = 86_400.0;
const LOADED_BEFORE_S: f64 = 6.0 * 3600.0;
/// Steps at sea that follow each other within this but not within a day, in directions
/// whose cosine is more than that, are of one drift, unless they showed within hours.
const CREEPS_S: f64 = 45.0 * 86_400.0;
const CREEPS_FOR_S: f64 = 86_400.0;
const SUDDEN_S: f64 = 3.0 * 3600.0;
const SAME_WAY: f64 = 0.7;
/// Within this it shows which of two references failed, or that neither did.
const OPEN_S: f64 = 14.0 * 86_400.0;
/// What is less likely than this makes no band wider.
const SELDOM: f64 = 0.02;

/// Puts events into words and dates.
pub(super) struct Teller<'a> {
    pub(super) observations: &'a [Observation],
    pub(super) logbook: &'a [LogbookEntry],
    pub(super) events: &'a [Event],
}

impl Teller<'_> {
    fn time(&self, row: usize) -> Timestamp {
        let time = self.observations[row].time;
        time.expect("every sample has a time")
    }

    fn earth(&self, row: usize) -> EarthField {
        let o = &self.observations[row];
        EarthField {
            h_nt: o.h_nt,
            z_nt: o.z_nt,
        }
    }

    /// Between the row and the one before: when people say, or half way.
    pub(super) fn date(&self, row: usize) -> Timestamp {
        let Some(before) = row.checked_sub(1) else {
            return self.time(row);
        };
        let (before, after) = (self.time(before), self.time(row));
        let half_way = || before.plus_seconds(after.seconds_since(before) / 2.0);
        self.reported_between(before, after)
            .unwrap_or_else(half_way)
    }

    /// Returns true if any of the rows from which the event may date followed a port call.
    fn began_at_port(&self, event: &Event) -> Option<bool> {
        let (earliest, latest) = event.between;
        let calls = (earliest..=latest).map(|row| follows_port_call(self.observations, row));
        calls.reduce(|a, b| Some(a? || b?)).flatten()
    }

    pub(super) fn one_reference(&self) -> bool {
        let mut all = self.observations.iter();
        all.all(|o| o.gyro_less_satellite_deg.is_none())
    }

    /// The last row that an event spoilt: a burst's, or that before a reference was
    /// itself again.
    pub(super) fn last_spoilt(&self, index: usize) -> usize {
        let event = &self.events[index];
        let last = self.observations.len() - 1;
        match event.kind {
            EventKind::Transient => event.last.unwrap_or(last),
            _ => self.events[index + 1..]
                .iter()
                .find(|later| self.is_mended(later))
                .map_or(last, |later| later.first.saturating_sub(1).max(event.first)),
        }
    }

    /// The rows that an event spoilt: of a fault of one of two references those with both,
    /// as long as days must show which it is.
    pub(super) fn spoilt(&self, index: usize) -> impl Iterator<Item = usize> {
        let event = &self.events[index];
        let is_open = event.kind == EventKind::ReferenceFault && !self.one_reference();
        let begun = self.time(event.first);
        (event.first..=self.last_spoilt(index)).filter(move |&row| {
            let has_both = self.observations[row].gyro_less_satellite_deg.is_some();
            !is_open || (has_both && self.time(row).seconds_since(begun) < OPEN_S)
        })
    }

    fn rows_of_burst(&self, index: usize) -> &[Observation] {
        &self.observations[self.events[index].first..=self.last_spoilt(index)]
    }

    fn is_mended(&self, event: &Event) -> bool {
        match event.kind {
            EventKind::Return(of) => self.events[of].kind == EventKind::ReferenceFault,
            _ => false,
        }
    }

    pub(super) fn tell(&self, index: usize) -> Change {
        let event = &self.events[index];
        let (earliest, latest) = event.between;
        let from = self.date(event.first);
        let from_earliest = self.time(earliest.saturating_sub(1));
        let from_latest = self.time(latest);
        let back = self.events[index + 1..]
            .iter()
            .find(|later| later.kind == EventKind::Return(index));
        let ended_row = match event.kind {
            EventKind::Transient => event.last,
            _ => back.map(|later| later.first),
        };
        // A drift has no date: it is taken from one of the times that were tried.
        let at_port = match event.kind {
            EventKind::Drift => None,
            _ if event.noticed_late => None,
            _ => self.began_at_port(event),
        };
        let astray = (event.kind == EventKind::Transient)
            .then(|| size::astray(&event.before, self.rows_of_burst(index)));
        let known = Circumstances {
            leads: event.leads,
            at_port,
            ended_at_port: back.and_then(|later| self.began_at_port(later)),
            transient_s: (event.kind == EventKind::Transient).then(|| {
                let last = self.time(self.last_spoilt(index));
                last.seconds_since(self.time(event.first))
            }),
            is_over: event.last.is_some()
                || (event.kind == EventKind::ReferenceFault && back.is_some()),
            alongside: false,
            disturbance_deg: astray.as_ref().map(|astray| astray.usual_deg),
            is_open: !event.confirmed && event.withdrawn.is_none(),
            one_reference: self.one_reference(),
            is_drifting: self.is_drifting(index),
            changes_within_a_day: self.changes_within_a_day(index),
            over_step_log_likelihood_ratio: event.over_step_log_likelihood_ratio,
            alignment_over_step_log_likelihood_ratio: event
                .alignment_over_step_log_likelihood_ratio,
            detection_delay_s: self.time(event.detected_row).seconds_since(from),
            reported: self.reported(event, at_port),
        };
        let causes = causes(event.kind, &known);
        let cause = causes.first().map_or(Cause::Unknown, |c| c.cause);
        let was_discharge = cause == Cause::MagneticCargo
            && event.kind == EventKind::Step
            && self.is_said_discharge(event);
        let seen_deg = astray.map(|astray| astray.seen_deg);
        let stands = event.withdrawn.is_none();
        let has_step = matches!(event.kind, EventKind::Step | EventKind::Drift) && stands;
        let worst = match event.kind {
            EventKind::Alignment => size::zero_change(&event.before, &event.after),
            _ => size::worst_change(
                &event.before.parameters,
                &event.after.parameters,
                self.earth(event.detected_row),
            ),
        };
        let mut told = evidence(event, &known, worst, seen_deg);
        if let Some(after_s) = self.work_before(event, &known.reported) {
            told.push(format!(
                "the logbook has work on ship or compass {:.0} hours before: if it was done at this \
                 time, correct the entry",
                after_s / 3600.0
            ));
        }
        if was_discharge {
            told.push("the logbook has it that cargo was discharged then".to_owned());
        }
        // What left her with the cargo does not last.
        let over = ended_row.map(|row| self.time(row));
        let over = over.or_else(|| was_discharge.then(|| self.time(event.first)));
        let over = event.withdrawn.map(|row| self.time(row)).or(over);
        Change {
            from,
            from_earliest: from_earliest.min(from),
            from_latest: from_latest.max(from),
            detected_at: self.time(event.detected_row),
            confirmed: event.confirmed,
            cause,
            evidence: told,
            causes,
            withdrawn: !stands,
            deviation_change_deg: (event.kind.is_lasting() && stands).then_some(worst),
            step: has_step.then(|| size::step(&event.before, &event.after)),
            ended: over,
        }
    }

    /// That a change may be over, if that is not out of question.
    pub(super) fn tell_end(
        &self,
        possible_return: &PossibleReturn,
        change: usize,
        evidence: &mut Vec<String>,
    ) -> Option<Ended> {
        let probability = possible_return.probability;
        if probability < SELDOM {
            return None;
        }
        evidence.push(format!(
            "it may have ended at the port call before {}: {:.0} %",
            self.time(possible_return.first),
            100.0 * probability
        ));
        Some(Ended {
            at: self.date(possible_return.first),
            change,
            probability,
        })
    }

    /// That a change may have begun unnoticed, if that is likely enough to matter.
    pub(super) fn begun(&self, undetected_step: &UndetectedStep) -> Option<Begun> {
        (undetected_step.probability > SELDOM).then(|| Begun {
            at: self.date(undetected_step.first),
            probability: undetected_step.probability,
        })
    }

    /// What the compass shows if it was its zero that moved, where the only reference seems to
    /// err and nothing tells which it was: the fault that goes on.
    pub(super) fn misled(&self, changes: &[Change], place_of: &[Option<usize>]) -> Option<Misled> {
        if !self.one_reference() {
            return None;
        }
        let is_fault = |event: &Event| event.kind == EventKind::ReferenceFault && event.confirmed;
        let index = self.events.iter().rposition(is_fault)?;
        if self.events[index + 1..]
            .iter()
            .any(|later| self.is_mended(later))
        {
            return None;
        }
        let event = &self.events[index];
        let change = &changes[place_of.get(index).copied().flatten()?];
        let zero = change.causes.iter().find(|c| c.cause == Cause::Alignment)?;
        let constant = |of: &Snapshot| of.covariance[PARAMETERS][PARAMETERS].max(0.0);
        // Told in several steps, it is one: since the last time that all was well.
        let earlier = &self.events[..=index];
        let well = earlier.iter().rposition(|event| self.is_mended(event));
        let first = earlier[well.unwrap_or(0)..].iter().find(|e| is_fault(e));
        let sound_deg = first.unwrap_or(event).before.constant_deg;
        Some(Misled {
            moved_deg: wrap_180(event.after.constant_deg - sound_deg),
            variance: constant(&event.after),
            probability: zero.probability,
        })
    }

    /// Returns true if a step is one of several that go the same way for days: of something
    /// that creeps.
    fn is_drifting(&self, index: usize) -> bool {
        let event = &self.events[index];
        let time = |event: &Event| self.time(event.first);
        let was_sudden =
            |event: &Event| self.time(event.detected_row).seconds_since(time(event)) < SUDDEN_S;
        let is_alone = |event: &Event| {
            event.kind == EventKind::Step
                && event.confirmed
                && self.began_at_port(event) == Some(false)
                && !was_sudden(event)
        };
        let mut others = self.events.iter().enumerate();
        is_alone(event)
            && others.any(|(place, other)| {
                let apart_s = time(other).seconds_since(time(event)).abs();
                place != index
                    && is_alone(other)
                    && (CREEPS_FOR_S..CREEPS_S).contains(&apart_s)
                    && size::cosine(event, other) > SAME_WAY
            })
    }

    /// How many lasting changes there were within a day of a step, with it.
    fn changes_within_a_day(&self, index: usize) -> usize {
        let time = |event: &Event| self.time(event.first);
        let event = &self.events[index];
        let is_sudden = |event: &Event| {
            matches!(event.kind, EventKind::Step | EventKind::Alignment) && event.confirmed
        };
        let others = self.events.iter().filter(|other| {
            is_sudden(other) && time(other).seconds_since(time(event)).abs() < CREEPS_FOR_S
        });
        if is_sudden(event) { others.count() } else { 0 }
    }

    /// What people reported around the time from which the event may date.
    fn reported(&self, event: &Event, at_port: Option<bool>) -> Vec<Cause> {
        let (first, last) = event.between;
        let (earliest, latest) = (self.time(first.saturating_sub(1)), self.time(last));
        // It comes and goes in port, not after hours of sailing.
        let at_the_quay = |time: Timestamp| {
            let sailed = rows_since(&self.observations[..first], time);
            at_port == Some(true) || sailed < SAILED_SINCE_ROWS
        };
        // What happens from one time to another may change the ship all the while, but
        // cargo does so when it comes on board and when it goes.
        let near = |from: Timestamp, to: Timestamp, before_s: f64, after_s: f64| {
            earliest.seconds_since(to) < after_s && latest.seconds_since(from) > -before_s
        };
        let is_near = |entry: &&LogbookEntry| {
            let to = entry.to.unwrap_or(entry.from);
            if cause_of(entry.kind) == Some(Cause::MagneticCargo) {
                [entry.from, to]
                    .into_iter()
                    .any(|time| near(time, time, LOADED_BEFORE_S, REPORT_S) && at_the_quay(time))
            } else if entry.kind.ends_an_epoch() {
                // As written beforehand: the work waits for the ship, or she for it.
                let planned = near(entry.from, to, REPORT_S, PLANNED_S) && at_the_quay(to);
                planned || near(entry.from, to, REPORT_S, WORKED_BEFORE_S)
            } else {
                near(entry.from, to, REPORT_S, REPORT_S)
            }
        };
        let entries = self.logbook.iter().filter(is_near);
        entries.filter_map(|entry| cause_of(entry.kind)).collect()
    }

    /// How long before a step at sea there was work that does not explain it, seconds.
    fn work_before(&self, event: &Event, reported: &[Cause]) -> Option<f64> {
        if event.kind != EventKind::Step || reported.contains(&Cause::AdjustmentOrRepair) {
            return None;
        }
        let at = self.time(event.first);
        let work = self.logbook.iter().filter(|e| e.kind.ends_an_epoch());
        let after_s = work.map(|entry| at.seconds_since(entry.to.unwrap_or(entry.from)));
        after_s
            .filter(|after_s| (0.0..PLANNED_S).contains(after_s))
            .reduce(f64::min)
    }

    /// Returns true if the logbook has the end of cargo's time on board at an event, and no
    /// beginning.
    fn is_said_discharge(&self, event: &Event) -> bool {
        let (earliest, latest) = event.between;
        let (earliest, latest) = (self.time(earliest.saturating_sub(1)), self.time(latest));
        let is_then = |time: Timestamp| {
            earliest.seconds_since(time) < LOADED_BEFORE_S
                && latest.seconds_since(time) > -LOADED_BEFORE_S
        };
        let cargo = || {
            let entries = self.logbook.iter();
            entries.filter(|entry| cause_of(entry.kind) == Some(Cause::MagneticCargo))
        };
        cargo().filter_map(|entry| entry.to).any(is_then)
            && !cargo().any(|entry| is_then(entry.from))
    }

    /// When people say that something happened between two rows.
    fn reported_between(&self, before: Timestamp, after: Timestamp) -> Option<Timestamp> {
        let said = self.logbook.iter();
        let said = said.filter(|entry| cause_of(entry.kind).is_some());
        let times = said.map(|entry| entry.from);
        times.filter(|time| before < *time && *time < after).min()
    }
}
