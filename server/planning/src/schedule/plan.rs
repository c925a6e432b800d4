//! The stored plan: the solver's result with names.

use binnacle_platform::ids::{CallId, CompassId, FirmId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::calls::BerthHeading;
use binnacle_schedule::input::JobState;
use binnacle_schedule::needs::Urgency;
use binnacle_schedule::plan::{ChangeKind, CostedOption};
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Reason for leaving out a firm without terms, which may hold orders all the same.
pub(super) const NO_TERMS: &str = "its terms are not set";

/// Plan of a fleet: jobs, their quality, and the needs that could not be met.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = SchedulePlan)]
pub struct Plan {
    /// Version, counted from 1 for each operator.
    pub version: i64,
    /// Time of creation.
    pub solved_at: Time,
    /// Time of the input, at the start of an hour.
    pub as_of: Time,
    /// Time taken to solve, seconds.
    pub solved_in_s: f64,
    /// SHA-256 of the input, hexadecimal; equal input makes no new plan.
    pub input_sha256: String,
    /// Cost by the weights, including unmet needs.
    pub cost_eur: f64,
    /// Lower bound of the cost of any plan.
    pub bound_eur: f64,
    /// Distance of the cost from the bound, per cent of the cost.
    pub gap_percent: f64,
    /// `true` when the plan is proven optimal.
    pub proven_optimal: bool,
    /// Fees and travel to be paid.
    pub paid_eur: f64,
    /// Comparison with the previous plan; `null` for the first.
    #[schema(required)]
    pub against: Option<Against>,
    /// Jobs, in order of the day.
    pub jobs: Vec<Job>,
    /// Needs that could not be scheduled, or only late.
    pub unscheduled: Vec<Unscheduled>,
    /// Changes against the previous plan.
    pub changes: Vec<Change>,
    /// Compasses that are due after the horizon.
    pub later: Vec<Later>,
    /// Compasses whose order is under way beside the plan.
    pub under_way: Vec<UnderWay>,
    /// Firms that could not be planned with.
    pub left_out: Vec<LeftOut>,
}

/// Comparison of a plan with the previous one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanAgainst)]
pub struct Against {
    /// Version of the previous plan.
    pub version: i64,
    /// Extra cost by the weights; negative when this plan costs less.
    pub cost_eur: f64,
    /// Extra fees and travel, euros.
    pub paid_eur: f64,
    /// Number of the previous plan's jobs that moved or were dropped.
    pub moved: usize,
}

/// Compass of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PlannedCompass)]
pub struct Compass {
    /// The compass.
    pub compass_id: CompassId,
    /// Name of the compass.
    pub compass_name: String,
}

/// Job: one visit of a firm to a vessel.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = PlannedJob)]
pub struct Job {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// The compasses to adjust.
    pub compasses: Vec<Compass>,
    /// The port call.
    pub call_id: CallId,
    /// UN/LOCODE of the port.
    #[schema(example = "NLRTM")]
    pub port: String,
    /// Name of the port.
    pub port_name: String,
    /// The berth, where known.
    #[schema(required)]
    pub berth: Option<String>,
    /// Heading of the vessel alongside, where known or learnt.
    #[schema(required)]
    pub berth_heading: Option<BerthHeading>,
    /// The firm.
    pub firm_id: FirmId,
    /// Name of the firm.
    pub firm_name: String,
    /// The day, in the port's time.
    pub day: NaiveDate,
    /// Beginning of the job on board.
    pub from: Time,
    /// Its end.
    pub to: Time,
    /// Beginning in the port's legal time.
    #[serde(default)]
    #[schema(example = "2026-12-08T08:00:00+01:00")]
    pub from_local: String,
    /// End in the port's legal time.
    #[serde(default)]
    #[schema(example = "2026-12-08T11:00:00+01:00")]
    pub to_local: String,
    /// Team of the firm: its name, or a number from 1 where its teams are alike; empty in a plan of
    /// an older release, whose `from` and `to` bound the day's hours.
    #[serde(default)]
    pub team: String,
    /// State of the job.
    pub state: JobState,
    /// `true` when a person pinned it.
    pub pinned: bool,
    /// Work orders of the job, one for each compass that is offered or agreed.
    pub orders: Vec<OrderId>,
    /// Orders under way with another firm, call or day: to be cancelled, or moved by agreement,
    /// before the job can be offered. Offering it cancels those that every firm declined.
    pub instead_of: Vec<OrderId>,
    /// Due date.
    pub due_on: NaiveDate,
    /// Urgency of the due date.
    pub urgency: Urgency,
    /// Reason of the due date.
    pub reason: String,
    /// Number of days after the due date.
    pub late_days: i64,
    /// Probability that the vessel is not there, 0 to 1.
    pub chance_of_missing: f64,
    /// Fee of the firm, euros.
    pub fee_eur: f64,
    /// Share of the team's travel, euros.
    pub travel_eur: f64,
    /// Other terms of the cost.
    pub weighed: CostedOption,
}

/// Need that could not be scheduled, or only late.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = UnscheduledNeed)]
pub struct Unscheduled {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// The compasses.
    pub compasses: Vec<Compass>,
    /// Due date.
    pub due_on: NaiveDate,
    /// Urgency of the due date.
    pub urgency: Urgency,
    /// Reason of the due date.
    pub reason: String,
    /// Orders that are offered or accepted though no job is planned: to be cancelled, or moved by
    /// agreement.
    #[serde(default)]
    pub orders: Vec<OrderId>,
    /// `true` when it is in the plan after the due date.
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
    /// Name of the vessel.
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

/// Place and time of a job, with its price.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanPlace)]
pub struct Place {
    /// The port call.
    pub call_id: CallId,
    /// Name of the port; empty when the call is no longer known.
    pub port_name: String,
    /// The firm.
    pub firm_id: FirmId,
    /// Name of the firm.
    pub firm_name: String,
    /// The day.
    pub day: NaiveDate,
    /// Beginning, if it is known.
    #[serde(default)]
    #[schema(required)]
    pub from: Option<Time>,
    /// Fee and travel, euros; `null` when no plan had this job.
    #[schema(required)]
    pub paid_eur: Option<f64>,
}

/// Compass that is due after the horizon.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = LaterNeed)]
pub struct Later {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// The compass.
    #[serde(flatten)]
    pub compass: Compass,
    /// Due date.
    pub due_on: NaiveDate,
    /// Reason.
    pub reason: String,
}

/// Compass whose order is under way beside the plan.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = NeedUnderWay)]
pub struct UnderWay {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// The compass.
    #[serde(flatten)]
    pub compass: Compass,
    /// The order.
    pub order_id: OrderId,
    /// Reason why it is beside the plan.
    pub why: String,
}

/// Firm that could not be planned with.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = FirmLeftOut)]
pub struct LeftOut {
    /// The firm.
    pub firm_id: FirmId,
    /// Name of the firm.
    pub firm_name: String,
    /// Reason.
    pub why: String,
}

impl Plan {
    /// Returns the vessels whose jobs differ from the previous plan, each once.
    pub(super) fn changed_vessels(&self) -> Vec<VesselId> {
        let changes = self.changes.iter();
        let mut vessels: Vec<VesselId> = changes
            .filter(|change| change.what != ChangeKind::Kept)
            .map(|change| change.vessel_id)
            .collect();
        vessels.sort_unstable();
        vessels.dedup();
        vessels
    }

    /// Returns the job that adjusts a compass.
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
