//! A schedule, as it is kept and shown: the solver's answer with everybody's names.

use binnacle_platform::ids::{CallId, CompassId, FirmId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::calls::BerthHeading;
use binnacle_schedule::input::JobState;
use binnacle_schedule::needs::Urgency;
use binnacle_schedule::plan::{ChangeKind, Weighed};
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Reason for leaving out a firm without terms, which may hold orders all the same.
pub(super) const NO_TERMS: &str = "nobody has said on what terms it works";

/// Plan of a fleet: jobs, their quality, and the needs that could not be met.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = SchedulePlan)]
pub struct Plan {
    /// Counts the operator's plans from 1.
    pub version: i64,
    /// Time of creation.
    pub solved_at: Time,
    /// As of when: the begun hour.
    pub as_of: Time,
    /// Time taken to solve, seconds.
    pub solved_in_s: f64,
    /// SHA-256 of what it rests on, hexadecimal: the same again makes no new plan.
    pub input_sha256: String,
    /// Cost by the weights, including everything unmet.
    pub cost_eur: f64,
    /// Lower bound of the cost of any plan.
    pub bound_eur: f64,
    /// Distance of the cost from the bound, per cent of the cost.
    pub gap_percent: f64,
    /// Whether the plan is proven optimal.
    pub proven_optimal: bool,
    /// Fees and travel that are really paid.
    pub paid_eur: f64,
    /// Comparison with the previous plan; none for the first.
    #[schema(required)]
    pub against: Option<Against>,
    /// The jobs, in order of the day.
    pub jobs: Vec<Job>,
    /// Needs that could not be scheduled, or only late.
    pub unscheduled: Vec<Unscheduled>,
    /// Changes against the previous plan.
    pub changes: Vec<Change>,
    /// Compasses that are due after the horizon.
    pub later: Vec<Later>,
    /// Compasses whose order is under way beside the plan.
    pub under_way: Vec<UnderWay>,
    /// Firms that it could not plan with.
    pub left_out: Vec<LeftOut>,
}

/// Comparison of a plan with the previous one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanAgainst)]
pub struct Against {
    /// The plan before.
    pub version: i64,
    /// Extra cost by the weights; negative where this plan costs less.
    pub cost_eur: f64,
    /// Extra payments.
    pub paid_eur: f64,
    /// Number of the previous plan's jobs that moved or were dropped.
    pub moved: usize,
}

/// A compass that a job is for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PlannedCompass)]
pub struct Compass {
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
}

/// One job: one visit of a firm to a ship.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = PlannedJob)]
pub struct Job {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compasses to adjust.
    pub compasses: Vec<Compass>,
    /// At which call.
    pub call_id: CallId,
    /// UN/LOCODE of its port.
    #[schema(example = "NLRTM")]
    pub port: String,
    /// The port's name.
    pub port_name: String,
    /// The berth, where it is known.
    #[schema(required)]
    pub berth: Option<String>,
    /// Her heading alongside, where it is known or learnt.
    #[schema(required)]
    pub berth_heading: Option<BerthHeading>,
    /// By which firm.
    pub firm_id: FirmId,
    /// Its name.
    pub firm_name: String,
    /// On which day, in the port's time.
    pub day: NaiveDate,
    /// Start of the window in which the vessel is alongside and the firm works.
    pub from: Time,
    /// Until when.
    pub to: Time,
    /// State of the job.
    pub state: JobState,
    /// Whether a person pinned it.
    pub pinned: bool,
    /// The orders by which it is offered or agreed, one for each compass.
    pub orders: Vec<OrderId>,
    /// Orders under way that say something else: they are to be cancelled, or moved by
    /// agreement, before this can be offered. Those that every firm declined are cancelled
    /// when it is.
    pub instead_of: Vec<OrderId>,
    /// The last day on which it would be in time.
    pub due_on: NaiveDate,
    /// Urgency of the due date.
    pub urgency: Urgency,
    /// Reason of the due date.
    pub reason: String,
    /// Days after the due date.
    pub late_days: i64,
    /// The chance that she is not there, 0 to 1.
    pub chance_of_missing: f64,
    /// The firm's fee, euros.
    pub fee_eur: f64,
    /// Its part of the team's travel, euros.
    pub travel_eur: f64,
    /// Other terms of the cost.
    pub weighed: Weighed,
}

/// Need that could not be scheduled, or only late.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = UnscheduledNeed)]
pub struct Unscheduled {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compasses.
    pub compasses: Vec<Compass>,
    /// Due date.
    pub due_on: NaiveDate,
    /// Urgency of the due date.
    pub urgency: Urgency,
    /// Reason of the due date.
    pub reason: String,
    /// Orders under way that firms are asked for or hold though nothing is planned: to be
    /// cancelled, or moved by agreement.
    #[serde(default)]
    pub orders: Vec<OrderId>,
    /// Whether it is in the plan, after the due date.
    pub planned_late: bool,
    /// Reasons why it could not be scheduled in time.
    pub because: Vec<String>,
    /// Changes that would have made it possible, the nearest first.
    pub would_help: Vec<String>,
}

/// Change of a job against the previous plan, or a new job.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanChange)]
pub struct Change {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compasses.
    pub compasses: Vec<Compass>,
    /// Kind of change.
    pub what: ChangeKind,
    /// Previous place.
    #[schema(required)]
    pub from: Option<Place>,
    /// New place.
    #[schema(required)]
    pub to: Option<Place>,
    /// Reason.
    pub why: String,
}

/// Place and day of a job, with its price.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanPlace)]
pub struct Place {
    /// At which call.
    pub call_id: CallId,
    /// The port's name; empty where the call is not known any more.
    pub port_name: String,
    /// By which firm.
    pub firm_id: FirmId,
    /// Its name.
    pub firm_name: String,
    /// On which day.
    pub day: NaiveDate,
    /// Fee and travel, euros; none where no plan had it so.
    #[schema(required)]
    pub paid_eur: Option<f64>,
}

/// A compass that is due after the horizon.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = LaterNeed)]
pub struct Later {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compass.
    #[serde(flatten)]
    pub compass: Compass,
    /// Due date.
    pub due_on: NaiveDate,
    /// Reason.
    pub reason: String,
}

/// A compass whose order is under way beside the plan.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = NeedUnderWay)]
pub struct UnderWay {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compass.
    #[serde(flatten)]
    pub compass: Compass,
    /// The order.
    pub order_id: OrderId,
    /// Reason why it is beside the plan.
    pub why: String,
}

/// A firm that could not be planned with.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = FirmLeftOut)]
pub struct LeftOut {
    /// The firm.
    pub firm_id: FirmId,
    /// Its name.
    pub firm_name: String,
    /// Reason.
    pub why: String,
}

impl Plan {
    /// The job that adjusts a compass.
    pub fn job_of(&self, compass: CompassId) -> Option<&Job> {
        self.jobs.iter().find(|job| job.is_for(compass))
    }
}

impl Job {
    /// Returns whether the job includes a compass.
    pub fn is_for(&self, compass: CompassId) -> bool {
        self.compasses.iter().any(|one| one.compass_id == compass)
    }
}
