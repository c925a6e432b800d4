//! A schedule, as it is answered in JSON.

use crate::calls::BerthHeading;
use crate::input::JobState;
use crate::needs::Urgency;
use crate::ports::PortCode;
use crate::time::Instant;
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// Who does what where and when, how good that is, and what could not be done.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Schedule {
    /// What the plan costs by the weights, all that is unmet included.
    pub cost_eur: f64,
    /// What no plan can cost less than.
    pub bound_eur: f64,
    /// How far the cost is above the bound, in per cent of the cost.
    pub gap_percent: f64,
    /// Whether no plan is better.
    pub proven_optimal: bool,
    /// Fees and travel that are really paid.
    pub paid_eur: f64,
    /// The jobs, in order of the day.
    pub jobs: Vec<PlannedJob>,
    /// What could not be scheduled, or only late.
    pub unscheduled: Vec<Unscheduled>,
    /// What became of the former plan's jobs, and what is new.
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
    /// At which call.
    pub call: String,
    /// In which port.
    pub port: PortCode,
    /// The port's name.
    pub port_name: &'static str,
    /// By which firm.
    pub firm: String,
    /// On which day, in the port's time.
    pub day: NaiveDate,
    /// From when the ship is alongside and the firm at work.
    pub from: Instant,
    /// Until when.
    pub to: Instant,
    /// The ship's heading alongside, where it is known.
    pub berth_heading: Option<BerthHeading>,
    /// How far it got already.
    pub state: JobState,
    /// The last day on which it would be in time.
    pub due: NaiveDate,
    /// How much it presses.
    pub urgency: Urgency,
    /// Why it is due.
    pub reason: String,
    /// Days after the due date.
    pub late_days: i64,
    /// The chance that the ship is not there.
    pub chance_of_missing: f64,
    /// The firm's fee.
    pub fee_eur: f64,
    /// Its part of the team's travel.
    pub travel_eur: f64,
    /// What else it was weighed by.
    pub weighed: Weighed,
}

/// What a job was weighed by beside what is paid, in euros.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weighed {
    /// The chance of missing the ship.
    pub risk_eur: f64,
    /// The days until then.
    pub waiting_eur: f64,
    /// The days after the due date that are still to come, and being late at all.
    pub late_eur: f64,
    /// The days before it.
    pub early_eur: f64,
    /// Departing from the former plan.
    pub changed_eur: f64,
}

/// What could not be scheduled, or only late.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unscheduled {
    /// The needs.
    pub needs: Vec<String>,
    /// The ship.
    pub vessel: String,
    /// When it is due.
    pub due: NaiveDate,
    /// How much it presses.
    pub urgency: Urgency,
    /// Why it is due.
    pub reason: String,
    /// Whether it is in the plan, after the due date.
    pub planned_late: bool,
    /// Why it could not be.
    pub because: Vec<String>,
    /// What would have made it possible, the nearest first.
    pub would_help: Vec<String>,
}

/// What became of a job of the former plan, or that there is a new one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// The needs.
    pub needs: Vec<String>,
    /// What became of it.
    pub what: ChangeKind,
    /// Where it was.
    pub from: Option<Place>,
    /// Where it is now.
    pub to: Option<Place>,
    /// Why.
    pub why: String,
}

/// What became of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangeKind {
    /// It stands as it was.
    Kept,
    /// Another call, firm or day.
    Moved,
    /// It was not in the former plan.
    New,
    /// It is not in the plan any more.
    Dropped,
}

/// Where and when a job is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Place {
    /// At which call.
    pub call: String,
    /// By which firm.
    pub firm: String,
    /// On which day.
    pub day: NaiveDate,
}

/// A need that is due after the horizon.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Later {
    /// The need.
    pub need: String,
    /// When it is due.
    pub due: NaiveDate,
    /// Why.
    pub reason: String,
}
