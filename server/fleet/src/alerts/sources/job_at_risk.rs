//! Source of alerts: a schedule in which an agreed adjustment no longer fits.
//!
//! Invariant: they are raised and cleared in the transaction that stores the schedule.

use crate::alerts::causes::{Facts, JobAtRisk, Source, evaluate};
use crate::alerts::reconcile::reconcile_source;
use crate::alerts::store;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CompassId, OperatorId, VesselId};
use binnacle_platform::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// Reconciles an operator's alerts of this cause with a schedule.
///
/// Compasses in `not_known`, of which the schedule can say nothing, keep theirs.
pub async fn reconcile_jobs_at_risk(
    tx: &mut Tx,
    operator: OperatorId,
    jobs: &BTreeMap<(VesselId, CompassId), JobAtRisk>,
    not_known: &BTreeSet<(VesselId, CompassId)>,
    now: Time,
) -> Result<Vec<Event>> {
    let mut all = store::with_job_at_risk(tx, operator).await?;
    all.retain(|compass| !not_known.contains(compass));
    all.extend(jobs.keys().copied());
    all.sort_unstable();
    all.dedup();
    let mut events = Vec::new();
    for (vessel, compass) in all {
        let desired = jobs
            .get(&(vessel, compass))
            .map_or_else(Vec::new, |job| evaluate(Facts::Schedule(job)));
        let source = Source::Schedule;
        events.extend(reconcile_source(tx, vessel, compass, source, &desired, now).await?);
    }
    Ok(events)
}
