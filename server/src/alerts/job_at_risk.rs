//! Adjustments that were agreed with a firm and do not fit any more: an ETA moved past the
//! due date, a call was cancelled, the firm has fewer teams.
//!
//! What always holds: they are raised and cleared in the transaction that keeps the
//! schedule that found them, and each compass has one.

use super::alert::{Cause, DesiredAlert};
use super::reconcile::{OVER, publish_changes, reconcile};
use super::store;
use crate::db::{Tx, rows};
use crate::error::Result;
use crate::events::Event;
use crate::ids::{CompassId, OperatorId, VesselId};
use crate::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// Brings an operator's alerts of this cause in line with what a schedule found, but those
/// that it could not tell of: they stay as they are.
pub async fn reconcile_jobs_at_risk(
    tx: &mut Tx,
    operator: OperatorId,
    mut wanted: BTreeMap<(VesselId, CompassId), DesiredAlert>,
    not_told: &BTreeSet<(VesselId, CompassId)>,
    now: Time,
) -> Result<Vec<Event>> {
    let open = rows!(
        in &mut *tx,
        (VesselId, CompassId),
        "SELECT a.vessel_id, a.compass_id FROM alerts a JOIN vessels v ON v.id = a.vessel_id
         WHERE v.operator_id = $1 AND a.cause = $2 AND a.holds
         ORDER BY a.vessel_id, a.compass_id",
        operator,
        Cause::AgreedJobAtRisk
    )?;
    let mut all = open;
    all.retain(|of| !not_told.contains(of));
    all.extend(wanted.keys().copied());
    all.sort_unstable();
    all.dedup();
    let mut events = Vec::new();
    for (vessel, compass) in all {
        store::lock(tx, vessel, compass).await?;
        let mut known = store::known(tx, vessel, compass).await?;
        known.retain(|alert| alert.cause == Cause::AgreedJobAtRisk);
        let wanted: Vec<DesiredAlert> = wanted.remove(&(vessel, compass)).into_iter().collect();
        let news = reconcile(tx, vessel, compass, &known, &wanted, |_| OVER, now).await?;
        events.extend(publish_changes(tx, vessel, &news, now).await?);
    }
    Ok(events)
}
