//! Faults of gyro, satellite compass and magnetic compass.

use super::change_rules::{condition, stage};
use super::facts::{DetectedChange, Situation, Stage};
use super::row::{CardEffect, Case, CauseRow, Condition, Ending, Finder, PlanEffect};
use crate::alerts::cause::Cause;
use crate::analysis::{FailedLately, Findings};
use binnacle_compass::result::Change;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

/// Share of the last day's samples with a failed reference that is more than a drop-out.
const FAILED_SHARE: f64 = 0.1;
/// Number of such samples that is more than a drop-out.
const FAILED_SAMPLES: u64 = 3;
/// Probability of a compass fault from which the compass is not to be trusted.
const COMPASS_SUSPECTED: f64 = 0.1;
/// Probability of a change of the ship from which the ship is not ruled out.
const SHIP_SUSPECTED: f64 = 0.05;

/// The detector's word first, then the comparison of both references.
pub(super) const REFERENCE_FAULT: CauseRow = CauseRow {
    cause: Cause::ReferenceFault,
    title: "gyro and satellite compass disagree",
    finders: &[
        Finder::Change(reference_changed),
        Finder::Findings(references_disagree),
    ],
    severity: |_| Severity::Warning,
    advice: |case| match case {
        Case::CompassOrReference => {
            "Compass or gyro swings, and there is no third instrument to tell which. Trust \
             neither: take an azimuth now and each watch, compare both with a steady course over \
             ground, and look at compass, sensor and cables. The samples taken meanwhile are left \
             out of the model."
        }
        Case::ShipOrReference => {
            "Compass or reference is in error, and the samples do not tell yet which. Take an \
             azimuth now and once a watch and steer by what it confirms; report in the logbook \
             what may have happened."
        }
        Case::Change(_) => {
            "Check gyro and satellite compass against an azimuth. The magnetic compass itself is \
             not suspected."
        }
        _ => {
            "Check both against an azimuth, and the alignment and the speed and latitude settings \
             of the gyro. Until then take neither as the compass's true heading; the magnetic \
             compass itself is not suspected."
        }
    },
    on_card: CardEffect::Note,
    on_plan: PlanEffect::Note,
    ending: Ending::WithChange,
    ends_with_adjustment: false,
    is_redated: false,
};

/// A compass that does not follow the ship: no model describes it.
pub(super) const COMPASS_FAULT: CauseRow = CauseRow {
    cause: Cause::CompassFault,
    title: "a fault of the compass",
    finders: &[Finder::Change(compass_changed)],
    severity: |_| Severity::Critical,
    advice: |_| {
        "Do not use the compass. Steer by gyro or satellite compass; look at bowl, pivot and \
         liquid, and at the sensor and its cable. The samples taken meanwhile are left out of the \
         model."
    },
    on_card: CardEffect::Block,
    on_plan: PlanEffect::Note,
    ending: Ending::WithChange,
    ends_with_adjustment: false,
    is_redated: false,
};

fn compass_changed(detected: &DetectedChange<'_>) -> Option<Condition> {
    let since = Time(detected.found.change.from).to_the_minute();
    Some(Condition {
        summary: format!("Since about {since} the compass does not follow the ship."),
        ..condition(detected)?
    })
}

fn reference_changed(detected: &DetectedChange<'_>) -> Option<Condition> {
    let change = &detected.found.change;
    let stage = stage(detected);
    let case = if may_be_the_compass(change) {
        Case::CompassOrReference
    } else if stage == Stage::Unconfirmed && may_be_the_ship(change) {
        Case::ShipOrReference
    } else {
        Case::Change(stage)
    };
    Some(Condition {
        case,
        ..condition(detected)?
    })
}

/// Tells whether a fault of the only reference may as well be one of the compass.
fn may_be_the_compass(change: &Change) -> bool {
    change.causes.iter().any(|c| {
        c.cause == binnacle_compass::result::Cause::CompassFault
            && c.probability > COMPASS_SUSPECTED
    })
}

/// Tells whether an apparent fault of a reference may as well be a change of the ship.
fn may_be_the_ship(change: &Change) -> bool {
    let of_the_ship = change.causes.iter().filter(|c| c.cause.changes_deviation());
    of_the_ship.map(|c| c.probability).sum::<f64>() > SHIP_SUSPECTED
}

fn references_disagree(situation: &Situation<'_>) -> Option<Condition> {
    let findings = situation.findings;
    match (findings.references_disagree_deg, &findings.failed_lately) {
        (Some(offset_deg), _) => Some(disagree_throughout(offset_deg, situation)),
        (None, Some(failed)) if is_more_than_a_drop_out(failed) => Some(one_failed(failed)),
        _ => None,
    }
}

fn disagree_throughout(offset_deg: f64, situation: &Situation<'_>) -> Condition {
    let Findings {
        epoch_data_from,
        refusal,
        ..
    } = situation.findings;
    Condition {
        evidence: refusal.iter().map(|text| format!("{text}.")).collect(),
        ..Condition::new(
            epoch_data_from.unwrap_or(situation.data_until).into(),
            format!(
                "Gyro and satellite compass differ by {:.1}° throughout, more than any alignment \
                 explains: one of them is wrong.",
                offset_deg.abs()
            ),
        )
    }
}

fn one_failed(failed: &FailedLately) -> Condition {
    Condition {
        evidence: vec![
            format!(
                "This was so in {} of the {} samples of the last day that had both.",
                failed.samples, failed.of
            ),
            format!(
                "Since the compass was last altered the gyro was left out {} times, the satellite \
                 compass {} times.",
                failed.gyro_dropped, failed.satellite_dropped
            ),
        ],
        ..Condition::new(
            failed.from.into(),
            format!(
                "Gyro and satellite compass have parted: recently they departed by {:.1}° from \
                 their usual difference.",
                failed.departure_deg.abs()
            ),
        )
    }
}

fn is_more_than_a_drop_out(failed: &FailedLately) -> bool {
    failed.samples >= FAILED_SAMPLES && failed.samples as f64 >= FAILED_SHARE * failed.of as f64
}
