//! Detected events as changes in the result of an analysis.

use crate::hypotheses::kinds::Kind;
use crate::weighing::records::Detected;
use binnacle_compass::result::{Cause, CauseProbability, Change};

/// Returns the change that a detected event is.
pub(crate) fn change(detected: &Detected) -> Change {
    let mut causes: Vec<CauseProbability> = Vec::new();
    let total: f64 = detected.posterior.kinds.iter().map(|(_, p)| p).sum();
    for (kind, probability) in &detected.posterior.kinds {
        let cause = cause(*kind, detected.event.in_port);
        let probability = probability / total.max(f64::MIN_POSITIVE);
        match causes.iter_mut().find(|known| known.cause == cause) {
            Some(known) => known.probability += probability,
            None => causes.push(CauseProbability { cause, probability }),
        }
    }
    causes.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Change {
        from: detected.event.from,
        from_earliest: detected.posterior.earliest.min(detected.event.from),
        from_latest: detected
            .posterior
            .latest
            .max(detected.event.from)
            .plus_seconds(3600.0),
        detected_at: detected.at,
        confirmed: detected.withdrawn.is_none(),
        withdrawn: detected.withdrawn.is_some(),
        cause: causes.first().map_or(Cause::Unknown, |first| first.cause),
        causes,
        evidence: Vec::new(),
        deviation_change_deg: None,
        step: None,
        ended: detected.event.until,
    }
}

fn cause(kind: Kind, in_port: bool) -> Cause {
    match kind {
        Kind::Strike if in_port => Cause::AdjustmentOrRepair,
        Kind::Strike => Cause::LightningOrShock,
        Kind::Cargo => Cause::MagneticCargo,
        Kind::Alignment => Cause::Alignment,
        Kind::ShipDrift => Cause::Drift,
        Kind::GyroStep
        | Kind::SatelliteStep
        | Kind::GyroSettling
        | Kind::GyroRamp
        | Kind::StuckGyro
        | Kind::StuckSatellite => Cause::ReferenceFault,
        Kind::Storm => Cause::MagneticStorm,
        Kind::Anomaly => Cause::LocalAnomaly,
        Kind::StuckCard => Cause::CompassFault,
    }
}
