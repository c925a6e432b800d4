//! Puts events into words and dates.

use super::{Ended, cause_of, size};
use crate::analyse::logbook::LogbookEntry;
use crate::change::{Cause, Change, Circumstances, Event, Perhaps, What, at_port, causes, odds};
use crate::fit::Observation;
use crate::ship::EarthField;
use crate::time::Timestamp;

/// People write down when they noticed, not when it happened; cargo is not on board
/// before it is loaded, but for the clerk's haste.
const REPORT_S: f64 = 2.0 * 86_400.0;
/// What happens after work has ended was hardly the work, but for a clock that is wrong.
const WORKED_BEFORE_S: f64 = 6.0 * 3600.0;
const LOADED_BEFORE_S: f64 = 6.0 * 3600.0;
/// Steps at sea that follow each other within this, in directions whose cosine is more
/// than that, are of one drift.
const CREEPS_S: f64 = 45.0 * 86_400.0;
const SAME_WAY: f64 = 0.7;
/// What is further astray is worth a word, degrees where H is 24 µT.
const WILD_DEG: f64 = 8.0;
/// What is less likely than this makes no band wider.
const SELDOM: f64 = 0.02;

/// Said of a disturbance that other ships may speak for.
const FAINT: &str = "too faint to be certain by this ship alone";

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

    /// Whether any of the rows from which the event may date followed a port call.
    fn began_at_port(&self, event: &Event) -> Option<bool> {
        let (earliest, latest) = event.between;
        let calls = (earliest..=latest).map(|row| at_port(self.observations, row));
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
        match event.what {
            What::Burst => event.last.unwrap_or(last),
            _ => self.events[index + 1..]
                .iter()
                .find(|later| self.is_mended(later))
                .map_or(last, |later| later.first.saturating_sub(1).max(event.first)),
        }
    }

    fn rows_of_burst(&self, index: usize) -> &[Observation] {
        &self.observations[self.events[index].first..=self.last_spoilt(index)]
    }

    fn is_mended(&self, event: &Event) -> bool {
        match event.what {
            What::Return(of) => self.events[of].what == What::Reference,
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
            .find(|later| later.what == What::Return(index));
        let ended_row = match event.what {
            What::Burst => event.last,
            _ => back.map(|later| later.first),
        };
        // A drift has no date: it is taken from one of the times that were tried.
        let at_port = match event.what {
            What::Drift => None,
            _ => self.began_at_port(event),
        };
        let known = Circumstances {
            leads: event.leads,
            at_port,
            ended_at_port: back.and_then(|later| self.began_at_port(later)),
            burst_s: (event.what == What::Burst).then(|| {
                let last = self.time(self.last_spoilt(index));
                last.seconds_since(self.time(event.first))
            }),
            is_over: event.last.is_some(),
            astray_deg: matches!(event.what, What::Burst)
                .then(|| size::astray_deg(&event.before, self.rows_of_burst(index))),
            one_reference: self.one_reference(),
            creeps: self.creeps(index),
            over_step: event.over_step,
            told_after_s: self.time(event.told).seconds_since(from),
            reported: self.reported(from_earliest, from_latest),
        };
        let causes = causes(event.what, &known);
        let has_step = matches!(event.what, What::Step | What::Drift);
        let worst = match event.what {
            What::Alignment => size::zero_change(&event.before, &event.after),
            _ => size::worst_change(
                &event.before.parameters,
                &event.after.parameters,
                self.earth(event.told),
            ),
        };
        Change {
            from,
            from_earliest: from_earliest.min(from),
            from_latest: from_latest.max(from),
            detected_at: self.time(event.told),
            confirmed: event.confirmed,
            cause: causes.first().map_or(Cause::Unknown, |c| c.cause),
            evidence: evidence(event, &known, worst),
            causes,
            deviation_change_deg: event.what.is_lasting().then_some(worst),
            step: has_step.then(|| size::step(&event.before, &event.after)),
            ended: ended_row.map(|row| self.time(row)),
        }
    }

    /// That a change may be over, if that is neither certain nor out of question.
    pub(super) fn tell_end(
        &self,
        perhaps: &Perhaps,
        change: usize,
        evidence: &mut Vec<String>,
    ) -> Option<Ended> {
        let probability = perhaps.probability;
        if !(SELDOM..1.0 - SELDOM).contains(&probability) {
            return None;
        }
        evidence.push(format!(
            "it may have ended at the port call before {}: {:.0} %",
            self.time(perhaps.first),
            100.0 * probability
        ));
        Some(Ended {
            at: self.date(perhaps.first),
            change,
            probability,
        })
    }

    /// Whether a step is one of several that go the same way: of something that creeps.
    fn creeps(&self, index: usize) -> bool {
        let event = &self.events[index];
        let is_alone = |event: &Event| {
            event.what == What::Step && event.confirmed && self.began_at_port(event) == Some(false)
        };
        let time = |event: &Event| self.time(event.first);
        let mut others = self.events.iter().enumerate();
        is_alone(event)
            && others.any(|(place, other)| {
                let apart_s = time(other).seconds_since(time(event)).abs();
                place != index
                    && is_alone(other)
                    && apart_s < CREEPS_S
                    && size::cosine(event, other) > SAME_WAY
            })
    }

    /// What people reported around the interval.
    fn reported(&self, earliest: Timestamp, latest: Timestamp) -> Vec<Cause> {
        // What happens from one time to another may change the ship all the while, but
        // cargo does so when it comes on board and when it goes.
        let near = |from: Timestamp, to: Timestamp, before_s: f64, after_s: f64| {
            earliest.seconds_since(to) < after_s && latest.seconds_since(from) > -before_s
        };
        let is_near = |entry: &&LogbookEntry| {
            let to = entry.to.unwrap_or(entry.from);
            if cause_of(entry.kind) == Some(Cause::MagneticCargo) {
                near(entry.from, entry.from, LOADED_BEFORE_S, REPORT_S)
                    || near(to, to, LOADED_BEFORE_S, REPORT_S)
            } else if entry.kind.ends_an_epoch() {
                near(entry.from, to, REPORT_S, WORKED_BEFORE_S)
            } else {
                near(entry.from, to, REPORT_S, REPORT_S)
            }
        };
        let entries = self.logbook.iter().filter(is_near);
        entries.filter_map(|entry| cause_of(entry.kind)).collect()
    }

    /// When people say that something happened between two rows.
    fn reported_between(&self, before: Timestamp, after: Timestamp) -> Option<Timestamp> {
        let said = self.logbook.iter();
        let said = said.filter(|entry| cause_of(entry.kind).is_some());
        let times = said.map(|entry| entry.from);
        times.filter(|time| before < *time && *time < after).min()
    }
}

