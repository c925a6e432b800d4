//! Causes of alerts.
//!
//! Invariant: all that is particular to a cause stands in its row of the table in `causes`.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Cause of an alert: one compass has at most one open alert of each.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = AlertCause)]
pub enum Cause {
    /// The deviation exceeds the vessel's limit on some heading.
    DeviationOverLimit,
    /// Gyro and satellite compass contradict each other.
    ReferenceFault,
    /// The magnetic compass sticks, repeats itself or swings.
    CompassFault,
    /// A strike, or a heavy blow to the hull.
    LightningOrShock,
    /// Steel, scrap or the like on board.
    MagneticCargo,
    /// The ship's magnetism wandered off.
    Drift,
    /// The compass's zero moved: its lubber line, its seat, or its sensor.
    Alignment,
    /// The earth's crust, at a place.
    LocalAnomaly,
    /// The sun, for hours.
    MagneticStorm,
    /// The quay's and its cranes' iron.
    BerthSteel,
    /// A change of which no cause is likely.
    UnknownChange,
    /// Headings at sea do not agree with what an adjustment foretold.
    AdjustmentNotConfirmed,
    /// An adjustment that was agreed with a firm does not fit any more.
    AgreedJobAtRisk,
    /// The ship's agent says that compass and gyro have parted.
    ReportedAboard,
    /// Nothing has come from the vessel for too long.
    SilentAgent,
    /// Two computers send as one agent.
    ClonedAgent,
    /// There is no model although samples have come for a while.
    NoModel,
    /// The model is less certain than the vessel's limit asks.
    WideBand,
}
