//! A change as the analysis tells of it.

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Something that changed what the compass shows, or seemed to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// When it most likely happened.
    pub from: Timestamp,
    /// It hardly happened before this.
    pub from_earliest: Timestamp,
    /// Nor after this.
    pub from_latest: Timestamp,
    /// Time of the sample that told.
    pub detected_at: Timestamp,
    /// Whether it is certain enough to act on; if not, something is up and more
    /// samples will tell what.
    pub confirmed: bool,
    /// Whether it had been certain, until what came after did not bear it out: it was none.
    #[serde(default)]
    pub withdrawn: bool,
    /// The likeliest cause.
    pub cause: Cause,
    /// All causes that may be, the likeliest first.
    pub causes: Vec<CauseProbability>,
    /// Why, in plain words.
    pub evidence: Vec<String>,
    /// By how much the deviation changed where the ship was, on the heading where it
    /// changed most, degrees; none where the ship's magnetism did not change.
    pub deviation_change_deg: Option<f64>,
    /// How the ship's permanent magnetism changed; none where it did not.
    pub step: Option<Step>,
    /// When it was over; none while it lasts.
    pub ended: Option<Timestamp>,
}

/// A step of permanent magnetism over λ, nT, with its standard errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Fore and aft, forward positive.
    pub bx_nt: f64,
    /// Athwart, starboard positive.
    pub by_nt: f64,
    /// Standard error of the first.
    pub bx_se_nt: f64,
    /// Standard error of the second.
    pub by_se_nt: f64,
}

/// What changes what a compass shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
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

impl Cause {
    /// Whether the deviation is another after it: the ship is another magnet, or her
    /// compass has another zero.
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

    /// Whether it comes from outside the ship and is over within hours or miles.
    pub fn is_transient(self) -> bool {
        matches!(
            self,
            Cause::LocalAnomaly | Cause::MagneticStorm | Cause::BerthSteel
        )
    }
}

impl Change {
    /// Whether it passed by and is too faint to be certain by this ship alone: other ships
    /// may speak for it.
    pub fn is_weak_transient(&self) -> bool {
        !self.confirmed && self.ended.is_some() && self.cause.is_transient()
    }
}

/// A cause and how likely it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CauseProbability {
    /// The cause.
    pub cause: Cause,
    /// From 0 to 1.
    pub probability: f64,
}
