//! A detected or suspected event as a change.

use super::evidence::{Facts, evidence};
use super::size::Sides;
use crate::report::causes::{Circumstances, causes};
use crate::report::faults::end;
use crate::report::row_times::RowTimes;
use crate::weighing::records::{Class, Detected};
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, Change};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;

/// Returns the change that an event is; the sides are those of a change of the ship.
pub(super) fn change(
    detected: &Detected,
    facts: &Facts,
    sides: Option<Sides<'_>>,
    earth: Option<EarthField>,
    times: &RowTimes<'_>,
    logbook: &[LogbookEntry],
) -> Change {
    let circumstances = Circumstances {
        disturbance_deg: facts.disturbance.map(|disturbance| disturbance.nominal_deg),
        one_reference: facts.one_reference,
    };
    let causes = causes(detected, logbook, &circumstances);
    let cause = causes.first().map_or(Cause::Unknown, |first| first.cause);
    let from = times.date(detected.event.from);
    let latest = detected.posterior.latest.max(detected.event.from);
    let sides = sides.filter(|_| detected.withdrawn.is_none());
    let is_alignment = cause == Cause::Alignment;
    let deviation_change_deg = match sides {
        Some(sides) if is_alignment => Some(sides.alignment_change_deg()),
        Some(sides) => earth.map(|earth| sides.worst_change_deg(earth)),
        None => None,
    };
    Change {
        from,
        from_earliest: detected.posterior.earliest.min(from),
        from_latest: times.next(latest).unwrap_or(latest).max(from),
        detected_at: detected.at,
        confirmed: facts.is_certain && detected.withdrawn.is_none(),
        withdrawn: detected.withdrawn.is_some(),
        cause,
        causes,
        evidence: evidence(detected, facts),
        deviation_change_deg,
        step: sides.filter(|_| !is_alignment).map(Sides::step),
        ended: ended(detected, facts, times, from),
        position: None,
        disturbed_deg: None,
    }
}

/// Returns the end of a change. One that was withdrawn ended with its withdrawal, and one at a
/// discharge left with the cargo.
fn ended(
    detected: &Detected,
    facts: &Facts,
    times: &RowTimes<'_>,
    from: Timestamp,
) -> Option<Timestamp> {
    if detected.withdrawn.is_some() {
        return detected.withdrawn;
    }
    if facts.is_discharge {
        return Some(from);
    }
    let end = end(detected, times.last()?)?;
    Some(match detected.class {
        Class::Ship => times.date(end),
        Class::Reference | Class::Passing | Class::Compass => end,
    })
}
