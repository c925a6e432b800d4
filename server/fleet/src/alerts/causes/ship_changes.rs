//! Changes of the ship's magnetism, or of the compass's zero.
//!
//! Invariant: each lasts until the model includes it. Only cargo ends by itself.

use super::change_rules::{advice, by_size, condition};
use super::facts::Stage;
use super::row::{CardEffect, Case, CauseRow, Ending, Finder, PlanEffect};
use crate::alerts::cause::Cause;

/// A strike or a heavy blow.
pub(super) const LIGHTNING_OR_SHOCK: CauseRow = CauseRow {
    cause: Cause::LightningOrShock,
    title: "lightning or a shock",
    ..SHIP_CHANGE
};

/// Cargo: the earlier model returns with its discharge.
pub(super) const MAGNETIC_CARGO: CauseRow = CauseRow {
    cause: Cause::MagneticCargo,
    title: "magnetic cargo",
    advice: |case| match case {
        Case::Change(Stage::NoModel) => {
            "No card holds with this cargo. Steer by gyro or satellite compass, take an azimuth \
             once a watch and after each large alteration of course, and report the cargo in the \
             logbook. The model from before is used again once it is discharged."
        }
        Case::Change(Stage::Interim | Stage::Learned) => {
            "Use no card from before loading. Steer by gyro, satellite compass or the corrected \
             heading, which takes the cargo into account, take an azimuth once a watch, and report \
             the cargo in the logbook. The model from before is used again once it is discharged."
        }
        other => advice(other),
    },
    ..SHIP_CHANGE
};

/// Slow drift.
pub(super) const DRIFT: CauseRow = CauseRow {
    cause: Cause::Drift,
    title: "drift of the ship's magnetism",
    ..SHIP_CHANGE
};

/// A moved lubber line, bowl or sensor: no corrector helps.
pub(super) const ALIGNMENT: CauseRow = CauseRow {
    cause: Cause::Alignment,
    title: "the compass's zero moved",
    advice: |_| {
        "Use no card from before: the compass error has changed by the same on every heading. \
         Steer by gyro, satellite compass or the corrected heading and take an azimuth. Check \
         whether the bowl, the lubber line or the sensor has shifted against the ship's head; put \
         it back, and report that in the logbook. No corrector needs to be moved."
    },
    ..SHIP_CHANGE
};

/// A change without a likely cause. Unreported work is one too.
pub(super) const UNKNOWN_CHANGE: CauseRow = CauseRow {
    cause: Cause::UnknownChange,
    title: "a change of unknown cause",
    ..SHIP_CHANGE
};

/// Columns that all changes of the ship have in common.
const SHIP_CHANGE: CauseRow = CauseRow {
    cause: Cause::UnknownChange,
    title: "",
    finders: &[Finder::Change(condition)],
    severity: by_size,
    advice,
    on_card: CardEffect::Note,
    on_plan: PlanEffect::Note,
    ending: Ending::WithChange,
    ends_with_adjustment: true,
    is_redated: true,
};
