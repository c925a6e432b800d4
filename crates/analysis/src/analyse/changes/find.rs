//! Search of one epoch of the logbook for changes.

use super::findings::{Boundary, Found, Known};
use super::reference_faults::{Seen, faults};
use super::report::Teller;
use crate::analyse::epoch::Reference;
use crate::analyse::logbook_rules::cause_of;
use crate::analyse::reading::Reading;
use crate::change::{CargoPeriod, DetectionInput, EventKind, detect};
use crate::observation::Observation;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::SampleReason;
use binnacle_compass::time::Timestamp;

/// Searches the readings of one epoch of the logbook and marks those that a
/// passing disturbance or a failed reference spoilt.
pub(crate) fn find(
    readings: &mut [Reading],
    reference: &Reference,
    logbook: &[LogbookEntry],
    known: &Known,
) -> Found {
    let mut found = Found {
        changes: Vec::new(),
        boundaries: Vec::new(),
        possible_return: None,
        undetected_step: None,
        misled: None,
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
    let seen = usable
        .iter()
        .filter_map(|&index| Seen::of(&readings[index], reference.observations[index].as_ref()));
    faults(&seen.collect::<Vec<_>>(), &mut found.changes);
    // The observations, and the places of the readings that they are of.
    let (places, observations): (Vec<usize>, Vec<Observation>) = usable
        .into_iter()
        .filter_map(|index| Some((index, reference.observations[index]?)))
        .unzip();
    let told = detect(
        &observations,
        &DetectionInput {
            prior: &known.prior,
            levels: known.levels.as_ref(),
            reported: &reported(logbook),
            cargo: &cargo(logbook),
        },
    );
    found.is_watched = told.is_watched;
    let events = told.events;
    let teller = Teller {
        observations: &observations,
        logbook,
        events: &events,
    };
    let mut place_of = vec![None; events.len()];
    for (index, event) in events.iter().enumerate() {
        if let EventKind::Return(of) = event.kind {
            let place: Option<usize> = place_of.get(of).copied().flatten();
            if let Some(place) = place {
                let at = teller.date(event.first);
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
        let change = teller.tell(index);
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
            for row in teller.spoilt(index) {
                let of = &mut readings[places[row]].diagnostic.reason;
                *of = of.or(Some(reason));
            }
        }
        found.changes.push(change);
    }
    found.misled = teller.misled(&found.changes, &place_of);
    found.undecided_step_nt2 = told.undecided_step_nt2;
    found.undetected_step = told
        .undetected_step
        .and_then(|undetected_step| teller.begun(&undetected_step));
    found.possible_return = told.possible_return.and_then(|possible_return| {
        let change = place_of.get(possible_return.event).copied().flatten()?;
        let evidence = &mut found.changes[change].evidence;
        teller.tell_end(&possible_return, change, evidence)
    });
    found
}

/// Times at which people say that something happened.
fn reported(logbook: &[LogbookEntry]) -> Vec<Timestamp> {
    let told = logbook.iter().filter(|e| cause_of(e.kind).is_some());
    told.flat_map(|entry| [Some(entry.from), entry.to])
        .flatten()
        .collect()
}

/// Cargo that moves the compass.
fn cargo(logbook: &[LogbookEntry]) -> Vec<CargoPeriod> {
    let told = logbook.iter();
    told.filter(|e| e.kind == LogbookKind::MagneticCargo)
        .map(|entry| CargoPeriod {
            from: entry.from,
            to: entry.to,
        })
        .collect()
}
