//! What an adjustment brings to an end: alerts about the ship as she was before it.
//!
//! What always holds: from the moment of an adjustment that an order completed the card that
//! it foretold is the one in force, until headings at sea speak against it; then the order's
//! own alert does. What was found before it of gyro or satellite compass, or of the compass
//! itself, stands.

use super::alert::Cause;
use super::findings::Findings;
use super::store::Known;
use crate::time::Time;

/// Why such an alert cleared itself.
pub(super) const ADJUSTED: &str = "the compass has been adjusted since: the card that was foretold \
                                   then holds until headings at sea verify it, or speak against it";

/// Takes out the changes of the ship that lie before an adjustment.
pub(super) fn forget_changes(findings: &mut Findings, adjusted: Time) {
    findings.changes.retain(|found| {
        let change = &found.change;
        !change.cause.is_the_ships() || Time(change.from) >= adjusted
    });
}

/// Whether an alert is about the ship as she was before an adjustment.
pub(super) fn is_about_before(alert: &Known, adjusted: Time) -> bool {
    let is_the_ships = matches!(
        alert.cause,
        Cause::DeviationOverLimit
            | Cause::WideBand
            | Cause::NoModel
            | Cause::LightningOrShock
            | Cause::MagneticCargo
            | Cause::Drift
            | Cause::Alignment
            | Cause::UnknownChange
            | Cause::AdjustmentNotConfirmed
    );
    is_the_ships && alert.since < adjusted
}
