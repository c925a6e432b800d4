//! A change in the result of an analysis.

use crate::position::Position;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// An actual or apparent change of the compass's deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Likeliest time of the change.
    pub from: Timestamp,
    /// Earliest credible time.
    pub from_earliest: Timestamp,
    /// Latest credible time.
    pub from_latest: Timestamp,
    /// Time of the sample that revealed it.
    pub detected_at: Timestamp,
    /// Confirmed: certain enough to act on. An unconfirmed change needs more samples.
    pub confirmed: bool,
    /// Withdrawn: confirmed once, but contradicted by later samples.
    #[serde(default)]
    pub withdrawn: bool,
    /// Likeliest cause.
    pub cause: Cause,
    /// All possible causes, the likeliest first.
    pub causes: Vec<CauseProbability>,
    /// Evidence for the cause, a sentence each.
    pub evidence: Vec<String>,
    /// Greatest change of the deviation over headings at the ship's position, degrees; none
    /// where the ship's magnetism did not change.
    pub deviation_change_deg: Option<f64>,
    /// Step of the ship's permanent magnetism; none where it did not change.
    pub step: Option<Step>,
    /// End of the change; none while it lasts.
    pub ended: Option<Timestamp>,
    /// Approximate place of the ship while a passing disturbance lasted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<Position>,
    /// Greatest error of the compass while it lasted, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbed_deg: Option<f64>,
}

/// A step of permanent magnetism over λ, nT, with its standard errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Step {
    /// Fore and aft, nT, forward positive.
    #[cfg_attr(feature = "openapi", schema(example = 1850.0))]
    pub bx_nt: f64,
    /// Athwartships, nT, starboard positive.
    #[cfg_attr(feature = "openapi", schema(example = -640.0))]
    pub by_nt: f64,
    /// Standard error of `bx_nt`, nT.
    #[cfg_attr(feature = "openapi", schema(example = 120.0))]
    pub bx_se_nt: f64,
    /// Standard error of `by_nt`, nT.
    #[cfg_attr(feature = "openapi", schema(example = 95.0))]
    pub by_se_nt: f64,
}

/// Cause of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = ChangeCause))]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Lightning strike, or a heavy blow to the hull.
    LightningOrShock,
    /// Magnetic cargo on board, such as steel or scrap.
    MagneticCargo,
    /// Work on correctors, compass or structure.
    AdjustmentOrRepair,
    /// Slow drift of the ship's magnetism.
    Drift,
    /// Fault of the magnetic compass: sticking, repeating or swinging.
    CompassFault,
    /// Moved zero of the compass: lubber line, seat, or heading transmitter.
    Alignment,
    /// Fault of gyro or satellite compass; the magnetic compass is sound.
    ReferenceFault,
    /// Local anomaly of the earth's crust.
    LocalAnomaly,
    /// Magnetic storm, lasting hours.
    MagneticStorm,
    /// Steel of the quay and its cranes.
    BerthSteel,
    /// Jamming or spoofing of the receivers of satellites; the magnetic compass is sound.
    GnssInterference,
    /// None of these is likely.
    Unknown,
}

impl Cause {
    /// Returns true when the deviation is different afterwards: the ship's magnetism or the
    /// compass's zero has changed.
    pub fn changes_deviation(self) -> bool {
        matches!(
            self,
            Cause::LightningOrShock
                | Cause::MagneticCargo
                | Cause::AdjustmentOrRepair
                | Cause::Drift
                | Cause::Alignment
                | Cause::Unknown
        )
    }

    /// Returns true for an external cause that ends within hours or miles.
    pub fn is_transient(self) -> bool {
        matches!(
            self,
            Cause::LocalAnomaly | Cause::MagneticStorm | Cause::BerthSteel
        )
    }
}

impl Change {
    /// Returns true for an ended transient that this ship alone cannot confirm; other ships
    /// may.
    pub fn is_weak_transient(&self) -> bool {
        !self.confirmed && self.ended.is_some() && self.cause.is_transient()
    }
}

/// A cause and its probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CauseProbability {
    /// Cause.
    pub cause: Cause,
    /// Probability, 0 to 1.
    #[cfg_attr(feature = "openapi", schema(example = 0.93))]
    pub probability: f64,
}
