//! Logbook entries of magnetic cargo: the readings with cargo, and notices of entries
//! without an end.
//!
//! Readings with cargo stay out of the model of the vessel without it, unless nothing has
//! set them apart for weeks.

use super::changes::ChangeFindings;
use super::logbook_rules::exclusion_by_entry;
use super::reading::Reading;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Cause, Epoch, SampleReason};
use binnacle_compass::time::Timestamp;

/// Time and readings after which cargo that moves the compass would have shown.
const CARGO_SHOWS_DAYS: f64 = 21.0;
const CARGO_SHOWS_READINGS: usize = 500;
const DAY_S: f64 = 86_400.0;
/// Time before an entry within which a change belongs to its cargo, seconds.
const LOADED_BEFORE_S: f64 = 2.0 * DAY_S;

/// Returns true if an epoch is one with cargo on board: it began with the cargo, or with
/// another change while laden, and was laden for most of it. Without these readings nothing
/// would be known of the vessel as it sails.
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

/// An open cargo entry that the samples contradict.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContradictedEntry {
    /// Beginning and end of the entry.
    entry: (Timestamp, Option<Timestamp>),
    /// Time since which readings are used: the entry's beginning, or the vessel's return.
    since: Timestamp,
    /// Time until which nothing has set the readings apart.
    until: Timestamp,
    /// True if the cargo changed the vessel, which has returned since.
    is_back: bool,
}

/// Includes the readings that an open entry leaves out, where nothing tells them from those
/// without cargo.
pub(super) fn include_contradicted(
    epoch: &Epoch,
    found: &ChangeFindings,
    own: &mut [Reading],
    logbook: &[LogbookEntry],
) -> Vec<ContradictedEntry> {
    let Some(until) = own.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let contradicted = |entry: &LogbookEntry| contradicted(entry, epoch, found, own);
    let contradicted: Vec<ContradictedEntry> = without_end(logbook, until)
        .filter_map(contradicted)
        .collect();
    if contradicted.is_empty() {
        return contradicted;
    }
    let cargoes = logbook
        .iter()
        .filter(|e| e.kind == LogbookKind::MagneticCargo);
    let since = |entry: &LogbookEntry| {
        contradicted
            .iter()
            .find(|i| i.entry == (entry.from, entry.to))
    };
    let cargoes: Vec<_> = cargoes
        .map(|entry| (entry, since(entry).map(|contradicted| contradicted.since)))
        .collect();
    for reading in own {
        let sample = *reading.sample();
        let excludes = |(entry, since): &(&LogbookEntry, Option<Timestamp>)| {
            exclusion_by_entry(entry, &sample).is_some()
                && since.is_none_or(|since| sample.time < since)
        };
        let is_laden = cargoes.iter().any(excludes);
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo || is_laden);
    }
    contradicted
}

/// Returns the contradicted entry and the time since which it is contradicted: its
/// beginning, or the vessel's return, if nothing had set the samples apart by the time at
/// which cargo shows.
fn contradicted(
    entry: &LogbookEntry,
    epoch: &Epoch,
    found: &ChangeFindings,
    own: &[Reading],
) -> Option<ContradictedEntry> {
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
        let many = own.get(laden + CARGO_SHOWS_READINGS)?.sample().time;
        let by = many.max(since.plus_seconds(CARGO_SHOWS_DAYS * DAY_S));
        let is_apart = found.boundaries.iter().any(|b| b.at > after && b.at <= by);
        let possible_return = found.possible_return.as_ref();
        let may_have_ended =
            possible_return.is_some_and(|ended| found.changes[ended.change].from <= by);
        let later = found.boundaries.iter().map(|b| b.at).filter(|at| *at > by);
        (until > by && !is_apart && !may_have_ended).then_some(ContradictedEntry {
            entry: (entry.from, entry.to),
            since,
            until: later.min().unwrap_or(until),
            is_back,
        })
    })
}

/// Returns the notices of open cargo entries.
pub(super) fn notices(
    readings: &[Reading],
    logbook: &[LogbookEntry],
    contradicted: &[ContradictedEntry],
) -> Vec<String> {
    let Some(until) = readings.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let entries = without_end(logbook, until).filter(|entry| entry.from < until);
    entries
        .filter_map(|entry| {
            let from = entry.from;
            let end = match entry.to {
                None => "no end".to_owned(),
                Some(to) => format!("an end only after the last sample, on {to}"),
            };
            let left_out = readings.iter().filter(|r| {
                r.sample().time >= from && r.diagnostic.reason == Some(SampleReason::MagneticCargo)
            });
            let left_out = left_out.count();
            if let Some(contradicted) = contradicted
                .iter()
                .find(|contradicted| contradicted.entry == (from, entry.to))
            {
                let days = contradicted.until.seconds_since(contradicted.since) / DAY_S;
                let reason = if contradicted.is_back {
                    format!(
                        "Since {} the samples are those of the vessel without it",
                        contradicted.since
                    )
                } else {
                    format!("In {days:.0} days nothing has set the samples apart from those before")
                };
                return Some(format!(
                    "the logbook has magnetic cargo on board since {from}, with {end}. {reason}, so \
                     they are used for the model. If the cargo was discharged, record the \
                     end of the entry"
                ));
            }
            (left_out > 0).then(|| {
                format!(
                    "{left_out} samples are left out of the model, because the logbook has magnetic \
                     cargo on board since {from}, with {end}. If it was discharged, record \
                     the end of the entry. If it is on board, the model describes the vessel \
                     without it; when nothing sets the samples apart for \
                     {CARGO_SHOWS_DAYS:.0} days, they are used again"
                )
            })
        })
        .collect()
}

/// Returns the cargo entries without an end by `until`: a mistaken year would leave out
/// samples for as long.
fn without_end(logbook: &[LogbookEntry], until: Timestamp) -> impl Iterator<Item = &LogbookEntry> {
    let entries = logbook.iter();
    entries.filter(move |entry| {
        entry.kind == LogbookKind::MagneticCargo && entry.to.is_none_or(|to| to > until)
    })
}
