//! Disturbances from outside the ship. They pass, and affect neither card nor plan.
//!
//! Interference with the receivers of satellites is one of them: the compass is sound, and the
//! reckoned place serves the card as well as the true one.

use super::change_rules::{advice, by_size, condition};
use super::facts::DetectedChange;
use super::row::{CardEffect, Case, CauseRow, Condition, Ending, Finder, PlanEffect, Size};
use crate::alerts::cause::Cause;
use crate::alerts::desired::EventWindow;
use binnacle_compass::position::Position;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

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

/// Jamming or spoofing, as the agent's dead reckoning shows it.
pub(super) const GNSS_INTERFERENCE: CauseRow = CauseRow {
    cause: Cause::GnssInterference,
    title: "GNSS interference",
    finders: &[Finder::Change(interference)],
    severity: |_| Severity::Warning,
    advice: |_| {
        "Navigate without GNSS: position, speed, time and satellite compass may be false. The \
         corrected heading goes on from the reckoned place. Samples taken meanwhile are left out \
         of the model."
    },
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::WithChange,
    ends_with_adjustment: false,
    is_redated: true,
};

fn interference(detected: &DetectedChange<'_>) -> Option<Condition> {
    let change = &detected.found.change;
    if change.ended.is_some() {
        return None;
    }
    let since = Time(change.from);
    let place = detected.found.change.position.map_or(String::new(), near);
    Some(Condition {
        since,
        window: EventWindow::exactly(since),
        size: Size::default(),
        case: Case::Interference,
        summary: format!("GNSS interference{place} since {}.", since.to_the_minute()),
        evidence: change.evidence.clone(),
    })
}

/// Returns a place in tenths of a degree, as a part of a sentence.
fn near(position: Position) -> String {
    let part = |degrees: f64, [positive, negative]: [char; 2]| {
        let letter = if degrees < 0.0 { negative } else { positive };
        format!("{:.1}° {letter}", degrees.abs())
    };
    format!(
        " near {}, {}",
        part(position.lat_deg(), ['N', 'S']),
        part(position.lon_deg(), ['E', 'W'])
    )
}
