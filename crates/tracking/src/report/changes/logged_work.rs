//! Changes by work in the logbook.

use super::size::Sides;
use crate::constants::HOUR_S;
use crate::report::epochs::Span;
use crate::report::kept::LoggedWork;
use binnacle_compass::result::{Cause, CauseProbability, Change};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;

/// Returns the change of work that begins an epoch; `at` is its date by the samples. Without a
/// ship on both sides it has no size.
pub(super) fn logged_change(
    work: &LoggedWork,
    at: Timestamp,
    sides: Option<Sides<'_>>,
    earth: Option<EarthField>,
) -> Change {
    let mut evidence = vec![format!(
        "recorded in the logbook: {}",
        work.kind.description()
    )];
    let later_s = at.seconds_since(work.at);
    if later_s.abs() > HOUR_S {
        let side = if later_s > 0.0 { "later" } else { "earlier" };
        evidence.push(format!(
            "by the samples it was done {:.0} hours {side} than the logbook says",
            later_s.abs() / 3600.0
        ));
    }
    Change {
        from: at,
        from_earliest: at,
        from_latest: at,
        detected_at: at,
        confirmed: true,
        position: None,
        disturbed_deg: None,
        withdrawn: false,
        cause: Cause::AdjustmentOrRepair,
        causes: vec![CauseProbability {
            cause: Cause::AdjustmentOrRepair,
            probability: 1.0,
        }],
        evidence,
        deviation_change_deg: sides.zip(earth).map(|(s, earth)| s.worst_change_deg(earth)),
        step: sides.map(Sides::step),
        ended: None,
    }
}

/// Returns true if there are readings on both sides of a boundary.
pub(super) fn has_both_sides(spans: &[Span<'_>], place: usize) -> bool {
    let before = place.checked_sub(1).map(|before| &spans[before]);
    before.is_some_and(|before| !before.is_empty()) && !spans[place].is_empty()
}
