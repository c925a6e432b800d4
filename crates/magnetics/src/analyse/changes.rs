//! Changes found among the readings of one epoch of the logbook: the epochs that
//! they make of it, and what they say of its samples.

use super::epoch::Reference;
use super::logbook::{LogbookEntry, LogbookKind};
use super::reading::Reading;
use super::{Epoch, SampleReason};
use crate::change::{
    Cause, Change, Circumstances, Event, Given, Perhaps, Snapshot, Step, What, at_port, causes,
    detect,
};
use crate::estimate::Prior;
use crate::fit::{HeadingReading, Observation};
use crate::model::{Model, Parameters};
use crate::ship::EarthField;
use crate::time::Timestamp;

/// People write down when they noticed, not when it happened.
const REPORT_S: f64 = 2.0 * 86_400.0;
/// So many readings with a dropped reference in a row are a fault, and gaps
/// shorter than this do not end it.
const FAULT_ROWS: usize = 3;
const FAULT_GAP_S: f64 = 1.5 * 3600.0;
const DAY_S: f64 = 86_400.0;
/// What is less likely than this makes no band wider.
const SELDOM: f64 = 0.02;
const HEADINGS: u32 = 36;

/// What was found in one epoch of the logbook.
pub(super) struct Found {
    pub(super) changes: Vec<Change>,
    /// Where epochs begin beside the logbook's.
    pub(super) boundaries: Vec<Boundary>,
    /// The end that a change may have had, if that is open.
    pub(super) perhaps: Option<Ended>,
}

/// A change that may be over.
pub(super) struct Ended {
    /// When it would have ended.
    pub(super) at: Timestamp,
    /// Its place in the list.
    pub(super) change: usize,
    pub(super) probability: f64,
}

/// The beginning of an epoch that a change made.
pub(super) struct Boundary {
    pub(super) at: Timestamp,
    /// The change's place in the list.
    pub(super) change: usize,
    /// Whether the change ended here, and the ship is as she was before it.
    pub(super) resumes: bool,
}

/// An observation with the reading it is of.
struct Row {
    reading: usize,
    observation: Observation,
}

/// Searches the readings of one epoch of the logbook and marks those that a
/// passing disturbance or a failed reference spoilt.
pub(super) fn find(
    readings: &mut [Reading],
    reference: &Reference,
    logbook: &[LogbookEntry],
    prior: &Prior,
) -> Found {
    let mut found = Found {
        changes: Vec::new(),
        boundaries: Vec::new(),
        perhaps: None,
    };
    let usable = |reading: &Reading| {
        matches!(
            reading.diagnostic.reason,
            None | Some(SampleReason::MagneticCargo)
        )
    };
    let usable: Vec<usize> = (0..readings.len())
        .filter(|&index| usable(&readings[index]))
        .collect();
    let read = usable
        .iter()
        .filter_map(|&index| Some((reference.readings[index]?, reference.observations[index])));
    faults(&read.collect::<Vec<_>>(), &mut found.changes);
    let rows: Vec<Row> = usable
        .into_iter()
        .filter_map(|reading| {
            Some(Row {
                reading,
                observation: reference.observations[reading]?,
            })
        })
        .collect();
    let observations: Vec<Observation> = rows.iter().map(|row| row.observation).collect();
    let reported: Vec<Timestamp> = logbook
        .iter()
        .filter(|entry| cause_of(entry.kind).is_some())
        .flat_map(|entry| [Some(entry.from), entry.to])
        .flatten()
        .collect();
    let told = detect(
        &observations,
        &Given {
            prior,
            reported: &reported,
        },
    );
    let events = told.events;
    let teller = Teller {
        observations: &observations,
        logbook,
        events: &events,
    };
    let mut place_of = vec![None; events.len()];
    for (index, event) in events.iter().enumerate() {
        if let What::Return(of) = event.what {
            let place: Option<usize> = place_of.get(of).copied().flatten();
            if let Some(place) = place {
                let at = teller.date(event.first);
                found.changes[place].ended = Some(at);
                if events[of].what == What::Step {
                    found.boundaries.push(Boundary {
                        at,
                        change: place,
                        resumes: true,
                    });
                }
            }
            continue;
        }
        place_of[index] = Some(found.changes.len());
        let change = teller.tell(index);
        if event.what == What::Step && event.confirmed {
            found.boundaries.push(Boundary {
                at: change.from,
                change: found.changes.len(),
                resumes: false,
            });
        }
        let spoilt = match event.what {
            What::Burst => Some(SampleReason::Disturbance),
            What::Reference if event.confirmed => teller
                .one_reference()
                .then_some(SampleReason::ReferenceFailed),
            _ => None,
        };
        if let Some(reason) = spoilt {
            let last = teller.last_spoilt(index);
            for row in &rows[event.first..=last] {
                let of = &mut readings[row.reading].diagnostic.reason;
                *of = of.or(Some(reason));
            }
        }
        found.changes.push(change);
    }
    found.perhaps = told.perhaps.and_then(|perhaps| {
        let change = place_of.get(perhaps.of).copied().flatten()?;
        let evidence = &mut found.changes[change].evidence;
        teller.tell_end(&perhaps, change, evidence)
    });
    merge_faults(&mut found);
    found
}

