//! Changes found among the readings of one epoch of the logbook: the epochs that
//! they make of it, and what they say of its samples.

mod evidence;
mod fault;
mod size;
mod teller;

pub(super) use fault::merge_faults;
pub(super) use size::sharpen;

use super::epoch::Reference;
use super::reading::Reading;
use crate::change::{Given, Loaded, What, detect};
use crate::estimate::Prior;
use crate::observation::Observation;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Cause, Change, NoiseLevels, SampleReason};
use binnacle_compass::time::Timestamp;
use fault::{Seen, faults};
use teller::Teller;

/// Work may have been done so long before the logbook says so, or after, seconds: people
/// write down when they noticed, or what was planned.
pub(super) const MISTIMED_S: f64 = 86_400.0;

/// What was found in one epoch of the logbook.
pub(super) struct Found {
    pub(super) changes: Vec<Change>,
    /// Where epochs begin beside the logbook's.
    pub(super) boundaries: Vec<Boundary>,
    /// The end that a change may have had, if that is open.
    pub(super) perhaps: Option<Ended>,
    /// A change that may have begun at a port call, and has not been told.
    pub(super) unnoticed: Option<Begun>,
    /// A zero that may have moved in place of the only reference's.
    pub(super) misled: Option<Misled>,
    /// What a step that is not certain may have done to bx and by, variance in nT².
    pub(super) open_nt2: Option<f64>,
    /// Whether a change would have been noticed.
    pub(super) is_watched: bool,
}

impl Found {
    /// When the work was done of which the logbook says that it was done at a time soon
    /// after: people write down when they noticed.
    pub(super) fn reported_late(&self, said: Timestamp) -> Option<Timestamp> {
        let last = self.boundaries.last().filter(|last| !last.resumes)?;
        (self.is_work(last) && said.seconds_since(last.at) < MISTIMED_S).then_some(last.at)
    }

    /// When the work was done of which the logbook says that it was done at a time before.
    pub(super) fn reported_early(&self, said: Timestamp) -> Option<Timestamp> {
        let mut later = self.boundaries.iter().filter(|boundary| boundary.at > said);
        let first = later.next().filter(|first| !first.resumes)?;
        let after_s = self.changes[first.change].from_earliest.seconds_since(said);
        let is_later = after_s > 0.0 && after_s < MISTIMED_S;
        (self.is_work(first) && is_later).then_some(first.at)
    }

    fn is_work(&self, boundary: &Boundary) -> bool {
        self.changes[boundary.change].cause == Cause::AdjustmentOrRepair
    }
}

/// A change that may be over.
pub(super) struct Ended {
    /// When it would have ended.
    pub(super) at: Timestamp,
    /// Its place in the list.
    pub(super) change: usize,
    pub(super) probability: f64,
}

/// A change that may have begun.
pub(super) struct Begun {
    pub(super) at: Timestamp,
    pub(super) probability: f64,
}

/// A compass whose zero may have moved, by so much, degrees, with that variance.
pub(super) struct Misled {
    pub(super) moved_deg: f64,
    pub(super) variance: f64,
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

/// What is known beforehand of the ship and of her instruments' noise.
pub(super) struct Known {
    pub(super) prior: Prior,
    pub(super) levels: Option<NoiseLevels>,
}

/// Searches the readings of one epoch of the logbook and marks those that a
/// passing disturbance or a failed reference spoilt.
pub(super) fn find(
    readings: &mut [Reading],
    reference: &Reference,
    logbook: &[LogbookEntry],
    known: &Known,
) -> Found {
    let mut found = Found {
        changes: Vec::new(),
        boundaries: Vec::new(),
        perhaps: None,
        unnoticed: None,
        misled: None,
        open_nt2: None,
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
        &Given {
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
        if let What::Return(of) = event.what {
            let place: Option<usize> = place_of.get(of).copied().flatten();
            if let Some(place) = place {
                let at = teller.date(event.first);
                found.changes[place].ended = Some(at);
                if events[of].what.is_lasting() {
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
        if event.what.is_lasting() && event.confirmed {
            found.boundaries.push(Boundary {
                at: change.from,
                change: found.changes.len(),
                resumes: false,
            });
        }
        let spoilt = match event.what {
            What::Burst if event.confirmed || event.last.is_none() => {
                Some(SampleReason::Disturbance)
            }
            What::Reference if event.confirmed => Some(SampleReason::ReferenceFailed),
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
    found.open_nt2 = told.open_nt2;
    found.unnoticed = told
        .unnoticed
        .and_then(|unnoticed| teller.begun(&unnoticed));
    found.perhaps = told.perhaps.and_then(|perhaps| {
        let change = place_of.get(perhaps.of).copied().flatten()?;
        let evidence = &mut found.changes[change].evidence;
        teller.tell_end(&perhaps, change, evidence)
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
fn cargo(logbook: &[LogbookEntry]) -> Vec<Loaded> {
    let told = logbook.iter();
    told.filter(|e| e.kind == LogbookKind::MagneticCargo)
        .map(|entry| Loaded {
            from: entry.from,
            to: entry.to,
        })
        .collect()
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
