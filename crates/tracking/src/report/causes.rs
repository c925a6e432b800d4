//! Causes of a detected event: its kinds by the posterior, parted by circumstances that the
//! filters do not weigh.
//!
//! A strike is lightning at sea and work in port, unless the logbook says otherwise. A passing
//! disturbance of many degrees is rather a fault of the compass.

use crate::constants::{DAY_S, IMPROBABLE, REPORTED_FACTOR, REPORTED_WITHIN_S, SAME_S};
use crate::hypotheses::hypothesis::Event;
use crate::hypotheses::kinds::Kind;
use crate::weighing::records::{Class, Detected};
use binnacle_analysis::readings::logbook_rules::reported_cause;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, CauseProbability};
use binnacle_compass::time::Timestamp;

/// Circumstances of an event that part its causes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Circumstances {
    /// Error of the compass during a passing disturbance, degrees where H is 24 µT.
    pub(super) disturbance_deg: Option<f64>,
    /// True if there was one reference only.
    pub(super) one_reference: bool,
}

impl Circumstances {
    /// Returns the error over the size of those in events of a kind.
    fn over_size(&self, kind: Kind) -> f64 {
        self.disturbance_deg.unwrap_or(0.0) / kind.row().error_deg
    }
}

/// Returns the probable causes of an event, the likeliest first.
pub(super) fn causes(
    detected: &Detected,
    logbook: &[LogbookEntry],
    circumstances: &Circumstances,
) -> Vec<CauseProbability> {
    let reported = reported(detected, logbook);
    let mut weights: Vec<CauseProbability> = Vec::new();
    let posterior = &detected.posterior;
    for (kind, probability) in posterior.kinds.iter().chain(&posterior.instead) {
        for (cause, share) in shares(*kind, &detected.event, circumstances) {
            let factor = if reported.contains(&cause) {
                REPORTED_FACTOR
            } else {
                1.0
            };
            add(&mut weights, cause, probability * share * factor);
        }
    }
    limit_to_class(detected.class, &mut weights);
    normalised(weights)
}

/// Returns the cause that is likeliest by kind and logbook.
pub(super) fn likeliest_cause(detected: &Detected, logbook: &[LogbookEntry]) -> Cause {
    let causes = causes(detected, logbook, &Circumstances::default());
    causes.first().map_or(Cause::Unknown, |first| first.cause)
}

fn add(weights: &mut Vec<CauseProbability>, cause: Cause, probability: f64) {
    match weights.iter_mut().find(|known| known.cause == cause) {
        Some(known) => known.probability += probability,
        None => weights.push(CauseProbability { cause, probability }),
    }
}

/// Returns the causes of a kind of event, each with its share: assumed, for nobody has counted
/// them. Of a hundred changes at sea ninety are lightning or a blow and ten work that nobody wrote
/// down; in port it is the other way about, and half are cargo.
fn shares(kind: Kind, event: &Event, known: &Circumstances) -> Vec<(Cause, f64)> {
    match kind {
        // Work is not undone at a port call.
        Kind::Strike if event.in_port && event.until.is_some() => vec![
            (Cause::MagneticCargo, 0.95),
            (Cause::AdjustmentOrRepair, 0.05),
        ],
        // Steel that was lifted by magnets is cargo without much induced magnetism.
        Kind::Strike if event.in_port => vec![
            (Cause::MagneticCargo, 0.5),
            (Cause::LightningOrShock, 0.1),
            (Cause::AdjustmentOrRepair, 0.4),
        ],
        Kind::Strike => vec![
            (Cause::LightningOrShock, 0.9),
            (Cause::AdjustmentOrRepair, 0.1),
        ],
        Kind::Deflection => vec![(Cause::Unknown, 1.0)],
        Kind::Cargo if event.until.is_some() => vec![(Cause::MagneticCargo, 1.0)],
        Kind::Cargo => vec![
            (Cause::MagneticCargo, 0.85),
            (Cause::AdjustmentOrRepair, 0.15),
        ],
        Kind::Alignment => vec![(Cause::Alignment, 1.0)],
        Kind::ShipDrift => vec![(Cause::Drift, 1.0)],
        Kind::FailedCard => vec![(Cause::CompassFault, 1.0)],
        Kind::Storm | Kind::SevereStorm => {
            let share = (-known.over_size(kind).powi(2)).exp();
            passing(Cause::MagneticStorm, share, known)
        }
        Kind::Anomaly => {
            let share = 1.0 / (1.0 + known.over_size(kind).powi(2));
            passing(Cause::LocalAnomaly, share, known)
        }
        Kind::GyroStep
        | Kind::SatelliteStep
        | Kind::GyroSettling
        | Kind::GyroRamp
        | Kind::FailedGyro
        | Kind::FailedSatellite => vec![(Cause::ReferenceFault, 1.0)],
    }
}

