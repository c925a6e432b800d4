//! Logbook entries of magnetic cargo: readings with cargo, and notices of entries without an
//! end.
//!
//! While the logbook has cargo on board, the posterior holds both the vessel with cargo and
//! the vessel that the cargo leaves as it was. Samples of that time are no evidence of the
//! vessel without cargo: they are not counted, and only the second hypothesis learns from
//! them. They count in an epoch of the vessel with cargo, and where nothing has set them apart
//! for weeks.

use super::epochs::Span;
use super::past::{Past, Piece};
use crate::constants::{DAY_S, KEPT_ROWS, REPORTED_WITHIN_S, SETTLED_S};
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Cause, SampleReason};
use binnacle_compass::time::Timestamp;

/// Open cargo entry that the samples contradict.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContradictedEntry {
    /// Beginning and end of the entry.
    from: Timestamp,
    to: Option<Timestamp>,
    /// Time since which readings are used: the entry's beginning, or the vessel's return.
    since: Timestamp,
    /// Time until which nothing has set the readings apart.
    until: Timestamp,
    /// True if the cargo changed the vessel, which has returned since.
    is_back: bool,
}

/// Includes the readings of epochs with cargo on board.
pub(super) fn include_laden(spans: &[Span<'_>], readings: &mut [Reading]) {
    for span in spans {
        let own = &mut readings[span.own.clone()];
        if !is_laden(span, own) {
            continue;
        }
        for reading in own {
            let reason = &mut reading.diagnostic.reason;
            *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo);
        }
    }
}

/// Returns true if an epoch is one with cargo on board: it began with the cargo, or with
/// another change while laden, and was laden for most of it.
fn is_laden(span: &Span<'_>, own: &[Reading]) -> bool {
    let Some(cause) = span.begun_by_change.filter(|_| !span.is_return) else {
        return false;
    };
    let count = |reason: Option<SampleReason>| {
        let found = own.iter().filter(|r| r.diagnostic.reason == reason);
        found.count() as u64
    };
    let past = |of: fn(&Piece) -> u64| span.past.iter().map(of).sum::<u64>();
    let laden = count(Some(SampleReason::MagneticCargo)) + past(|piece| piece.laden);
    cause == Cause::MagneticCargo || laden > count(None) + past(|piece| piece.free)
}

/// Includes the readings that an open entry leaves out, where nothing sets them apart from
/// those without cargo.
pub(super) fn include_contradicted(
    spans: &[Span<'_>],
    readings: &mut [Reading],
    past: &Past,
    logbook: &[LogbookEntry],
) -> Vec<ContradictedEntry> {
    let Some(until) = readings.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let entries = without_end(logbook, until);
    let contradicted: Vec<ContradictedEntry> = entries
        .filter_map(|entry| contradicted(entry, spans, readings, past))
        .collect();
    if contradicted.is_empty() {
        return contradicted;
    }
    let cargoes = logbook
        .iter()
        .filter(|entry| entry.kind == LogbookKind::MagneticCargo);
    let excluded: Vec<(Timestamp, Option<Timestamp>)> = cargoes
        .map(|entry| {
            let found = contradicted
                .iter()
                .find(|found| (found.from, found.to) == (entry.from, entry.to));
            let ended = found.map(|found| found.since);
            (entry.from, ended.or(entry.to))
        })
        .collect();
    for reading in readings {
        let time = reading.sample().time;
        let is_laden = excluded
            .iter()
            .any(|(from, to)| *from <= time && to.is_none_or(|to| time < to));
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo || is_laden);
    }
    contradicted
}

