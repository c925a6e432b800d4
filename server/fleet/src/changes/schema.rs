//! OpenAPI descriptions of the changes of the science crate.

use serde::Serialize;
use utoipa::ToSchema;

/// Cause of a change of what a compass shows.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ChangeCause)]
#[allow(dead_code, reason = "describes binnacle_compass::result::Cause")]
pub(super) enum CauseSchema {
    /// Lightning, or a heavy blow to the hull.
    LightningOrShock,
    /// Steel, scrap or the like on board.
    MagneticCargo,
    /// Work on correctors, compass or structure.
    AdjustmentOrRepair,
    /// Slow drift of the ship's magnetism.
    Drift,
    /// Fault of the magnetic compass: it sticks, repeats itself or swings.
    CompassFault,
    /// Shift of the compass's zero: of its lubber line, its seat, or the element that transmits
    /// its heading.
    Alignment,
    /// Fault of gyro or satellite compass, not of the magnetic compass.
    ReferenceFault,
    /// Local anomaly of the earth's crust.
    LocalAnomaly,
    /// Magnetic storm, for hours.
    MagneticStorm,
    /// Iron of the quay and its cranes.
    BerthSteel,
    /// None of these is likely.
    Unknown,
}

/// A cause and its probability.
#[derive(ToSchema)]
#[schema(as = CauseProbability)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::result::CauseProbability"
)]
pub(super) struct CauseProbabilitySchema {
    cause: CauseSchema,
    /// From 0 to 1.
    #[schema(example = 0.93)]
    probability: f64,
}

/// A step of permanent magnetism over the shielding factor, nT.
#[derive(ToSchema)]
#[schema(as = Step)]
#[allow(
    dead_code,
    clippy::struct_field_names,
    reason = "describes binnacle_compass::result::Step"
)]
pub(super) struct StepSchema {
    /// Fore and aft, forward positive.
    #[schema(example = 1850.0)]
    bx_nt: f64,
    /// Athwartships, starboard positive.
    #[schema(example = -640.0)]
    by_nt: f64,
    /// Standard error of the first.
    #[schema(example = 120.0)]
    bx_se_nt: f64,
    /// Standard error of the second.
    #[schema(example = 95.0)]
    by_se_nt: f64,
}