/// Puts reference faults that follow closely on each other, or are found in two
/// ways, together.
fn merge_faults(found: &mut Found) {
    let mut order: Vec<usize> = (0..found.changes.len())
        .filter(|&i| found.changes[i].cause == Cause::ReferenceFault)
        .filter(|&i| found.boundaries.iter().all(|b| b.change != i))
        .collect();
    order.sort_by_key(|&i| found.changes[i].from);
    let mut into: Option<usize> = None;
    let mut gone = Vec::new();
    for i in order {
        let (from, ended) = (found.changes[i].from, found.changes[i].ended);
        let earlier = into.map(|into| &mut found.changes[into]);
        match earlier {
            Some(earlier)
                if earlier
                    .ended
                    .is_none_or(|end| from.seconds_since(end) < DAY_S) =>
            {
                earlier.ended = match (earlier.ended, ended) {
                    (Some(a), Some(b)) => Some(a.max(b)),
                    // A step has no end of its own; what it was part of may.
                    (one, other) => one.or(other),
                };
                let detected_at = found.changes[i].detected_at;
                let told = found.changes[i].evidence.clone();
                if let Some(earlier) = into.map(|into| &mut found.changes[into]) {
                    earlier.detected_at = earlier.detected_at.min(detected_at);
                    earlier.evidence.extend(told);
                    earlier.evidence.dedup();
                }
                gone.push(i);
            }
            _ => into = Some(i),
        }
    }
    gone.sort_unstable();
    for i in gone.into_iter().rev() {
        found.changes.remove(i);
        for boundary in &mut found.boundaries {
            if boundary.change > i {
                boundary.change -= 1;
            }
        }
        if let Some(ended) = found.perhaps.as_mut().filter(|ended| ended.change > i) {
            ended.change -= 1;
        }
    }
}

/// What an entry of the logbook is a report of.
fn cause_of(kind: LogbookKind) -> Option<Cause> {
    match kind {
        LogbookKind::Lightning | LogbookKind::Shock => Some(Cause::LightningOrShock),
        LogbookKind::MagneticCargo => Some(Cause::MagneticCargo),
        LogbookKind::Berth => Some(Cause::BerthSteel),
        LogbookKind::Note => None,
        _ => Some(Cause::AdjustmentOrRepair),
    }
}