/// Returns the causes of what passes by: as large as it is, it may be a compass that swings, or a
/// lone reference. Of a hundred large errors, three and six are assumed to be.
fn passing(cause: Cause, share: f64, known: &Circumstances) -> Vec<(Cause, f64)> {
    let square = known.over_size(Kind::FailedCard).powi(2);
    let by_fault = square / (1.0 + square);
    let lone = if known.one_reference { 0.06 } else { 0.0 };
    vec![
        (cause, share),
        (Cause::CompassFault, 0.03 * by_fault),
        (Cause::ReferenceFault, lone * by_fault),
    ]
}

/// Limits the weights of causes that contradict the class of the event to the likeliest of
/// those that do not: the class was decided by the posterior, and begins an epoch or none.
fn limit_to_class(class: Class, weights: &mut [CauseProbability]) {
    let agrees = |cause: Cause| match class {
        Class::Ship => cause.changes_deviation(),
        Class::Reference => cause == Cause::ReferenceFault,
        Class::Passing => !cause.changes_deviation(),
        Class::Compass => cause == Cause::CompassFault,
    };
    let agreeing = weights.iter().filter(|weight| agrees(weight.cause));
    let most = agreeing
        .map(|weight| weight.probability)
        .fold(0.0, f64::max);
    for weight in weights.iter_mut().filter(|weight| !agrees(weight.cause)) {
        weight.probability = weight.probability.min(most);
    }
    // Of two that are as likely, the one that agrees is named first.
    weights.sort_by_key(|weight| !agrees(weight.cause));
}

/// Returns the causes with the sum 1, the likeliest first.
fn normalised(mut weights: Vec<CauseProbability>) -> Vec<CauseProbability> {
    let sum: f64 = weights.iter().map(|weight| weight.probability).sum();
    weights.retain(|weight| weight.probability >= IMPROBABLE * sum);
    let kept: f64 = weights.iter().map(|weight| weight.probability).sum();
    for weight in &mut weights {
        weight.probability /= kept;
    }
    weights.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    weights
}

/// Returns the causes that people reported at about the time of an event. They write down when they
/// noticed; work is written down as it was planned, in port by the day.
pub(super) fn reported(detected: &Detected, logbook: &[LogbookEntry]) -> Vec<Cause> {
    let event = &detected.event;
    let earliest = detected.posterior.earliest.min(event.from);
    let latest = detected.posterior.latest.max(event.from);
    let near = |from: Timestamp, to: Timestamp, after_s: f64| {
        earliest.seconds_since(to) < after_s && latest.seconds_since(from) > -REPORTED_WITHIN_S
    };
    let is_near = |entry: &&LogbookEntry| {
        let to = entry.to.unwrap_or(entry.from);
        if reported_cause(entry.kind) == Some(Cause::MagneticCargo) {
            // It changes the vessel when it is loaded and when it is discharged.
            let is_then = |time| {
                earliest.seconds_since(time) < REPORTED_WITHIN_S
                    && latest.seconds_since(time) > -SAME_S
            };
            event.in_port && (is_then(entry.from) || is_then(to))
        } else if entry.kind.ends_an_epoch() {
            let before_s = if event.in_port { DAY_S } else { SAME_S };
            near(entry.from, to, before_s)
        } else {
            near(entry.from, to, REPORTED_WITHIN_S)
        }
    };
    let entries = logbook.iter().filter(is_near);
    entries
        .filter_map(|entry| reported_cause(entry.kind))
        .collect()
}
