//! Cargo that the logbook has on board: whose readings tell of the ship as she sails, and
//! what people should know of an entry that nobody ended.
//!
//! What always holds: readings with cargo stay out of the model of the ship without it,
//! unless she has sailed so for weeks and nothing set them apart.

use super::changes::Found;
use super::logbook_rules::excludes;
use super::reading::Reading;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Cause, Epoch, SampleReason};
use binnacle_compass::time::Timestamp;

/// Cargo that was to show by now, if it moves the compass: days, and readings.
const IDLE_DAYS: f64 = 21.0;
const IDLE_READINGS: usize = 500;
const DAY_S: f64 = 86_400.0;
/// A change so long before an entry began is of its cargo, seconds.
const LOADED_BEFORE_S: f64 = 2.0 * DAY_S;

/// Returns true if an epoch is one of the ship with her cargo on board: it began with the
/// cargo, or with something else while she was laden and has been so for the most of it.
/// Without these readings nothing would be known of her as she sails.
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

/// An entry of cargo without an end that the samples no longer bear out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Idle {
    /// When the entry begins, and ends.
    entry: (Timestamp, Option<Timestamp>),
    /// Readings since then are taken: from when it began, or from when she was herself again.
    since: Timestamp,
    /// Until when nothing has set them apart.
    until: Timestamp,
    /// True if she was another with that cargo, and is herself again.
    is_back: bool,
}

/// Takes in the readings of an epoch of the logbook that an entry without an end so far leaves
/// out, where nothing tells them from those without cargo.
pub(super) fn take_idle(
    epoch: &Epoch,
    found: &Found,
    own: &mut [Reading],
    logbook: &[LogbookEntry],
) -> Vec<Idle> {
    let Some(until) = own.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let idle = |entry: &LogbookEntry| idle(entry, epoch, found, own);
    let idle: Vec<Idle> = without_end(logbook, until).filter_map(idle).collect();
    if idle.is_empty() {
        return idle;
    }
    let cargoes = logbook
        .iter()
        .filter(|e| e.kind == LogbookKind::MagneticCargo);
    let since = |entry: &LogbookEntry| idle.iter().find(|i| i.entry == (entry.from, entry.to));
    let cargoes: Vec<_> = cargoes
        .map(|entry| (entry, since(entry).map(|idle| idle.since)))
        .collect();
    for reading in own {
        let sample = *reading.sample();
        let bears_out = |(entry, since): &(&LogbookEntry, Option<Timestamp>)| {
            excludes(entry, &sample).is_some() && since.is_none_or(|since| sample.time < since)
        };
        let is_laden = cargoes.iter().any(bears_out);
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo || is_laden);
    }
    idle
}

/// Since when an entry without an end is not borne out, in an epoch of the logbook: since it
/// began, or since she was herself again, if by the time that cargo shows nothing had set the
/// samples apart.
fn idle(entry: &LogbookEntry, epoch: &Epoch, found: &Found, own: &[Reading]) -> Option<Idle> {
    let first = own.first()?.sample().time;
    let until = own.last()?.sample().time;
    let from = entry.from.max(epoch.from.unwrap_or(first)).max(first);
    let loaded = from.plus_seconds(-LOADED_BEFORE_S);
    let since_then = found.boundaries.iter().filter(|b| b.at > loaded);
    let first = since_then.clone().next();
    let is_of_cargo = |change: usize| first.is_some_and(|first| first.change == change);
    let returns = since_then.filter(|b| b.resumes && b.at > from);
    let returns = returns.map(|b| (b.at, b.at, is_of_cargo(b.change)));
    let mut starts = std::iter::once((from, loaded, false)).chain(returns);
    starts.find_map(|(since, after, is_back)| {
        let laden = own.partition_point(|r| r.sample().time < since);
        let many = own.get(laden + IDLE_READINGS)?.sample().time;
        let by = many.max(since.plus_seconds(IDLE_DAYS * DAY_S));
        let is_apart = found.boundaries.iter().any(|b| b.at > after && b.at <= by);
        let possible_return = found.possible_return.as_ref();
        let may_be = possible_return.is_some_and(|ended| found.changes[ended.change].from <= by);
        let later = found.boundaries.iter().map(|b| b.at).filter(|at| *at > by);
        (until > by && !is_apart && !may_be).then_some(Idle {
            entry: (entry.from, entry.to),
            since,
            until: later.min().unwrap_or(until),
            is_back,
        })
    })
}

/// What people should know of entries of cargo that have no end so far.
pub(super) fn notices(
    readings: &[Reading],
    logbook: &[LogbookEntry],
    idle: &[Idle],
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
            if let Some(idle) = idle.iter().find(|idle| idle.entry == (from, entry.to)) {
                let days = idle.until.seconds_since(idle.since) / DAY_S;
                let so = if idle.is_back {
                    format!(
                        "Since {} the samples are those of the ship without it",
                        idle.since
                    )
                } else {
                    format!("In {days:.0} days nothing has set the samples apart from those before")
                };
                return Some(format!(
                    "the logbook has magnetic cargo on board since {from}, and {end}. {so}, so \
                     that they are taken for the ship as she is. If the cargo was discharged, \
                     give the entry its end"
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
