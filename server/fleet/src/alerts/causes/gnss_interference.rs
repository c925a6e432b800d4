//! Interference with the ship's receivers of satellites. The compass is sound, and the reckoned
//! place serves the card as well as the true one.

use super::facts::DetectedChange;
use super::row::{CardEffect, Case, CauseRow, Condition, Ending, Finder, PlanEffect, Size};
use crate::alerts::cause::Cause;
use crate::alerts::desired::EventWindow;
use binnacle_compass::position::Position;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

/// Jamming or spoofing, as the agent's dead reckoning shows it.
pub(super) const GNSS_INTERFERENCE: CauseRow = CauseRow {
    cause: Cause::GnssInterference,
    title: "GNSS interference",
    finders: &[Finder::Change(condition)],
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

fn condition(detected: &DetectedChange<'_>) -> Option<Condition> {
    let change = &detected.found.change;
    if change.ended.is_some() {
        return None;
    }
    let since = Time(change.from);
    let place = detected.found.position.map_or(String::new(), near);
    Some(Condition {
        since,
        window: EventWindow::exactly(since),
        size: Size::default(),
        case: Case::Interference,
        summary: format!("GNSS interference{place} since {}.", since.to_the_minute()),
        evidence: change.evidence.clone(),
    })
}

/// Returns a place in whole degrees, as a part of a sentence.
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
