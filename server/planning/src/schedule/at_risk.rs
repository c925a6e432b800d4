//! Agreed adjustments that do not fit any more: what people must know of a plan.

use super::input::{Agreed, Aside, Gathered, Names};
use super::plan::Plan;
use binnacle_fleet::alerts::JobAtRisk;
use binnacle_platform::ids::{CompassId, FirmId, OrderId, VesselId};
use binnacle_schedule::input::JobState;
use binnacle_schedule::plan::ChangeKind;
use chrono::NaiveDate;
use std::collections::{BTreeMap, BTreeSet};

/// Reason that the solver gives for a confirmed job that stays in place.
const STANDS: &str = "confirmed";

/// Those that the plan moves or gives up.
pub(super) fn at_risk(plan: &Plan, names: &Names) -> BTreeMap<(VesselId, CompassId), JobAtRisk> {
    let mut wanted = BTreeMap::new();
    for change in &plan.changes {
        let stands = change.what == ChangeKind::Kept && change.why == STANDS;
        let held: Vec<(CompassId, &Agreed)> = change
            .compasses
            .iter()
            .filter_map(|one| Some((one.compass_id, names.agreed.get(&one.compass_id)?)))
            .filter(|(_, agreed)| agreed.state == JobState::Confirmed)
            .collect();
        // A job is told of once, however many compasses it is for.
        let Some((compass, agreed)) = held.first().filter(|_| !stands) else {
            continue;
        };
        let orders: Vec<OrderId> = held.iter().map(|(_, agreed)| agreed.order_id).collect();
        let firm = names.firm(agreed.firm_id);
        let alert = unfit(plan, firm, agreed.day, &change.why, orders);
        wanted.insert((agreed.vessel_id, *compass), alert);
    }
    wanted
}

/// Adds the jobs at risk among orders beside the plan; returns the compasses whose alerts stay as
/// they are because nothing is known of them.
pub(super) fn aside(
    plan: &Plan,
    gathered: &Gathered,
    wanted: &mut BTreeMap<(VesselId, CompassId), JobAtRisk>,
) -> BTreeSet<(VesselId, CompassId)> {
    let mut not_told = BTreeSet::new();
    let mut jobs: BTreeMap<(VesselId, FirmId, NaiveDate), Vec<&Aside>> = BTreeMap::new();
    for one in &gathered.aside {
        let job = (one.vessel_id, one.firm_id, one.day);
        jobs.entry(job).or_default().push(one);
        not_told.insert((one.vessel_id, one.compass_id));
    }
    for ((vessel, firm, day), of_job) in jobs {
        let first = of_job
            .iter()
            .find_map(|one| Some((one, one.unfit.as_ref()?)));
        let Some((first, why)) = first else {
            continue;
        };
        let orders: Vec<OrderId> = of_job.iter().map(|one| one.order_id).collect();
        let firm = gathered.names.firm(firm);
        let alert = unfit(plan, firm, day, why, orders);
        not_told.remove(&(vessel, first.compass_id));
        wanted.insert((vessel, first.compass_id), alert);
    }
    not_told
}

fn unfit(
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
