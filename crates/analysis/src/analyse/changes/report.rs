//! Reports of events: their dates, causes and evidence.

use super::change_size as size;
use super::evidence::evidence;
use super::findings::{PossibleAlignment, PossibleEnd, PossibleStart};
use crate::analyse::logbook_rules::reported_cause;
use crate::change::{
    Circumstances, Event, EventKind, PossibleReturn, RowSpan, SAILED_SINCE_ROWS, Snapshot,
    UndetectedStep, causes, follows_port_call, rows_since,
};
use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, Change};
use binnacle_compass::ship::{EarthField, PARAMETERS};
use binnacle_compass::time::Timestamp;

/// Tolerance of logbook entries after an event: people write down when they noticed. Cargo
/// is not on board before it is loaded, save for a hasty entry.
const REPORT_S: f64 = 2.0 * 86_400.0;
/// Tolerance of work before an event: at sea a clock's error, in port the delay of a plan.
const WORKED_BEFORE_S: f64 = 6.0 * 3600.0;
const PLANNED_S: f64 = 86_400.0;
const LOADED_BEFORE_S: f64 = 6.0 * 3600.0;
/// Greatest time between steps at sea of one drift, least time between them, the delay of
/// detection below which a step was sudden, and the least cosine between their directions.
const DRIFT_MAX_INTERVAL_S: f64 = 45.0 * 86_400.0;
const DRIFT_MIN_INTERVAL_S: f64 = 86_400.0;
const SUDDEN_S: f64 = 3.0 * 3600.0;
const SAME_DIRECTION_COSINE: f64 = 0.7;
/// Time within which it shows which of two references failed.
const OPEN_S: f64 = 14.0 * 86_400.0;
/// Probability below which a possibility does not widen the band.
const NEGLIGIBLE_PROBABILITY: f64 = 0.02;

/// Reporter of the events of one epoch of the logbook.
pub(super) struct EventReporter<'a> {
    pub(super) observations: &'a [Observation],
    pub(super) logbook: &'a [LogbookEntry],
    pub(super) events: &'a [Event],
}