/// Stretches over which a reference was dropped.
fn faults(readings: &[(HeadingReading, Option<Observation>)], changes: &mut Vec<Change>) {
    let mut dropped: Vec<(usize, Timestamp, &'static str)> = Vec::new();
    for (index, (reading, observation)) in readings.iter().enumerate() {
        let both = reading.gyro.is_some() && reading.satellite.is_some();
        let share = observation.as_ref().map(|o| o.gyro_share);
        let which = match share {
            None => "neither could be shown to be right",
            Some(share) if both && share < 0.01 => "the gyro had failed",
            Some(share) if both && share > 0.99 => "the satellite compass had failed",
            Some(_) => continue,
        };
        if let Some(time) = reading.time {
            dropped.push((index, time, which));
        }
    }
    let spells = dropped.chunk_by(|a, b| b.1.seconds_since(a.1) < FAULT_GAP_S);
    for spell in spells.filter(|spell| spell.len() >= FAULT_ROWS) {
        let (first, last) = (&spell[0], &spell[spell.len() - 1]);
        let before = first.0.checked_sub(1).and_then(|i| readings[i].0.time);
        let goes_on = last.0 + 1 == readings.len();
        changes.push(Change {
            from: first.1,
            from_earliest: before.unwrap_or(first.1),
            from_latest: first.1,
            detected_at: spell[FAULT_ROWS - 1].1,
            confirmed: true,
            cause: Cause::ReferenceFault,
            causes: vec![crate::change::CauseProbability {
                cause: Cause::ReferenceFault,
                probability: 1.0,
            }],
            evidence: vec![format!(
                "gyro and satellite compass parted in {} samples; held against the magnetic \
                 compass, {}",
                spell.len(),
                first.2
            )],
            deviation_change_deg: None,
            step: None,
            ended: (!goes_on).then_some(last.1),
        });
    }
}

/// Puts events into words and dates.
struct Teller<'a> {
    observations: &'a [Observation],
    logbook: &'a [LogbookEntry],
    events: &'a [Event],
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

    /// Between the row and the one before.
    fn date(&self, row: usize) -> Timestamp {
        let Some(before) = row.checked_sub(1) else {
            return self.time(row);
        };
        let gap_s = self.time(row).seconds_since(self.time(before));
        self.time(before).plus_seconds(gap_s / 2.0)
    }

    /// Whether any of the rows from which the event may date followed a port call.
    fn began_at_port(&self, event: &Event) -> Option<bool> {
        let (earliest, latest) = event.between;
        let calls = (earliest..=latest).map(|row| at_port(self.observations, row));
        calls.reduce(|a, b| Some(a? || b?)).flatten()
    }

    fn one_reference(&self) -> bool {
        let mut all = self.observations.iter();
        all.all(|o| o.gyro_less_satellite_deg.is_none())
    }

    /// The last row that an event spoilt: a burst's, or that before a reference was
    /// itself again.
    fn last_spoilt(&self, index: usize) -> usize {
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

    fn is_mended(&self, event: &Event) -> bool {
        match event.what {
            What::Return(of) => self.events[of].what == What::Reference,
            _ => false,
        }
    }

    fn tell(&self, index: usize) -> Change {
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
        let known = Circumstances {
            leads: event.leads,
            at_port: self.began_at_port(event),
            ended_at_port: back.and_then(|later| self.began_at_port(later)),
            burst_s: event
                .last
                .map(|last| self.time(last).seconds_since(self.time(event.first))),
            told_after_s: self.time(event.told).seconds_since(from),
            reported: self.reported(from_earliest, from_latest),
        };
        let causes = causes(event.what, &known);
        let is_step = event.what == What::Step;
        let worst = worst_change(
            &event.before.parameters,
            &event.after.parameters,
            self.earth(event.told),
        );
        Change {
            from,
            from_earliest: from_earliest.min(from),
            from_latest: from_latest.max(from),
            detected_at: self.time(event.told),
            confirmed: event.confirmed,
            cause: causes.first().map_or(Cause::Unknown, |c| c.cause),
            evidence: evidence(event, &known, worst),
            causes,
            deviation_change_deg: is_step.then_some(worst),
            step: is_step.then(|| step(&event.before, &event.after)),
            ended: ended_row.map(|row| self.time(row)),
        }
    }

    /// That a change may be over, if that is neither certain nor out of question.
    fn tell_end(
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

    /// What people reported around the interval.
    fn reported(&self, earliest: Timestamp, latest: Timestamp) -> Vec<Cause> {
        let near = |time: Timestamp| {
            time.seconds_since(earliest) > -REPORT_S && latest.seconds_since(time) > -REPORT_S
        };
        let entries = self.logbook.iter().filter(|entry| near(entry.from));
        entries.filter_map(|entry| cause_of(entry.kind)).collect()
    }
}

fn evidence(event: &Event, known: &Circumstances, worst_deg: f64) -> Vec<String> {
    let [step, reference, burst, _] = event.leads;
    let mut told = vec![match event.what {
        What::Step | What::Return(_) => format!(
            "samples since then fit a change of the ship's own magnetism, up to {worst_deg:.1} \
             degrees of deviation, better by {step:.0} nats than none; a passing disturbance by \
             {burst:.0}, a fault of the reference by {reference:.0}"
        ),
        What::Reference => format!(
            "the change is the same on every heading: a fault of the reference explains it \
             better by {reference:.0} nats than none, a change of the ship by {step:.0}"
        ),
        What::Burst => format!(
            "variation went astray and came back: a passing disturbance explains it better by \
             {burst:.0} nats than none, a change of the ship by {step:.0}"
        ),
    }];
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
    if let Some(seconds) = known.burst_s {
        told.push(format!("it lasted {:.1} hours", seconds / 3600.0));
    }
    if !known.reported.is_empty() {
        told.push("the logbook has a report of that time".to_owned());
    }
    if !event.confirmed {
        told.push("not yet certain: more samples will tell".to_owned());
    }
    told
}

/// The largest change of deviation over headings in a field, degrees.
fn worst_change(before: &Parameters, after: &Parameters, earth: EarthField) -> f64 {
    (0..HEADINGS)
        .map(|k| {
            let magnetic = f64::from(k * 360 / HEADINGS).to_radians();
            let compass = |p: &Parameters| {
                let [x, y] = p.field_over_lambda(magnetic, earth);
                crate::ship::compass_rad(x, y)
            };
            crate::ship::wrap_pi(compass(before) - compass(after)).abs()
        })
        .fold(0.0, f64::max)
        .to_degrees()
}

fn step(before: &Snapshot, after: &Snapshot) -> Step {
    let se = |j: usize| {
        (before.covariance[j][j] + after.covariance[j][j])
            .max(0.0)
            .sqrt()
    };
    Step {
        bx_nt: after.parameters.bx_nt - before.parameters.bx_nt,
        by_nt: after.parameters.by_nt - before.parameters.by_nt,
        bx_se_nt: se(0),
        by_se_nt: se(2),
    }
}

/// Says the step anew by the models of the epochs on both sides.
pub(super) fn sharpen(change: &mut Change, before: &Epoch, after: &Epoch, readings: &[Reading]) {
    let (Some(old), Some(new)) = (&before.model, &after.model) else {
        return;
    };
    let mut until = readings
        .iter()
        .filter(|r| r.sample.time <= change.detected_at);
    let Some(earth) = until.next_back().and_then(|reading| reading.earth) else {
        return;
    };
    let (Some(old), Some(new)) = (of_model(old), of_model(new)) else {
        return;
    };
    change.step = Some(step(&old, &new));
    change.deviation_change_deg = Some(worst_change(&old.parameters, &new.parameters, earth));
}

fn of_model(model: &Model) -> Option<Snapshot> {
    Some(Snapshot {
        parameters: model.parameters_over_lambda,
        covariance: model.covariance?,
    })
}
