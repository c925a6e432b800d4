//! The schedule as JSON.

use crate::calls::BerthHeading;
use crate::input::JobState;
use crate::needs::Urgency;
use crate::ports::PortCode;
use crate::time::Instant;
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// Jobs with their costs, and the needs that could not be scheduled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Schedule {
    /// Cost of the plan by the weights, with all unmet needs.
    pub cost_eur: f64,
    /// Lower bound of the cost of any plan.
    pub bound_eur: f64,
    /// Gap between cost and bound, in per cent of the cost.
    pub gap_percent: f64,
    /// True if no plan is better.
    pub proven_optimal: bool,
    /// Fees and travel that are actually paid.
    pub paid_eur: f64,
    /// The jobs, in order of the day.
    pub jobs: Vec<PlannedJob>,
    /// Needs that could not be scheduled, or only late.
    pub unscheduled: Vec<Unscheduled>,
    /// Changes from the previous plan.
    pub changes: Vec<Change>,
    /// Needs that are due after the horizon.
    pub later: Vec<Later>,
}

/// One job.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedJob {
    /// The needs that it meets.
    pub needs: Vec<String>,
    /// The ship.
    pub vessel: String,
    /// The call.
    pub call: String,
    /// The port.
    pub port: PortCode,
    /// The port's name.
    pub port_name: &'static str,
    /// The firm.
    pub firm: String,
    /// The day, in the port's time.
    pub day: NaiveDate,
    /// Beginning on board: the ship is alongside, and the team at work and there.
    pub from: Instant,
    /// End on board.
    pub to: Instant,
    /// The team: its name, or a number from 1 among those that are alike.
    pub team: String,
    /// The ship's heading alongside, if known.
    pub berth_heading: Option<BerthHeading>,
    /// Progress of the job.
    pub state: JobState,
    /// The last day in time.
    pub due: NaiveDate,
    /// Urgency.
    pub urgency: Urgency,
    /// Reason why it is due.
    pub reason: String,
    /// Days after the due date.
    pub late_days: i64,
    /// Probability that the ship is not there.
    pub chance_of_missing: f64,
    /// The firm's fee.
    pub fee_eur: f64,
    /// Its share of the team's travel.
    pub travel_eur: f64,
    /// Weighted costs.
    pub weighed: CostedOption,
}

/// Weighted costs of a job beyond what is paid, in euros.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlannedJobWeighed))]
pub struct CostedOption {
    /// Risk of missing the ship, euros.
    pub risk_eur: f64,
    /// Days of waiting, euros.
    pub waiting_eur: f64,
    /// Days to come after the due date, and lateness itself, euros.
    pub late_eur: f64,
    /// Days before the due date, euros.
    pub early_eur: f64,
    /// Departure from the previous plan, euros.
    pub changed_eur: f64,
}

/// Needs that could not be scheduled, or only late.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unscheduled {
    /// The needs.
    pub needs: Vec<String>,
    /// The ship.
    pub vessel: String,
    /// Due date.
    pub due: NaiveDate,
    /// Urgency.
    pub urgency: Urgency,
    /// Reason why it is due.
    pub reason: String,
    /// True if it is planned, but after the due date.
    pub planned_late: bool,
    /// Reasons why it could not be scheduled.
    pub because: Vec<String>,
    /// Changes that would have made it possible, the nearest first.
    pub would_help: Vec<String>,
}

/// A change of a job from the previous plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// The needs.
    pub needs: Vec<String>,
    /// Kind of change.
    pub what: ChangeKind,
    /// Previous place.
    pub from: Option<Place>,
    /// Present place.
    pub to: Option<Place>,
    /// Reason.
    pub why: String,
}

/// Kind of change of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlanChangeKind))]
#[serde(rename_all = "snake_case")]
pub enum ChangeKind {
    /// It stays unchanged.
    Kept,
    /// Another call, firm or day.
    Moved,
    /// It was not in the previous plan.
    New,
    /// It is no longer in the plan.
    Dropped,
}

/// Place and day of a job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Place {
    /// The call.
    pub call: String,
    /// The firm.
    pub firm: String,
    /// The day.
    pub day: NaiveDate,
    /// The beginning, if known.
    pub hour: Option<Instant>,
}

/// A need that is due after the horizon.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Later {
    /// The need.
    pub need: String,
    /// Due date.
    pub due: NaiveDate,
    /// Reason.
    pub reason: String,
}