impl EventReporter<'_> {
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

    /// Dates an event between the row and the previous one: at a reported time, or half
    /// way.
    pub(super) fn date(&self, row: usize) -> Timestamp {
        let Some(before) = row.checked_sub(1) else {
            return self.time(row);
        };
        let (before, after) = (self.time(before), self.time(row));
        let half_way = || before.plus_seconds(after.seconds_since(before) / 2.0);
        self.reported_between(before, after)
            .unwrap_or_else(half_way)
    }

    /// Returns true if any row from which the event may date follows a port call.
    fn began_at_port(&self, event: &Event) -> Option<bool> {
        let RowSpan { earliest, latest } = event.between;
        let calls = (earliest..=latest).map(|row| follows_port_call(self.observations, row));
        calls.reduce(|a, b| Some(a? || b?)).flatten()
    }

    pub(super) fn one_reference(&self) -> bool {
        let mut all = self.observations.iter();
        all.all(|o| o.gyro_less_satellite_deg.is_none())
    }

    /// Returns the last row spoilt by an event: of a transient, or before a reference's
    /// repair.
    pub(super) fn last_spoilt(&self, index: usize) -> usize {
        let event = &self.events[index];
        let last = self.observations.len() - 1;
        match event.kind {
            EventKind::Transient => event.last.unwrap_or(last),
            _ => self.events[index + 1..]
                .iter()
                .find(|later| self.is_reference_repair(later))
                .map_or(last, |later| later.first.saturating_sub(1).max(event.first)),
        }
    }

    /// Returns the rows spoilt by an event. For a fault of one of two references these are
    /// the rows with both, as long as days must show which one failed.
    pub(super) fn spoilt(&self, index: usize) -> impl Iterator<Item = usize> {
        let event = &self.events[index];
        let is_open = event.kind == EventKind::ReferenceFault && !self.one_reference();
        let undetected_change = self.time(event.first);
        (event.first..=self.last_spoilt(index)).filter(move |&row| {
            let has_both = self.observations[row].gyro_less_satellite_deg.is_some();
            !is_open || (has_both && self.time(row).seconds_since(undetected_change) < OPEN_S)
        })
    }

    fn rows_of_transient(&self, index: usize) -> &[Observation] {
        &self.observations[self.events[index].first..=self.last_spoilt(index)]
    }

    fn is_reference_repair(&self, event: &Event) -> bool {
        match event.kind {
            EventKind::Return(of) => self.events[of].kind == EventKind::ReferenceFault,
            _ => false,
        }
    }

    pub(super) fn report_change(&self, index: usize) -> Change {
        let event = &self.events[index];
        let RowSpan { earliest, latest } = event.between;
        let from = self.date(event.first);
        let from_earliest = self.time(earliest.saturating_sub(1));
        let from_latest = self.time(latest);
        let returned = self.events[index + 1..]
            .iter()
            .find(|later| later.kind == EventKind::Return(index));
        let ended_row = match event.kind {
            EventKind::Transient => event.last,
            _ => returned.map(|later| later.first),
        };
        // A drift has no date: its first row is that of a fork.
        let at_port = match event.kind {
            EventKind::Drift => None,
            _ if event.noticed_late => None,
            _ => self.began_at_port(event),
        };
        let disturbance = (event.kind == EventKind::Transient)
            .then(|| size::disturbance(&event.before, self.rows_of_transient(index)));
        let known = Circumstances {
            leads: event.leads,
            at_port,
            ended_at_port: returned.and_then(|later| self.began_at_port(later)),
            transient_s: (event.kind == EventKind::Transient).then(|| {
                let last = self.time(self.last_spoilt(index));
                last.seconds_since(self.time(event.first))
            }),
            is_over: event.last.is_some()
                || (event.kind == EventKind::ReferenceFault && returned.is_some()),
            alongside: false,
            disturbance_deg: disturbance
                .as_ref()
                .map(|disturbance| disturbance.nominal_deg),
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
        let is_discharge = cause == Cause::MagneticCargo
            && event.kind == EventKind::Step
            && self.is_discharge_logged(event);
        let seen_deg = disturbance.map(|disturbance| disturbance.seen_deg);
        let is_in_force = event.withdrawn.is_none();
        let has_step = matches!(event.kind, EventKind::Step | EventKind::Drift) && is_in_force;
        let worst = match event.kind {
            EventKind::Alignment => size::alignment_change_deg(&event.before, &event.after),
            _ => size::worst_change_deg(
                &event.before.parameters,
                &event.after.parameters,
                self.earth(event.detected_row),
            ),
        };
        let mut evidence_lines = evidence(event, &known, worst, seen_deg);
        if let Some(after_s) = self.work_before(event, &known.reported) {
            evidence_lines.push(format!(
                "the logbook has work on vessel or compass {:.0} hours before: if it was done at this \
                 time, correct the entry",
                after_s / 3600.0
            ));
        }
        if is_discharge {
            evidence_lines.push("the logbook has cargo discharged at this time".to_owned());
        }
        // A change that left with the cargo does not last.
        let over = ended_row.map(|row| self.time(row));
        let over = over.or_else(|| is_discharge.then(|| self.time(event.first)));
        let over = event.withdrawn.map(|row| self.time(row)).or(over);
        Change {
            from,
            from_earliest: from_earliest.min(from),
            from_latest: from_latest.max(from),
            detected_at: self.time(event.detected_row),
            confirmed: event.confirmed,
            cause,
            evidence: evidence_lines,
            causes,
            withdrawn: !is_in_force,
            deviation_change_deg: (event.kind.is_lasting() && is_in_force).then_some(worst),
            step: has_step.then(|| size::step(&event.before, &event.after)),
            ended: over,
        }
    }

    /// Returns the possible end of a change, if its probability matters.
    pub(super) fn report_possible_end(
        &self,
        possible_return: &PossibleReturn,
        change: usize,
        evidence: &mut Vec<String>,
    ) -> Option<PossibleEnd> {
        let probability = possible_return.probability;
        if probability < NEGLIGIBLE_PROBABILITY {
            return None;
        }
        evidence.push(format!(
            "it may have ended at the port call before {}: {:.0} %",
            self.time(possible_return.first),
            100.0 * probability
        ));
        Some(PossibleEnd {
            at: self.date(possible_return.first),
            change,
            probability,
        })
    }

    /// Returns the possible undetected change, if its probability matters.
    pub(super) fn undetected_change(
        &self,
        undetected_step: &UndetectedStep,
    ) -> Option<PossibleStart> {
        (undetected_step.probability > NEGLIGIBLE_PROBABILITY).then(|| PossibleStart {
            at: self.date(undetected_step.first),
            probability: undetected_step.probability,
        })
    }

    /// Returns the possible alignment change behind a current fault of the only reference,
    /// where nothing tells the two apart.
    pub(super) fn possible_alignment(
        &self,
        changes: &[Change],
        place_of: &[Option<usize>],
    ) -> Option<PossibleAlignment> {
        if !self.one_reference() {
            return None;
        }
        let is_fault = |event: &Event| event.kind == EventKind::ReferenceFault && event.confirmed;
        let index = self.events.iter().rposition(is_fault)?;
        if self.events[index + 1..]
            .iter()
            .any(|later| self.is_reference_repair(later))
        {
            return None;
        }
        let event = &self.events[index];
        let change = &changes[place_of.get(index).copied().flatten()?];
        let zero = change.causes.iter().find(|c| c.cause == Cause::Alignment)?;
        let constant = |of: &Snapshot| of.covariance[PARAMETERS][PARAMETERS].max(0.0);
        // Reported in several steps, it is one fault: since the last repair.
        let earlier = &self.events[..=index];
        let repaired = earlier
            .iter()
            .rposition(|event| self.is_reference_repair(event));
        let first = earlier[repaired.unwrap_or(0)..]
            .iter()
            .find(|e| is_fault(e));
        let sound_deg = first.unwrap_or(event).before.constant_deg;
        Some(PossibleAlignment {
            moved_deg: wrap_180(event.after.constant_deg - sound_deg),
            variance: constant(&event.after),
            probability: zero.probability,
        })
    }

    /// Returns true if a step is one of several in the same direction over days, as of a
    /// drift.
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
                    && (DRIFT_MIN_INTERVAL_S..DRIFT_MAX_INTERVAL_S).contains(&apart_s)
                    && size::cosine(event, other) > SAME_DIRECTION_COSINE
            })
    }

    /// Returns the number of lasting changes within a day of a step, itself included.
    fn changes_within_a_day(&self, index: usize) -> usize {
        let time = |event: &Event| self.time(event.first);
        let event = &self.events[index];
        let is_sudden = |event: &Event| {
            matches!(event.kind, EventKind::Step | EventKind::Alignment) && event.confirmed
        };
        let others = self.events.iter().filter(|other| {
            is_sudden(other) && time(other).seconds_since(time(event)).abs() < DRIFT_MIN_INTERVAL_S
        });
        if is_sudden(event) { others.count() } else { 0 }
    }

    /// Returns the causes that people reported at about the time of the event.
    fn reported(&self, event: &Event, at_port: Option<bool>) -> Vec<Cause> {
        let RowSpan {
            earliest: first,
            latest: last,
        } = event.between;
        let (earliest, latest) = (self.time(first.saturating_sub(1)), self.time(last));
        // It comes and goes in port, not after hours of sailing.
        let at_the_quay = |time: Timestamp| {
            let sailed = rows_since(&self.observations[..first], time);
            at_port == Some(true) || sailed < SAILED_SINCE_ROWS
        };
        // An event with a duration may change the vessel all the while; cargo does so when
        // it is loaded and discharged.
        let near = |from: Timestamp, to: Timestamp, before_s: f64, after_s: f64| {
            earliest.seconds_since(to) < after_s && latest.seconds_since(from) > -before_s
        };
        let is_near = |entry: &&LogbookEntry| {
            let to = entry.to.unwrap_or(entry.from);
            if reported_cause(entry.kind) == Some(Cause::MagneticCargo) {
                [entry.from, to]
                    .into_iter()
                    .any(|time| near(time, time, LOADED_BEFORE_S, REPORT_S) && at_the_quay(time))
            } else if entry.kind.ends_an_epoch() {
                // A plan: the work waits for the vessel, or the vessel for it.
                let planned = near(entry.from, to, REPORT_S, PLANNED_S) && at_the_quay(to);
                planned || near(entry.from, to, REPORT_S, WORKED_BEFORE_S)
            } else {
                near(entry.from, to, REPORT_S, REPORT_S)
            }
        };
        let entries = self.logbook.iter().filter(is_near);
        entries
            .filter_map(|entry| reported_cause(entry.kind))
            .collect()
    }

    /// Returns the time since work in the logbook that does not explain a step at sea,
    /// seconds.
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

    /// Returns true if the logbook has cargo discharged, and none loaded, at an event.
    fn is_discharge_logged(&self, event: &Event) -> bool {
        let RowSpan { earliest, latest } = event.between;
        let (earliest, latest) = (self.time(earliest.saturating_sub(1)), self.time(latest));
        let is_then = |time: Timestamp| {
            earliest.seconds_since(time) < LOADED_BEFORE_S
                && latest.seconds_since(time) > -LOADED_BEFORE_S
        };
        let cargo = || {
            let entries = self.logbook.iter();
            entries.filter(|entry| reported_cause(entry.kind) == Some(Cause::MagneticCargo))
        };
        cargo().filter_map(|entry| entry.to).any(is_then)
            && !cargo().any(|entry| is_then(entry.from))
    }

    /// Returns the reported time of an event between two rows.
    fn reported_between(&self, before: Timestamp, after: Timestamp) -> Option<Timestamp> {
        let logged = self.logbook.iter();
        let logged = logged.filter(|entry| reported_cause(entry.kind).is_some());
        let times = logged.map(|entry| entry.from);
        times.filter(|time| before < *time && *time < after).min()
    }
}
