//! OpenAPI schemas of types of `binnacle_schedule`.

use serde::Serialize;
use utoipa::ToSchema;

/// Urgency of a need.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = Urgency)]
#[allow(dead_code, reason = "describes binnacle_schedule::needs::Urgency")]
pub enum UrgencySchema {
    /// There is time.
    Routine,
    /// Due soon.
    Soon,
    /// Due very soon, or the card is not to be trusted.
    Urgent,
    /// The due date has passed.
    Overdue,
}

/// Cause of a due date.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = NeedCauseKind)]
#[allow(dead_code, reason = "describes binnacle_schedule::needs::CauseKind")]
pub(super) enum CauseKindSchema {
    /// No adjustment is on record.
    NeverAdjusted,
    /// A rule's interval ends.
    Interval,
    /// A rule asks for an adjustment after an event.
    Event,
    /// Predicted deviation is over a rule's limit, or the vessel's own.
    OverLimit,
    /// A transit asks for a newer table or a smaller deviation.
    Transit,
    /// The ship's magnetism changed.
    Change,
    /// The last adjustment did not pass at sea.
    FailedVerification,
}

/// Direction of a deviation.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = DeviationSide)]
#[allow(dead_code, reason = "describes binnacle_schedule::needs::Side")]
pub(super) enum SideSchema {
    /// Its north lies east of magnetic north.
    East,
    /// Its north lies west of magnetic north.
    West,
}
