//! What an adjustment brings to an end: alerts about the ship as she was before it.
//!
//! What always holds: from the moment of an adjustment that an order completed the card that
//! it foretold is the one in force, until headings at sea speak against it; then the order's
//! own alert does. What was found before it of gyro or satellite compass, or of the compass
//! itself, stands.

use super::alert::Cause;
use super::findings::Findings;
use super::store::{self, OpenAlert};
use crate::db::Db;
use crate::error::Result;
use crate::ids::{CompassId, VesselId};
use crate::time::Time;
use crate::work_orders;

/// Why such an alert cleared itself.
pub(super) const ADJUSTED: &str = "the compass has been adjusted since: the card that was foretold \
                                   then holds until headings at sea verify it, or speak against it";

/// Takes out the changes of the ship that lie before an adjustment.
pub(super) fn forget_changes(findings: &mut Findings, adjusted: Time) {
    findings.changes.retain(|found| {
        let change = &found.change;
        !change.cause.changes_deviation() || Time(change.from) >= adjusted
    });
}

/// The alerts of a compass that are not cleared, the newest first; without those about the
/// ship as she was before its last adjustment, which the next analysis clears.
///
/// # Errors
/// When the database cannot be asked.
pub async fn in_force(db: &Db, vessel: VesselId, compass: CompassId) -> Result<Vec<OpenAlert>> {
    let mut open = store::open_of_compass(db, vessel, compass).await?;
    let last = work_orders::completed(db, vessel, compass).await?.pop();
    if let Some(last) = last {
        open.retain(|alert| !is_about_before(alert.cause, alert.since, last.at));
    }
    Ok(open)
}

/// Whether an alert is about the ship as she was before an adjustment.
pub(super) fn is_about_before(cause: Cause, since: Time, adjusted: Time) -> bool {
    let changes_deviation = matches!(
        cause,
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
    changes_deviation && since < adjusted
}
