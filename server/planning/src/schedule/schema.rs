//! OpenAPI schemas of types of `binnacle_schedule`.

use serde::Serialize;
use utoipa::ToSchema;

/// State of a job.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = PlannedJobState)]
#[allow(dead_code, reason = "describes binnacle_schedule::input::JobState")]
pub(super) enum JobStateSchema {
    /// Planned, and nobody was asked.
    Proposed,
    /// The firm was asked.
    Offered,
    /// The firm accepted.
    Confirmed,
}

/// Kind of change of a job.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = PlanChangeKind)]
#[allow(dead_code, reason = "describes binnacle_schedule::plan::ChangeKind")]
pub(super) enum ChangeKindSchema {
    /// It stands as it was.
    Kept,
    /// Another call, firm or day.
    Moved,
    /// It was not in the plan before.
    New,
    /// It is not in the plan any more.
    Dropped,
}

/// A heading alongside.
#[derive(ToSchema)]
#[schema(as = PlannedBerthHeading)]
#[allow(dead_code, reason = "describes binnacle_schedule::calls::BerthHeading")]
pub(super) struct HeadingSchema {
    /// Degrees, true.
    heading_deg: f64,
    /// `given`, or learnt at the same `berth` or `port`.
    source: String,
}

/// Terms of a job's cost beside payments, euros.
#[derive(ToSchema)]
#[schema(as = PlannedJobWeighed)]
#[allow(
    dead_code,
    clippy::struct_field_names,
    reason = "describes binnacle_schedule::plan::Weighed"
)]
pub(super) struct WeighedSchema {
    /// The chance of missing the ship.
    risk_eur: f64,
    /// The days until then.
    waiting_eur: f64,
    /// The days after the due date.
    late_eur: f64,
    /// The days before it.
    early_eur: f64,
    /// Departing from the plan before.
    changed_eur: f64,
}
