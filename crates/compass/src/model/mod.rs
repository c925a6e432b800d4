//! A vessel's fitted magnetic model, as stored and sent on board.

mod json;
mod needles;
mod reference_grade;
mod variation_mistake;

pub use needles::NeedleInduction;
pub use reference_grade::{Directions, ReferenceGrade};
pub use variation_mistake::VariationMistake;

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// The seven ratios that headings determine: Poisson's parameters over λ.
///
/// Fields are in nanotesla, soft-iron coefficients dimensionless. Ship axes:
/// x forward, y starboard, z down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = ParametersOverLambda))]
pub struct Parameters {
    /// Fore-and-aft permanent field over λ (P), nT, forward positive.
    pub bx_nt: f64,
    /// χ13/λ (c): fore-and-aft field from the vertical earth field.
    pub chi13: f64,
    /// Athwartship permanent field over λ (Q), nT, starboard positive.
    pub by_nt: f64,
    /// χ23/λ (f): athwartship field from the vertical earth field.
    pub chi23: f64,
    /// (χ11 − χ22)/λ (a − e), twice the exact coefficient D.
    pub chi11_minus_chi22: f64,
    /// χ12/λ (b).
    pub chi12: f64,
    /// χ21/λ (d).
    pub chi21: f64,
}

/// Covariance of the seven parameters, in the order of [`Parameters`], and of the constant,
/// last. Units are the products of nT, 1 and degrees.
pub type Covariance = [[f64; 8]; 8];

/// Parameters determined by the data; a `false` one rests on the prior.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[allow(clippy::struct_excessive_bools)] // one for each parameter, by name
pub struct Identifiable {
    /// bx separately from χ13 Z.
    pub bx_nt: bool,
    /// χ13 separately from bx.
    pub chi13: bool,
    /// by separately from χ23 Z.
    pub by_nt: bool,
    /// χ23 separately from by.
    pub chi23: bool,
    /// D.
    pub chi11_minus_chi22: bool,
    /// χ12.
    pub chi12: bool,
    /// χ21.
    pub chi21: bool,
    /// The constant separately from A: never from headings alone.
    pub constant_deg: bool,
}

/// Evidence behind a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Quality {
    /// Effective sample size: the number of samples with independent errors that would
    /// determine the deviation, at the last position, as well as all samples together. A
    /// gyro's errors last for hours and days, so samples repeat each other.
    pub effective_samples: f64,
    /// Condition of the fit: standard error of the worst known combination of parameters
    /// over that of the best, by the data alone and in units of the prior; none where the
    /// data leave a combination undetermined.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub condition: Option<f64>,
    /// Share of each parameter's knowledge that comes from the data.
    pub from_data: FromData,
    /// Uses for which the model should not be trusted.
    pub cautions: Vec<Caution>,
}

/// Share of the prior variance of each parameter and the constant that the data removed: 0
/// rests on the prior alone, 1 on the data alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct FromData {
    /// Share for bx, 0 to 1.
    pub bx_nt: f64,
    /// Share for χ13, 0 to 1.
    pub chi13: f64,
    /// Share for by, 0 to 1.
    pub by_nt: f64,
    /// Share for χ23, 0 to 1.
    pub chi23: f64,
    /// Share for χ11 − χ22, 0 to 1.
    pub chi11_minus_chi22: f64,
    /// Share for χ12, 0 to 1.
    pub chi12: f64,
    /// Share for χ21, 0 to 1.
    pub chi21: f64,
    /// Share for the constant, 0 to 1.
    pub constant_deg: f64,
}

/// A limitation of a model that is otherwise the best available.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(tag = "caution", rename_all = "snake_case")]
pub enum Caution {
    /// The range of magnetic latitudes is too narrow: only the sums bx + χ13 Z and by + χ23
    /// Z are known, so elsewhere the prior dominates.
    #[error(
        "all samples are from one magnetic latitude, where permanent and induced magnetism \
         cannot be separated: far from there the band rests on experience with other ships"
    )]
    OneMagneticLatitude,
    /// The range of magnetic latitudes is wide enough to separate bx from χ13 Z and by from
    /// χ23 Z, but the samples are too few.
    #[error(
        "too few samples to tell permanent from induced magnetism: in other waters the band \
         rests on experience with other ships"
    )]
    FewSamples,
    /// The rows have no times, so samples with a common gyro error are not known.
    #[error(
        "the rows have no times, so common errors of the reference are unknown: the band treats \
         rows on similar headings as those of half a day"
    )]
    NoTimes,
    /// Residuals are larger than those of sound instruments.
    #[error(
        "residuals of {residual_deg:.1} degrees are larger than those of sound instruments: \
         check compass, reference and columns before using the figures"
    )]
    LargeResiduals {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
    },
    /// The last samples follow a long gap, in which the ship may have changed.
    #[error(
        "no samples for {days:.0} days before the last ones: the model applies at {last}, and \
         its band allows for changes of the ship in that time"
    )]
    LongGap {
        /// Length of the gap, days.
        days: f64,
        /// Time of the last sample.
        last: Timestamp,
    },
    /// Some samples are from a weak horizontal field, where a compass is sluggish and small
    /// fields disturb it.
    #[error("samples from a horizontal field of only {h_nt:.0} nT")]
    WeakField {
        /// Weakest horizontal field, nT.
        h_nt: f64,
    },
    /// The compass's zero is off by about a multiple of the variation, which hardly changes in
    /// the samples.
    #[error(
        "the compass's zero seems to be off by {zero_deg:.1} degrees, as it would seem if, of \
         the reference, {mistake}: the samples do not show which, and the band allows for both"
    )]
    VariationUnproven {
        /// Mistake of the reference that would explain it.
        mistake: VariationMistake,
        /// Constant of the deviation as the reference stands, degrees, east positive.
        zero_deg: f64,
    },
    /// A caution from a later version of the program.
    #[error("a caution unknown to this version of the program")]
    #[serde(other)]
    Other,
}

/// A fitted model: output of `fit`, stored by the server, and used on board. Its JSON is
/// described in docs/model.md.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "json::Form", into = "json::Form")]
pub struct Model {
    /// Seven ratios to λ.
    pub parameters_over_lambda: Parameters,
    /// Constant added to the exact deviation: alignment, reference and variation offsets,
    /// degrees, east positive.
    pub constant_deg: f64,
    /// Covariance, 8 × 8; none for a model without one.
    pub covariance: Option<Covariance>,
    /// Parameters determined by the data.
    pub identifiable: Option<Identifiable>,
    /// Root mean square of the residuals, degrees.
    pub rms_deg: Option<f64>,
    /// Number of samples with weight.
    pub samples_used: u64,
    /// Number of samples left out or rejected as outliers.
    pub samples_rejected: u64,
    /// Evidence behind the model; none for a model without it.
    pub quality: Option<Quality>,
    /// Source of the true headings behind the model.
    pub reference_grade: ReferenceGrade,
    /// Harmonic mean of the horizontal field over the samples, nT; none where unknown.
    pub mean_h_nt: Option<f64>,
    /// The needles' part of D and E; none where the correctors are unknown.
    pub needles: Option<NeedleInduction>,
}

impl Model {
    /// Returns the horizontal field at which the ratios contain the needles' part, nT; none
    /// where unknown.
    pub fn reference_h_nt(&self) -> Option<f64> {
        let of_needles = self.needles.map(|needles| needles.reference_h_nt);
        of_needles.or(self.mean_h_nt)
    }
}
