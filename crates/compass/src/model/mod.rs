//! A ship's magnetic model as it is fitted, stored and sent to the bridge.

mod json;

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// The seven ratios that headings alone can tell: Poisson's parameters over λ.
///
/// Fields are in nanotesla, soft-iron coefficients dimensionless. Ship axes:
/// x forward, y starboard, z down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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

/// Variances and covariances of the seven parameters, in the order of
/// [`Parameters`], and of the constant, last: units are the products of nT, 1
/// and degrees.
pub type Covariance = [[f64; 8]; 8];

/// Which of the seven parameters and the constant the data determine; what is
/// `false` rests on the prior.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(clippy::struct_excessive_bools)] // one answer for each parameter, by name
pub struct Identifiable {
    /// bx is known apart from χ13 Z.
    pub bx_nt: bool,
    /// χ13 is known apart from bx.
    pub chi13: bool,
    /// by is known apart from χ23 Z.
    pub by_nt: bool,
    /// χ23 is known apart from by.
    pub chi23: bool,
    /// D is known.
    pub chi11_minus_chi22: bool,
    /// χ12 is known.
    pub chi12: bool,
    /// χ21 is known.
    pub chi21: bool,
    /// The constant is known apart from A: never from headings alone.
    pub constant_deg: bool,
}

/// What a model rests on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// How many samples with independent errors would tell the deviation, where
    /// the ship was last, as well as all her samples together: a gyro's errors
    /// last for hours and days, so that samples repeat each other.
    pub effective_samples: f64,
    /// Standard error of the worst known combination of parameters over that of
    /// the best, by the data alone and in units of what ships differ by; none
    /// where the data leave one quite open.
    pub condition: Option<f64>,
    /// What part of the knowledge of each parameter is from the data.
    pub from_data: FromData,
    /// What the model should not be trusted for.
    pub cautions: Vec<Caution>,
}

/// For each parameter and the constant the part of its variance before the data
/// that they have taken away: 0 rests on the prior alone, 1 on the data alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // the names are those of the parameters
pub struct FromData {
    pub bx_nt: f64,
    pub chi13: f64,
    pub by_nt: f64,
    pub chi23: f64,
    pub chi11_minus_chi22: f64,
    pub chi12: f64,
    pub chi21: f64,
    pub constant_deg: f64,
}

/// What a model should not be trusted for, though it is the best there is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(tag = "caution", rename_all = "snake_case")]
pub enum Caution {
    /// The data come from too narrow a range of magnetic latitudes: only the sums
    /// bx + χ13 Z and by + χ23 Z are known, so that elsewhere the prior rules.
    #[error(
        "the magnetic latitudes sailed tell bx + chi13 Z and by + chi23 Z but not their parts: \
         far from there the band rests on ships at large"
    )]
    OneMagneticLatitude,
    /// The magnetic latitudes would tell the parts of bx + χ13 Z and by + χ23 Z, but
    /// there are not yet samples enough.
    #[error(
        "too few samples yet to tell the parts of bx + chi13 Z and by + chi23 Z: where the ship \
         has not been the band rests on ships at large"
    )]
    FewSamples,
    /// Without times nobody knows which samples share one error of a gyro.
    #[error(
        "rows without times of their own: which of them share one error of the reference is not \
         known; the band takes rows on like headings for half a day's"
    )]
    NoTimes,
    /// Residuals are larger than sound instruments leave.
    #[error(
        "residuals of {residual_deg:.1} degrees are more than sound instruments leave: check \
         compass, reference and columns before the figures are believed"
    )]
    LargeResiduals {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
    },
    /// The last samples stand long after the others, and the ship may have changed.
    #[error(
        "no samples for {days:.0} days before the last ones: the model is for {last}, and its \
         band allows for what a ship may change in such a time"
    )]
    LongGap {
        /// How long there were none.
        days: f64,
        /// When the last sample was taken.
        last: Timestamp,
    },
    /// Some samples lie where the horizontal field is so weak that a compass is
    /// sluggish and small fields disturb it much.
    #[error("samples from a horizontal field of only {h_nt:.0} nT")]
    WeakField {
        /// The weakest horizontal field.
        h_nt: f64,
    },
    /// One that a later version of the program gives, and this one does not know.
    #[error("a caution that this version of the program does not know")]
    #[serde(other)]
    Other,
}

/// A fitted model: what `fit` prints, what the server stores, and what the
/// bridge steers by. Its JSON is described in docs/model.md.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "json::Form", into = "json::Form")]
pub struct Model {
    /// The seven ratios to λ.
    pub parameters_over_lambda: Parameters,
    /// What is added to the exact deviation: alignment, reference and variation
    /// offsets, degrees, east positive.
    pub constant_deg: f64,
    /// 8 × 8, or none when the model came without one.
    pub covariance: Option<Covariance>,
    /// Which parameters the data determine.
    pub identifiable: Option<Identifiable>,
    /// Root mean square of the residuals, degrees.
    pub rms_deg: Option<f64>,
    /// Samples that carried weight.
    pub samples_used: u64,
    /// Samples that were left out or held to be outliers.
    pub samples_rejected: u64,
    /// What it rests on; none when the model came without.
    pub quality: Option<Quality>,
}
