//! Names for the plan, and the orders that are its jobs.

use super::former::{FormerJobs, StartingJob};
use super::orders::Order;
use crate::needs::Facts;
use crate::port_calls::StoredCall;
use crate::schedule::plan::{Compass, UnderWay};
use binnacle_orders::work_orders::{Hours, State};
use binnacle_platform::ids::{CallId, CompassId, FirmId, OrderId, VesselId};
use binnacle_schedule::input::{Firm, JobState};
use chrono::NaiveDate;
use std::collections::{BTreeMap, BTreeSet};

/// Names for the plan, and the orders that are its jobs.
#[derive(Default)]
pub(crate) struct Names {
    pub(crate) compasses: BTreeMap<CompassId, (VesselId, String, String)>,
    pub(crate) firms: BTreeMap<FirmId, String>,
    pub(crate) calls: BTreeMap<CallId, StoredCall>,
    pub(crate) pinned: BTreeSet<CompassId>,
    /// Orders that are jobs of the plan.
    pub(crate) agreed: BTreeMap<CompassId, Agreed>,
    /// Orders that every firm has declined.
    pub(crate) declined: BTreeMap<CompassId, OrderId>,
}

/// Job that an order has agreed for a compass: firm, port call and hours.
#[derive(Clone, Debug)]
pub(crate) struct Agreed {
    pub(crate) vessel_id: VesselId,
    pub(crate) order_id: OrderId,
    pub(crate) state: JobState,
    pub(crate) call_id: CallId,
    pub(crate) firm_id: FirmId,
    pub(crate) day: NaiveDate,
    pub(crate) hours: Hours,
    /// The firm's team, if it has a name.
    pub(crate) team: Option<String>,
}

impl Agreed {
    /// Returns the job that the plan starts from. A team that the firm no longer has is left open.
    pub(super) fn starting_job(&self, firms: &[Firm]) -> StartingJob {
        let id = self.firm_id.to_string();
        let firm = firms.iter().find(|firm| firm.id == id);
        let teams = firm.map_or(&[][..], |firm| firm.teams.named());
        let is_known = |name: &String| teams.iter().any(|team| team.name == *name);
        StartingJob {
            call: self.call_id,
            firm: self.firm_id,
            day: self.day,
            from: Some(self.hours.from),
            to: Some(self.hours.until),
            team: self.team.clone().filter(is_known),
            state: self.state,
        }
    }
}

impl Names {
    pub(super) fn from_facts(facts: &[Facts]) -> Names {
        let compasses = facts.iter().map(|one| {
            let names = (
                one.vessel_id,
                one.vessel_name.clone(),
                one.compass_name.clone(),
            );
            (one.compass_id, names)
        });
        Names {
            compasses: compasses.collect(),
            ..Names::default()
        }
    }

    /// Records the orders that are jobs of the plan. Returns those beside it, with the reason.
    pub(super) fn add_orders<'a>(
        &mut self,
        orders: &'a [Order],
        upcoming: &[StoredCall],
        planned_with: &[Firm],
    ) -> Vec<(&'a Order, String)> {
        let mut beside = Vec::new();
        for order in orders {
            if order.state == State::Declined {
                self.declined.insert(order.compass_id, order.id);
                continue;
            }
            let (Some(state), Some(firm_id)) = (order.job_state(), order.firm_id) else {
                beside.push((
                    order,
                    "its order is in progress, or not offered to any firm".to_owned(),
                ));
                continue;
            };
            let id = firm_id.to_string();
            if planned_with.iter().all(|firm| firm.id != id) {
                let firm = self.firm_name(firm_id);
                beside.push((
                    order,
                    format!("{firm} has its order and cannot be planned with"),
                ));
                continue;
            }
            let Some(call_id) = order.call(upcoming) else {
                beside.push((
                    order,
                    "no port call is known at its order's port and time".to_owned(),
                ));
                continue;
            };
            let port = upcoming.iter().find(|call| call.id == call_id);
            let agreed = Agreed {
                vessel_id: order.vessel_id,
                order_id: order.id,
                state,
                call_id,
                firm_id,
                day: order.day(port.map(|call| call.port.as_str())),
                hours: order.hours(),
                team: order.team.clone(),
            };
            self.agreed.insert(order.compass_id, agreed);
        }
        beside
    }

    /// Returns the orders beside the plan, with names and reasons.
    pub(super) fn under_way(&self, beside: Vec<(&Order, String)>) -> Vec<UnderWay> {
        let named = beside.into_iter().filter_map(|(order, why)| {
            let (vessel_id, vessel_name, _) = self.compasses.get(&order.compass_id)?;
            Some(UnderWay {
                vessel_id: *vessel_id,
                vessel_name: vessel_name.clone(),
                compass: self.compass(order.compass_id),
                order_id: order.id,
                why,
            })
        });
        named.collect()
    }

    /// Returns the orders that are jobs to start from, each with its firm.
    pub(super) fn planned(&self, former: &FormerJobs) -> BTreeMap<OrderId, FirmId> {
        let agreed = self.agreed.iter();
        agreed
            .filter(|(compass, _)| former.with_job.contains(compass))
            .map(|(_, agreed)| (agreed.order_id, agreed.firm_id))
            .collect()
    }

    pub(crate) fn compass(&self, id: CompassId) -> Compass {
        let known = self.compasses.get(&id);
        Compass {
            compass_id: id,
            compass_name: known.map_or_else(String::new, |(_, _, name)| name.clone()),
        }
    }

    pub(crate) fn firm_name(&self, id: FirmId) -> String {
        self.firms.get(&id).cloned().unwrap_or_default()
    }
}
