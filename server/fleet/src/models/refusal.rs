//! OpenAPI description of the reasons for which the science crate refuses a model.

use serde::Serialize;
use utoipa::ToSchema;

/// Reason for which a model is refused.
#[derive(Serialize, ToSchema)]
#[serde(tag = "reason", rename_all = "snake_case")]
#[schema(as = Refusal)]
#[allow(dead_code, reason = "describes binnacle_compass::result::FitError")]
pub enum RefusalSchema {
    /// No sample has a heading of gyro or satellite compass.
    NoReference {
        /// Number of samples.
        readings: u64,
    },
    /// Every sample has the weight 0; only in fits of a file.
    NoWeight {
        /// Number of samples.
        samples: u64,
    },
    /// Too few usable samples, whatever their headings.
    TooFewSamples {
        /// Number of usable samples.
        found: u64,
        /// Number that is needed.
        needed: u64,
    },
    /// The samples lie on too few headings.
    TooFewHeadings {
        /// Sectors of 15° with at least one sample.
        found: u32,
        /// Number that is needed.
        needed: u32,
        /// Widest range of headings without a sample, degrees.
        widest_gap_deg: f64,
        /// Widest such range that is allowed, degrees.
        allowed_gap_deg: f64,
        /// Headings without a sample, in whole sectors of 15°. Each range is its first degree and
        /// the one after its last, beyond 360 through north.
        missing_deg: Vec<[u32; 2]>,
    },
    /// The earth's horizontal field is too weak for a compass in all samples.
    FieldTooWeak {
        /// Strongest horizontal field among them, nT.
        strongest_nt: f64,
        /// Horizontal field that is needed, nT.
        needed_nt: f64,
    },
    /// The fitted magnetism leaves no directive force on some heading.
    AmbiguousHeadings {
        /// Horizontal field at which that happens, nT.
        h_nt: f64,
    },
    /// All samples have the same dip; only in fits without a prior from other ships.
    OneMagneticLatitude,
    /// Gyro and satellite compass differ throughout by more than any alignment explains.
    ReferencesDisagree {
        /// Gyro less satellite compass, degrees.
        offset_deg: f64,
        /// Greatest difference that is allowed, degrees.
        allowed_deg: f64,
    },
    /// The only reference stood still while the ship turned.
    ReferenceStuck {
        /// Number of readings in which it did.
        readings: u64,
    },
    /// The residuals of the best fit are larger than instruments cause: a variation of the wrong
    /// sign, exchanged columns, or a reference that is none.
    Contradictory {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
        /// Greatest value that is allowed, degrees.
        allowed_deg: f64,
    },
    /// The fit does not converge: the samples contradict each other, or any ship.
    NotConverged,
}
