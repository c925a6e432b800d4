//! Events of one subject that overlap in time: one change to whoever reads of them.
//!
//! A hypothesis may hold a storm and an anomaly at once, or two faults of one gyro, because
//! together they explain the samples better than either.

use super::faults::{end, reference};
use crate::constants::HOUR_S;
use crate::weighing::records::{Class, Detected};
use binnacle_compass::time::Timestamp;

/// Merges events of one subject, the ship excepted, that overlap in time by now, or follow each
/// other within an hour.
pub(super) fn merge_overlapping(detected: &[Detected], now: Option<Timestamp>) -> Vec<Detected> {
    let mut merged: Vec<Detected> = Vec::with_capacity(detected.len());
    for next in detected {
        let mut next = next.clone();
        next.event.until = now.and_then(|now| end(&next, now));
        let same = merged.iter_mut().find(|known| is_one(known, &next));
        match same {
            Some(known) => merge(known, &next),
            None => merged.push(next),
        }
    }
    merged
}

fn is_one(a: &Detected, b: &Detected) -> bool {
    let is_of_one_subject = a.class == b.class
        && a.class != Class::Ship
        && reference(a.event.kind) == reference(b.event.kind);
    let is_in_force = a.withdrawn.is_none() && b.withdrawn.is_none();
    let begins_in = |one: &Detected, other: &Detected| {
        let until = other.event.until;
        one.event.from >= other.event.from
            && until.is_none_or(|until| one.event.from.seconds_since(until) < HOUR_S)
    };
    is_of_one_subject && is_in_force && (begins_in(a, b) || begins_in(b, a))
}

/// Merges an event into another: the longer one names both.
fn merge(known: &mut Detected, next: &Detected) {
    let until = known.event.until.zip(next.event.until);
    let until = until.map(|(a, b)| a.max(b));
    let lasts_s = |of: &Detected| {
        let until = of.event.until;
        until.map_or(f64::INFINITY, |until| until.seconds_since(of.event.from))
    };
    let at = known.at.min(next.at);
    let from = known.event.from.min(next.event.from);
    let earliest = known.posterior.earliest.min(next.posterior.earliest);
    if lasts_s(next) > lasts_s(known) {
        *known = next.clone();
    }
    if from < known.event.from {
        known.posterior.latest = from;
    }
    (known.at, known.event.from, known.event.until) = (at, from, until);
    known.posterior.earliest = earliest;
}
