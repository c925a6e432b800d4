//! Causes of a detected event: its kinds by the posterior, parted by circumstances that the
//! filters do not weigh.
//!
//! A strike is lightning at sea and work in port, unless the logbook says otherwise. A passing
//! disturbance of many degrees is rather a fault of the compass.

use crate::hypotheses::hypothesis::Event;
use crate::hypotheses::kinds::Kind;
use crate::weighing::records::{Class, Detected};
use binnacle_analysis::readings::logbook_rules::reported_cause;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, CauseProbability};
use binnacle_compass::time::Timestamp;

/// Factor on the weight of a cause that people reported at the time.
const REPORTED_FACTOR: f64 = 100.0;
/// Probability that a strike by which a vessel changed at sea, or in port, was lightning or a
/// blow and not work.
const STRUCK_AT_SEA: f64 = 0.9;
const STRUCK_IN_PORT: f64 = 0.1;
/// Probability that a change of the permanent magnetism in port is cargo.
const LIFTED: f64 = 0.5;
/// Sizes that errors have in storms, over anomalies and by faults of the compass, degrees where
/// H is 24 µT. The largest storms on record come to about eight; a damaged card moves by any
/// number.
const STORM_DEG: f64 = 5.0;
const ANOMALY_DEG: f64 = 6.0;
const FAULT_DEG: f64 = 10.0;
/// Faults of a compass that swings, and of a lone reference, over storms and anomalies.
const COMPASS_FAULTS: f64 = 0.03;
const LONE_REFERENCE_FAULTS: f64 = 0.06;
/// Probability below which a cause is not named.
const NEGLIGIBLE: f64 = 0.005;
/// Probability that a change of the whole ship in port is cargo and not work.
const LOADED: f64 = 0.85;
/// Probability that a step in port that a later port call undid was cargo and not work.
const DISCHARGED: f64 = 0.95;
/// Tolerance of the logbook's times after an event, seconds: people write down when they
/// noticed.
const REPORTED_WITHIN_S: f64 = 2.0 * 86_400.0;
/// Tolerance of work before an event, seconds: at sea a clock's error, in port the delay of a
/// plan.
const WORKED_BEFORE_S: f64 = 6.0 * 3600.0;
const PLANNED_S: f64 = 86_400.0;
/// Tolerance of cargo after a change, seconds: a hasty entry.
const LOADED_AFTER_S: f64 = 6.0 * 3600.0;

/// Circumstances of an event that part its causes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Circumstances {
    /// Error of the compass during a passing disturbance, degrees where H is 24 µT.
    pub(super) disturbance_deg: Option<f64>,
    /// True if there was one reference only.
    pub(super) one_reference: bool,
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

/// Returns the causes of a kind of event, each with its share.
fn shares(kind: Kind, event: &Event, known: &Circumstances) -> Vec<(Cause, f64)> {
    let disturbance_deg = known.disturbance_deg.unwrap_or(0.0);
    let square = |deg: f64| (disturbance_deg / deg).powi(2);
    let by_fault = square(FAULT_DEG) / (1.0 + square(FAULT_DEG));
    let lone = if known.one_reference {
        LONE_REFERENCE_FAULTS
    } else {
        0.0
    };
    let passing = |cause: Cause, share: f64| {
        vec![
            (cause, share),
            (Cause::CompassFault, COMPASS_FAULTS * by_fault),
            (Cause::ReferenceFault, lone * by_fault),
        ]
    };
    match kind {
        Kind::Strike if event.in_port && event.until.is_some() => vec![
            (Cause::MagneticCargo, DISCHARGED),
            (Cause::AdjustmentOrRepair, 1.0 - DISCHARGED),
        ],
        // Steel that was lifted by magnets is cargo without much induced magnetism.
        Kind::Strike if event.in_port => vec![
            (Cause::MagneticCargo, LIFTED),
            (Cause::LightningOrShock, STRUCK_IN_PORT),
            (Cause::AdjustmentOrRepair, 1.0 - LIFTED - STRUCK_IN_PORT),
        ],
        Kind::Strike => vec![
            (Cause::LightningOrShock, STRUCK_AT_SEA),
            (Cause::AdjustmentOrRepair, 1.0 - STRUCK_AT_SEA),
        ],
        Kind::Deflection => vec![(Cause::Unknown, 1.0)],
        // Work is not undone at a port call.
        Kind::Cargo if event.until.is_some() => vec![(Cause::MagneticCargo, 1.0)],
        Kind::Cargo => vec![
            (Cause::MagneticCargo, LOADED),
            (Cause::AdjustmentOrRepair, 1.0 - LOADED),
        ],
        Kind::Alignment => vec![(Cause::Alignment, 1.0)],
        Kind::ShipDrift => vec![(Cause::Drift, 1.0)],
        Kind::FailedCard => vec![(Cause::CompassFault, 1.0)],
        Kind::Storm | Kind::SevereStorm => {
            passing(Cause::MagneticStorm, (-square(STORM_DEG)).exp())
        }
        Kind::Anomaly => passing(Cause::LocalAnomaly, 1.0 / (1.0 + square(ANOMALY_DEG))),
        Kind::GyroStep
        | Kind::SatelliteStep
        | Kind::GyroSettling
        | Kind::GyroRamp
        | Kind::FailedGyro
        | Kind::FailedSatellite => vec![(Cause::ReferenceFault, 1.0)],
    }
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
    weights.retain(|weight| weight.probability >= NEGLIGIBLE * sum);
    let kept: f64 = weights.iter().map(|weight| weight.probability).sum();
    for weight in &mut weights {
        weight.probability /= kept;
    }
    weights.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    weights
}

/// Returns the causes that people reported at about the time of an event.
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
                    && latest.seconds_since(time) > -LOADED_AFTER_S
            };
            event.in_port && (is_then(entry.from) || is_then(to))
        } else if entry.kind.ends_an_epoch() {
            let before_s = if event.in_port {
                PLANNED_S
            } else {
                WORKED_BEFORE_S
            };
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
