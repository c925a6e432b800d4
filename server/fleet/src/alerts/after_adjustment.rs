//! End of alerts by an adjustment.
//!
//! Invariants:
//!
//! - The card that a completed adjustment predicts is in force until headings at sea contradict it.
//!   The order then has an alert of its own.
//! - Alerts about gyro, satellite compass or the magnetic compass itself stay open.

use super::cause::Cause;
use super::store::{self, OpenAlert};
use crate::adjustments;
use crate::analysis::Findings;
use binnacle_platform::db::Db;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;

/// Lists a compass's alerts that are not cleared, the newest first.
///
/// Those about the ship before its last adjustment are left out: the next analysis clears them.
///
/// # Errors
/// Fails when the database does.
pub async fn list_in_force(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Vec<OpenAlert>> {
    let mut open = store::open_of_compass(db, vessel, compass).await?;
    let last = adjustments::completed(db, vessel, compass).await?.pop();
    if let Some(last) = last {
        open.retain(|alert| !is_ended_by(last.at, alert.cause, alert.since));
    }
    Ok(open)
}

/// Removes the changes of the ship that lie before an adjustment.
pub(super) fn remove_earlier_changes(findings: &mut Findings, adjusted: Time) {
    findings.changes.retain(|found| {
        let change = &found.change;
        !change.cause.changes_deviation() || Time(change.from) >= adjusted
    });
}

/// Tells whether an adjustment ends an alert that began at `since`.
pub(super) fn is_ended_by(adjusted: Time, cause: Cause, since: Time) -> bool {
    cause.row().ends_with_adjustment && since < adjusted
}
