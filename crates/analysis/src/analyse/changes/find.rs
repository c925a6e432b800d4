//! Search for changes in one epoch of the logbook.

use super::findings::{Boundary, ChangeFindings, PriorKnowledge};
use super::reference_faults::{ReferenceUse, dropped_references};
use super::report::EventReporter;
use crate::analyse::epoch::Reference;
use crate::analyse::logbook_rules::reported_cause;
use crate::analyse::reading::Reading;
use crate::change::{CargoPeriod, DetectionInput, EventKind, detect};
use crate::observation::Observation;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::SampleReason;
use binnacle_compass::time::Timestamp;

/// Searches the readings of one epoch of the logbook, and marks those spoilt by a transient
/// or a failed reference.
pub(crate) fn find_changes(
    readings: &mut [Reading],
    reference: &Reference,
    logbook: &[LogbookEntry],
    known: &PriorKnowledge,
) -> ChangeFindings {
    let mut found = ChangeFindings {
        changes: Vec::new(),
        boundaries: Vec::new(),
        possible_return: None,
        undetected_step: None,
        possible_alignment: None,
        undecided_step_nt2: None,
        is_watched: true,
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
    let seen = usable.iter().filter_map(|&index| {
        ReferenceUse::from_reading(&readings[index], reference.observations[index].as_ref())
    });
    dropped_references(&seen.collect::<Vec<_>>(), &mut found.changes);
    // Observations, and the places of their readings.
    let (places, observations): (Vec<usize>, Vec<Observation>) = usable
        .into_iter()
        .filter_map(|index| Some((index, reference.observations[index]?)))
        .unzip();
    let detection = detect(
        &observations,
        &DetectionInput {
            prior: &known.prior,
            levels: known.levels.as_ref(),
            reported: &reported(logbook),
            cargo: &cargo(logbook),
        },
    );
    found.is_watched = detection.is_watched;
    let events = detection.events;
    let reporter = EventReporter {
        observations: &observations,
        logbook,
        events: &events,
    };
    let mut place_of = vec![None; events.len()];
    for (index, event) in events.iter().enumerate() {
        if let EventKind::Return(of) = event.kind {
            let place: Option<usize> = place_of.get(of).copied().flatten();
            if let Some(place) = place {
                let at = reporter.date(event.first);
                found.changes[place].ended = Some(at);
                if events[of].kind.is_lasting() {
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
        let change = reporter.report_change(index);
        if event.kind.is_lasting() && event.confirmed {
            found.boundaries.push(Boundary {
                at: change.from,
                change: found.changes.len(),
                resumes: false,
            });
        }
        let spoilt = match event.kind {
            EventKind::Transient if event.confirmed || event.last.is_none() => {
                Some(SampleReason::Disturbance)
            }
            EventKind::ReferenceFault if event.confirmed => Some(SampleReason::ReferenceFailed),
            _ => None,
        };
        if let Some(reason) = spoilt {
            for row in reporter.spoilt(index) {
                let of = &mut readings[places[row]].diagnostic.reason;
                *of = of.or(Some(reason));
            }
        }
        found.changes.push(change);
    }
    found.possible_alignment = reporter.possible_alignment(&found.changes, &place_of);
    found.undecided_step_nt2 = detection.undecided_step_nt2;
    found.undetected_step = detection
        .undetected_step
        .and_then(|undetected_step| reporter.undetected_change(&undetected_step));
    found.possible_return = detection.possible_return.and_then(|possible_return| {
        let change = place_of.get(possible_return.event).copied().flatten()?;
        let evidence = &mut found.changes[change].evidence;
        reporter.report_possible_end(&possible_return, change, evidence)
    });
    found
}

/// Returns the times at which people reported an event.
fn reported(logbook: &[LogbookEntry]) -> Vec<Timestamp> {
    let reports = logbook.iter().filter(|e| reported_cause(e.kind).is_some());
    reports
        .flat_map(|entry| [Some(entry.from), entry.to])
        .flatten()
        .collect()
}

/// Returns the entries of magnetic cargo.
fn cargo(logbook: &[LogbookEntry]) -> Vec<CargoPeriod> {
    logbook
        .iter()
        .filter(|e| e.kind == LogbookKind::MagneticCargo)
        .map(|entry| CargoPeriod {
            from: entry.from,
            to: entry.to,
        })
        .collect()
}
