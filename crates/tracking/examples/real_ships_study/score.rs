//! False reports of an analysis, and what becomes of reports as a voyage grows.

use crate::voyages::fleet::{Happened, Log, Name};
use binnacle_compass::result::{Analysis, Cause, Change};

pub(crate) const HOUR_S: f64 = 3600.0;
pub(crate) const DAY_S: f64 = 86_400.0;

/// False reports in one analysis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FalseReports {
    /// Changes of the ship.
    pub(crate) ship: usize,
    /// Faults of a reference.
    pub(crate) reference: usize,
    /// Passing disturbances.
    pub(crate) passing: usize,
}

/// Group of reports that have the same consequence.
#[derive(Clone, Copy, PartialEq)]
enum Group {
    Ship,
    Reference,
    Passing,
}

/// Returns the group of a report; none for a suspicion, and for faults of the compass. A
/// withdrawn report was a report.
fn group(change: &Change) -> Option<Group> {
    if !change.confirmed && !change.withdrawn {
        return None;
    }
    match change.cause {
        cause if cause.changes_deviation() => Some(Group::Ship),
        Cause::ReferenceFault => Some(Group::Reference),
        cause if cause.is_transient() => Some(Group::Passing),
        _ => None,
    }
}

/// Returns the group of reports that an event deserves.
fn deserved(what: Name) -> Option<Group> {
    match what {
        Name::GyroFault | Name::Settling | Name::GyroRamp => Some(Group::Reference),
        Name::Storm | Name::Anomaly | Name::Brief => Some(Group::Passing),
        Name::Jam => None,
        _ => Some(Group::Ship),
    }
}

impl FalseReports {
    pub(crate) fn of(analysis: &Analysis, log: &Log) -> FalseReports {
        let mut found = FalseReports::default();
        for change in false_reports(analysis, log) {
            match group(change) {
                Some(Group::Ship) => found.ship += 1,
                Some(Group::Reference) => found.reference += 1,
                Some(Group::Passing) => found.passing += 1,
                None => {}
            }
        }
        found
    }
}

/// Returns the reports that no event deserves.
fn false_reports<'a>(analysis: &'a Analysis, log: &'a Log) -> impl Iterator<Item = &'a Change> {
    analysis.changes.iter().filter(|change| {
        let group = group(change);
        let mut happened = log.happened.iter();
        group.is_some()
            && !happened.any(|h| {
                (deserved(h.what) == group && near(h, change)) || is_decay_after_dock(h, change)
            })
    })
}

/// Days over which a ship's magnetism decays after a dry dock, to a twentieth.
const DECAY_DAYS: f64 = 90.0;

/// Returns true if a change is the drift after a dry dock.
fn is_decay_after_dock(happened: &Happened, change: &Change) -> bool {
    let days = change.from.seconds_since(happened.from) / DAY_S;
    happened.what == Name::DryDock
        && change.cause == Cause::Drift
        && (0.0..DECAY_DAYS).contains(&days)
}

/// Prints the false reports of a ship.
pub(crate) fn print_false_reports(seed: u64, analysis: &Analysis, log: &Log) {
    for change in false_reports(analysis, log) {
        let hours = change.detected_at.seconds_since(change.from) / HOUR_S;
        let withdrawn = if change.withdrawn { ", withdrawn" } else { "" };
        println!(
            "  seed {seed} {:?}{withdrawn} {} +{hours:.1} h {:?}",
            change.cause, change.from, change.evidence
        );
        for h in log.happened.iter().filter(|h| near(h, change)) {
            println!("    near {:?} from {}", h.what, h.from);
        }
    }
}

/// Returns true if a change can be this event.
pub(crate) fn near(happened: &Happened, change: &Change) -> bool {
    let end = happened.to.unwrap_or(happened.from);
    let ended = change.ended.unwrap_or(change.from).max(change.from_latest);
    ended >= happened.from.plus_seconds(-0.5 * DAY_S)
        && change.from_earliest <= end.plus_seconds(0.5 * DAY_S)
}

/// Days over which a report can have been dated anew.
const REDATED_DAYS: f64 = 10.0;

/// Reports that did not stay as the voyage grew.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Unstable {
    pub(crate) vanished: usize,
    pub(crate) withdrawn: usize,
    pub(crate) renamed: usize,
    /// Dated anew under the same name, outside the credible time stated before.
    pub(crate) redated: usize,
}

impl Unstable {
    /// Counts what became of the reports of an earlier look.
    pub(crate) fn add(&mut self, before: &Analysis, after: &Analysis) {
        for change in before.changes.iter().filter(|c| c.confirmed) {
            let within = |days: f64| {
                let near = after.changes.iter().filter(move |later| {
                    later.from_earliest.seconds_since(change.from_latest) < days * DAY_S
                        && change.from_earliest.seconds_since(later.from_latest) < days * DAY_S
                });
                near.collect::<Vec<&Change>>()
            };
            let is_same = |c: &&Change| c.confirmed && c.cause == change.cause;
            let (here, near) = (within(1.0), within(REDATED_DAYS));
            if here.iter().any(is_same) {
                continue;
            }
            if here.iter().any(|c| c.withdrawn) {
                self.withdrawn += 1;
            } else if here.iter().any(|c| c.confirmed) {
                self.renamed += 1;
            } else if near.iter().any(is_same) {
                self.redated += 1;
            } else {
                self.vanished += 1;
            }
        }
    }
}
