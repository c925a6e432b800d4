//! How the OpenAPI document describes why there is no model; the reasons are the
//! science crate's.

use serde::Serialize;
use utoipa::ToSchema;

/// What a model is refused for.
#[derive(Serialize, ToSchema)]
#[serde(tag = "reason", rename_all = "snake_case")]
#[schema(as = Refusal)]
#[allow(dead_code, reason = "describes binnacle_compass::result::FitError")]
pub enum RefusalSchema {
    /// No sample has a gyro's or a satellite compass's heading.
    NoReference {
        /// How many samples there are.
        readings: u64,
    },
    /// Every sample has the weight 0; only of fits of a file.
    NoWeight {
        /// How many there are.
        samples: u64,
    },
    /// Too few usable samples, whatever their headings.
    TooFewSamples {
        /// How many there are.
        found: u64,
        /// How many there must be.
        needed: u64,
    },
    /// The samples lie on too few headings.
    TooFewHeadings {
        /// Sectors of 15° with at least one sample.
        found: u32,
        /// How many there must be.
        needed: u32,
        /// The widest range of headings without a sample, degrees.
        widest_gap_deg: f64,
        /// The widest such range that is allowed, degrees.
        allowed_gap_deg: f64,
        /// The headings without a sample: whole sectors of 15°, each range by its
        /// first degree and the one after its last, beyond 360 through north.
        missing_deg: Vec<[u32; 2]>,
    },
    /// The earth's horizontal field is too weak for a compass in all samples.
    FieldTooWeak {
        /// The strongest among them, nT.
        strongest_nt: f64,
        /// What there must be, nT.
        needed_nt: f64,
    },
    /// The magnetism found leaves no directive force on some heading.
    AmbiguousHeadings {
        /// The horizontal field at which it does, nT.
        h_nt: f64,
    },
    /// All samples have the same dip; only of fits that know no other ships.
    OneMagneticLatitude,
    /// Gyro and satellite compass differ throughout by more than any alignment
    /// explains.
    ReferencesDisagree {
        /// Gyro less satellite compass, degrees.
        offset_deg: f64,
        /// How far they may differ, degrees.
        allowed_deg: f64,
    },
    /// The only reference stood still while the ship turned.
    ReferenceStuck {
        /// In how many readings it did.
        readings: u64,
    },
    /// What the best ship leaves over is more than instruments do: a variation of
    /// the wrong sign, columns that changed places, a reference that is none.
    Contradictory {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
        /// How large it may be, degrees.
        allowed_deg: f64,
    },
    /// The samples contradict each other or any ship.
    NotConverged,
}
