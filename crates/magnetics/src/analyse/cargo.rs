//! Cargo that the logbook has on board: whose readings tell of the ship as she sails, and
//! what people should know of an entry that nobody ended.
//!
//! What always holds: readings with cargo stay out of the model of the ship without it,
//! unless she has sailed so for weeks and nothing set them apart.

use super::changes::Found;
use super::course::Course;
use super::logbook::{LogbookEntry, LogbookKind};
use super::reading::Reading;
use super::{Epoch, SampleReason};
use crate::change::Cause;
use crate::time::Timestamp;

/// Cargo that was to show by now, if it moves the compass: days, and readings.
const IDLE_DAYS: f64 = 21.0;
const IDLE_READINGS: usize = 500;
const DAY_S: f64 = 86_400.0;
/// A change so long before an entry began is of its cargo, seconds.
const LOADED_BEFORE_S: f64 = 2.0 * DAY_S;

/// Whether an epoch is one of the ship with her cargo on board: it began with the cargo, or
/// with something else while she was laden and has been so for the most of it. Without
/// these readings nothing would be known of her as she sails.
pub(super) fn is_laden(epoch: &Epoch, own: &[Reading]) -> bool {
    if epoch.resumes.is_some() {
        return false;
    }
    if epoch.begun_by_change == Some(Cause::MagneticCargo) {
        return true;
    }
    let with_reason = |reason: Option<SampleReason>| {
        let such = own.iter().filter(|r| r.diagnostic.reason == reason);
        such.count()
    };
    epoch.begun_by_change.is_some()
        && with_reason(Some(SampleReason::MagneticCargo)) > with_reason(None)
}

/// Takes in the readings of an epoch of the logbook that an entry without an end so far leaves
/// out, if by now nothing has told them from those without cargo; when those entries began.
pub(super) fn take_idle(
    epoch: &Epoch,
    found: &Found,
    own: &mut [Reading],
    logbook: &[LogbookEntry],
) -> Vec<Timestamp> {
    let Some(until) = own.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let mut idle = Vec::new();
    for entry in without_end(logbook, until) {
        let from = epoch.from.map_or(entry.from, |begun| begun.max(entry.from));
        let loaded = from.plus_seconds(-LOADED_BEFORE_S);
        let changed = found.boundaries.iter().any(|b| b.at > loaded);
        let laden = own.partition_point(|r| r.sample().time < from);
        let is_long =
            until.seconds_since(from) > IDLE_DAYS * DAY_S && own.len() - laden > IDLE_READINGS;
        if is_long && !changed && found.perhaps.is_none() {
            idle.push(entry.from);
        }
    }
    if idle.is_empty() {
        return idle;
    }
    let is_other = |entry: &&LogbookEntry| {
        entry.kind == LogbookKind::MagneticCargo && !idle.contains(&entry.from)
    };
    let others: Vec<&LogbookEntry> = logbook.iter().filter(is_other).collect();
    for reading in own {
        let sample = *reading.sample();
        let is_idle = others.iter().all(|entry| entry.excludes(&sample).is_none());
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo || !is_idle);
    }
    idle
}

/// What people should know of entries of cargo that have no end so far.
pub(super) fn notices(
    readings: &[Reading],
    logbook: &[LogbookEntry],
    course: &Course,
) -> Vec<String> {
    let Some(until) = readings.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let entries = without_end(logbook, until).filter(|entry| entry.from < until);
    entries
        .filter_map(|entry| {
            let from = entry.from;
            let end = match entry.to {
                None => "no end of it".to_owned(),
                Some(to) => format!("its end only after the last sample, on {to}"),
            };
            let left_out = readings.iter().filter(|r| {
                r.sample().time >= from && r.diagnostic.reason == Some(SampleReason::MagneticCargo)
            });
            let left_out = left_out.count();
            if course.idle.contains(&from) {
                let days = until.seconds_since(from) / DAY_S;
                return Some(format!(
                    "the logbook has magnetic cargo on board since {from}, and {end}. In \
                     {days:.0} days nothing has set the samples apart from those before, so that \
                     they are taken for the ship as she is. If the cargo was discharged, give the \
                     entry its end"
                ));
            }
            (left_out > 0).then(|| {
                format!(
                    "{left_out} samples are left out of the model, for the logbook has magnetic \
                     cargo on board since {from}, and {end}. If it was discharged, give \
                     the entry its end. If it is on board, the model is of the ship without it; \
                     when nothing sets the samples apart for {IDLE_DAYS:.0} days, they are taken \
                     again"
                )
            })
        })
        .collect()
}

/// Entries of cargo that have no end, or none by `until`: a year mistaken would leave samples
/// out for as long.
fn without_end(logbook: &[LogbookEntry], until: Timestamp) -> impl Iterator<Item = &LogbookEntry> {
    let entries = logbook.iter();
    entries.filter(move |entry| {
        entry.kind == LogbookKind::MagneticCargo && entry.to.is_none_or(|to| to > until)
    })
}