/// Returns the contradicted entry, if nothing had set the samples apart by the time at which
/// cargo shows: since its beginning, or since the vessel's return.
fn contradicted(
    entry: &LogbookEntry,
    spans: &[Span<'_>],
    readings: &[Reading],
    past: &Past,
) -> Option<ContradictedEntry> {
    let first = past.from().or(readings.first().map(|r| r.sample().time))?;
    let until = readings.last()?.sample().time;
    let from = entry.from.max(first);
    let loaded = from.plus_seconds(-REPORTED_WITHIN_S);
    let begun = || spans.iter().filter_map(|span| Some((span.from?, span)));
    let first_since = begun().find(|(at, _)| *at > loaded).map(|(_, span)| span);
    let returns = begun().filter(|(at, span)| span.is_return && *at > from);
    let returns = returns.map(|(at, span)| {
        let is_of_cargo = first_since.is_some_and(|begin| begin.event == span.event);
        (at, at, is_of_cargo)
    });
    let mut starts = std::iter::once((from, loaded, false)).chain(returns);
    starts.find_map(|(since, after, is_back)| {
        let many = shown(since, readings, past)?;
        let by = many.max(since.plus_seconds(SETTLED_S));
        let is_apart = begun().any(|(at, _)| at > after && at <= by);
        let later = begun().map(|(at, _)| at).find(|at| *at > by);
        (until > by && !is_apart).then_some(ContradictedEntry {
            from: entry.from,
            to: entry.to,
            since,
            until: later.unwrap_or(until),
            is_back,
        })
    })
}

/// Returns the time by which there are enough readings since another for cargo to show.
fn shown(since: Timestamp, readings: &[Reading], past: &Past) -> Option<Timestamp> {
    let mut wanting = KEPT_ROWS as u64;
    for piece in past.pieces.iter().filter(|piece| piece.from >= since) {
        let Some(left) = wanting.checked_sub(piece.readings) else {
            return Some(piece.until);
        };
        wanting = left;
    }
    let laden = readings.partition_point(|r| r.sample().time < since);
    let shown = readings.get(laden + wanting as usize)?;
    Some(shown.sample().time)
}

/// Returns the notices of open cargo entries.
pub(super) fn notices(
    readings: &[Reading],
    past: &Past,
    logbook: &[LogbookEntry],
    contradicted: &[ContradictedEntry],
) -> Vec<String> {
    let Some(until) = readings.last().map(|r| r.sample().time) else {
        return Vec::new();
    };
    let entries = without_end(logbook, until).filter(|entry| entry.from < until);
    entries
        .filter_map(|entry| {
            let found = contradicted
                .iter()
                .find(|found| (found.from, found.to) == (entry.from, entry.to));
            match found {
                Some(found) => Some(contradiction(entry, found)),
                None => exclusion(entry, readings, past),
            }
        })
        .collect()
}

fn end_in_words(entry: &LogbookEntry) -> String {
    match entry.to {
        None => "no end".to_owned(),
        Some(to) => format!("an end only after the last sample, on {to}"),
    }
}

/// Returns the notice of an entry that the samples contradict.
fn contradiction(entry: &LogbookEntry, found: &ContradictedEntry) -> String {
    let reason = if found.is_back {
        format!(
            "Since {} the samples are those of the vessel without it",
            found.since
        )
    } else {
        let days = found.until.seconds_since(found.since) / DAY_S;
        format!("In {days:.0} days nothing has set the samples apart from those before")
    };
    format!(
        "the logbook has magnetic cargo on board since {}, with {}. {reason}, so they are used \
         for the model. If the cargo was discharged, record the end of the entry",
        entry.from,
        end_in_words(entry)
    )
}

/// Returns the notice of an entry that leaves samples out.
fn exclusion(entry: &LogbookEntry, readings: &[Reading], past: &Past) -> Option<String> {
    let left_out = readings.iter().filter(|r| {
        r.sample().time >= entry.from && r.diagnostic.reason == Some(SampleReason::MagneticCargo)
    });
    let settled = past.pieces.iter().filter(|piece| piece.until >= entry.from);
    let settled: u64 = settled.map(|piece| piece.left_out_laden).sum();
    let left_out = settled + left_out.count() as u64;
    (left_out > 0).then(|| {
        format!(
            "{left_out} samples are left out of the model, because the logbook has magnetic cargo \
             on board since {}, with {}. If it was discharged, record the end of the entry. If \
             it is on board, the band allows for a change by it; when nothing sets the samples \
             apart for {:.0} days, they are used again",
            entry.from,
            end_in_words(entry),
            SETTLED_S / DAY_S
        )
    })
}

/// Returns the cargo entries without an end by `until`: a mistaken year would leave out
/// samples for as long.
fn without_end(logbook: &[LogbookEntry], until: Timestamp) -> impl Iterator<Item = &LogbookEntry> {
    let entries = logbook.iter();
    entries.filter(move |entry| {
        entry.kind == LogbookKind::MagneticCargo && entry.to.is_none_or(|to| to > until)
    })
}
