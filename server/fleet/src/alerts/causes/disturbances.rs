//! Disturbances from outside the ship. They pass, and affect neither card nor plan.

use super::change_rules::{advice, by_size, condition};
use super::row::{CardEffect, CauseRow, Ending, Finder, PlanEffect};
use crate::alerts::cause::Cause;

/// The earth's crust, at a place.
pub(super) const LOCAL_ANOMALY: CauseRow = CauseRow {
    cause: Cause::LocalAnomaly,
    title: "a local anomaly",
    ..DISTURBANCE
};

/// The sun, for hours.
pub(super) const MAGNETIC_STORM: CauseRow = CauseRow {
    cause: Cause::MagneticStorm,
    title: "a magnetic storm",
    ..DISTURBANCE
};

/// Iron of the quay and its cranes.
pub(super) const BERTH_STEEL: CauseRow = CauseRow {
    cause: Cause::BerthSteel,
    title: "steel at the berth",
    ..DISTURBANCE
};

/// Columns that all disturbances have in common.
const DISTURBANCE: CauseRow = CauseRow {
    cause: Cause::LocalAnomaly,
    title: "",
    finders: &[Finder::Change(condition)],
    severity: by_size,
    advice,
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::WithChange,
    ends_with_adjustment: false,
    is_redated: true,
};
