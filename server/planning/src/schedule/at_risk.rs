//! Jobs at risk: agreed adjustments that no longer fit the plan.

use super::input::{Agreed, LoadedInput, Names, OrderBesidePlan};
use super::plan::Plan;
use binnacle_fleet::alerts::JobAtRisk;
use binnacle_platform::ids::{CompassId, FirmId, OrderId, VesselId};
use binnacle_schedule::input::JobState;
use binnacle_schedule::plan::ChangeKind;
use chrono::NaiveDate;
use std::collections::{BTreeMap, BTreeSet};

/// Reason that the solver gives for a confirmed job that stays in place.
const UNCHANGED: &str = "confirmed";

/// Returns the jobs that the plan moves or drops, by the first compass of each.
pub(super) fn find_jobs_at_risk(
    plan: &Plan,
    names: &Names,
) -> BTreeMap<(VesselId, CompassId), JobAtRisk> {
    let mut alerts = BTreeMap::new();
    for change in &plan.changes {
        let is_unchanged = change.what == ChangeKind::Kept && change.why == UNCHANGED;
        let held: Vec<(CompassId, &Agreed)> = change
            .compasses
            .iter()
            .filter_map(|one| Some((one.compass_id, names.agreed.get(&one.compass_id)?)))
            .filter(|(_, agreed)| agreed.state == JobState::Confirmed)
            .collect();
        // One alert for each job, also for several compasses.
        let Some((compass, agreed)) = held.first().filter(|_| !is_unchanged) else {
            continue;
        };
        let orders: Vec<OrderId> = held.iter().map(|(_, agreed)| agreed.order_id).collect();
        let firm = names.firm_name(agreed.firm_id);
        let alert = job_at_risk(plan, firm, agreed.day, &change.why, orders);
        alerts.insert((agreed.vessel_id, *compass), alert);
    }
    alerts
}

/// Adds the jobs at risk among orders beside the plan. Returns the other compasses with such
/// orders, whose alerts stay as they are.
pub(super) fn add_orders_beside_plan(
    plan: &Plan,
    loaded: &LoadedInput,
    alerts: &mut BTreeMap<(VesselId, CompassId), JobAtRisk>,
) -> BTreeSet<(VesselId, CompassId)> {
    let mut unknown = BTreeSet::new();
    let mut jobs: BTreeMap<(VesselId, FirmId, NaiveDate), Vec<&OrderBesidePlan>> = BTreeMap::new();
    for one in &loaded.orders_beside_plan {
        let job = (one.vessel_id, one.firm_id, one.day);
        jobs.entry(job).or_default().push(one);
        unknown.insert((one.vessel_id, one.compass_id));
    }
    for ((vessel, firm, day), of_job) in jobs {
        let first = of_job
            .iter()
            .find_map(|one| Some((one, one.problem.as_ref()?)));
        let Some((first, why)) = first else {
            continue;
        };
        let orders: Vec<OrderId> = of_job.iter().map(|one| one.order_id).collect();
        let firm = loaded.names.firm_name(firm);
        let alert = job_at_risk(plan, firm, day, why, orders);
        unknown.remove(&(vessel, first.compass_id));
        alerts.insert((vessel, first.compass_id), alert);
    }
    unknown
}

fn job_at_risk(
    plan: &Plan,
    firm: String,
    day: NaiveDate,
    reason: &str,
    orders: Vec<OrderId>,
) -> JobAtRisk {
    JobAtRisk {
        since: plan.solved_at,
        firm,
        day,
        reason: reason.to_owned(),
        orders,
    }
}
