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
    /// Lightning, or a heavy blow to the hull.
    LightningOrShock,
    /// Steel, scrap or the like on board.
    MagneticCargo,
    /// Slow drift of the ship's magnetism.
    Drift,
    /// Shift of the compass's zero: of its lubber line, its seat, or its sensor.
    Alignment,
    /// Local anomaly of the earth's crust.
    LocalAnomaly,
    /// Magnetic storm, for hours.
    MagneticStorm,
    /// Iron of the quay and its cranes.
    BerthSteel,
    /// Jamming or spoofing of the receivers of satellites.
    GnssInterference,
    /// A change without a likely cause.
    UnknownChange,
    /// Headings at sea contradict the prediction of an adjustment.
    AdjustmentNotConfirmed,
    /// An adjustment that was agreed with a firm no longer fits the schedule.
    AgreedJobAtRisk,
    /// The ship's agent reports that compass and gyro have parted.
    #[serde(rename = "reported_aboard")]
    #[sqlx(rename = "reported_aboard")]
    ReportedByAgent,
    /// The vessel has uploaded nothing for too long.
    SilentAgent,
    /// Two computers send as one agent.
    ClonedAgent,
    /// There is no model although there have been samples for a while.
    NoModel,
    /// The model is less certain than the vessel's limit requires.
    WideBand,
}