fn evidence(event: &Event, known: &Circumstances, worst_deg: f64) -> Vec<String> {
    let [step, reference, burst, _] = event.leads;
    let mut told = vec![match event.what {
        What::Step | What::Return(_) => format!(
            "a change of the ship's own magnetism, of up to {worst_deg:.1} degrees of deviation, \
             explains the samples: {} none, {} a passing disturbance and {} a fault of the reference",
            likelier(step),
            likelier(step - burst),
            likelier(step - reference)
        ),
        What::Alignment => format!(
            "what changed is the same on every heading, and gyro and satellite compass agree: \
             that the compass's own zero moved, by {worst_deg:.1} degrees, is {} a change of the \
             ship's magnetism",
            likelier(event.over_step)
        ),
        What::Drift => format!(
            "the deviation goes on changing, by up to {worst_deg:.1} degrees so far: a drift is \
             {} one sudden change",
            likelier(event.over_step)
        ),
        What::Reference => format!(
            "what changed is the same on every heading: a fault of the reference is {} none and {} \
             a change of the ship",
            likelier(reference),
            likelier(reference - step)
        ),
        What::Burst => format!(
            "the compass went astray, but not for good: a passing disturbance is {} none and {} a \
             change of the ship",
            likelier(burst),
            likelier(burst - step)
        ),
    }];
    if event.was_step {
        told.push(
            "at first taken for a change of the ship's own magnetism, until it was gone again at sea"
                .to_owned(),
        );
    }
    match known.at_port {
        Some(true) => told.push("it began at a port call".to_owned()),
        Some(false) => told.push("it began at sea".to_owned()),
        None => {}
    }
    match known.ended_at_port {
        Some(true) => told.push("the ship was herself again after a port call".to_owned()),
        Some(false) => told.push("the ship became herself again at sea".to_owned()),
        None => {}
    }
    if known.creeps {
        told.push("another change within weeks went the same way".to_owned());
    }
    if let Some(degrees) = known.astray_deg.filter(|degrees| *degrees > WILD_DEG) {
        told.push(format!(
            "it was astray by {degrees:.0} degrees, which few storms and anomalies come to"
        ));
        if known.one_reference {
            told.push("compass or reference: there is no other reference to tell which".to_owned());
        }
    }
    if let Some(seconds) = known.burst_s.filter(|_| known.is_over) {
        told.push(format!("it lasted {:.1} hours", seconds / 3600.0));
    }
    if !known.reported.is_empty() {
        told.push("the logbook has a report of that time".to_owned());
    }
    match (event.confirmed, event.last) {
        (true, _) => {}
        (false, None) => told.push("not yet certain: more samples will tell".to_owned()),
        (false, Some(_)) => told.push(FAINT.to_owned()),
    }
    told
}

/// By how much likelier than something one is that leads it by so many nats, with the
/// temper of [`causes`]: the models are only nearly right.
fn likelier(nats: f64) -> String {
    let odds = odds(nats);
    match odds {
        ..0.7 => "less likely than".to_owned(),
        ..1.5 => "about as likely as".to_owned(),
        ..10.0 => format!("{odds:.1} times likelier than"),
        ..100.0 => format!("{:.0} times likelier than", (odds / 10.0).round() * 10.0),
        ..1000.0 => format!("{:.0} times likelier than", (odds / 100.0).round() * 100.0),
        ..1e6 => "more than a thousand times likelier than".to_owned(),
        _ => "more than a million times likelier than".to_owned(),
    }
}
