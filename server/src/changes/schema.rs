//! How the OpenAPI document describes what the science crate says of a change.

use serde::Serialize;
use utoipa::ToSchema;

/// What changes what a compass shows.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ChangeCause)]
#[allow(dead_code, reason = "describes binnacle_compass::result::Cause")]
pub(super) enum CauseSchema {
    /// A strike, or a heavy blow to the hull.
    LightningOrShock,
    /// Steel, scrap or the like on board.
    MagneticCargo,
    /// Correctors, compass or structure were worked on.
    AdjustmentOrRepair,
    /// The ship's magnetism wandered off.
    Drift,
    /// The magnetic compass sticks, repeats itself or swings.
    CompassFault,
    /// The compass's zero moved: its lubber line, its seat, or the element that sends its
    /// heading on.
    Alignment,
    /// Gyro or satellite compass errs: the magnetic compass is well.
    ReferenceFault,
    /// The earth's crust, at a place.
    LocalAnomaly,
    /// The sun, for hours.
    MagneticStorm,
    /// The quay's and its cranes' iron.
    BerthSteel,
    /// None of these is likely.
    Unknown,
}

/// A cause and how likely it is.
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
    /// Athwart, starboard positive.
    #[schema(example = -640.0)]
    by_nt: f64,
    /// Standard error of the first.
    #[schema(example = 120.0)]
    bx_se_nt: f64,
    /// Standard error of the second.
    #[schema(example = 95.0)]
    by_se_nt: f64,
}
