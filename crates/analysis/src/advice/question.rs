//! Questions for advice, and why there may be none.

use binnacle_compass::coverage::Coverage;
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::Model;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::EarthField;

/// A suggestion whose three watches narrow the band by less is not made, degrees.
pub const NOTICEABLE_DEG: f64 = 0.05;

/// What advice is asked about.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// What is known; it must have a covariance.
    pub model: &'a Model,
    /// How large each kind of noise is.
    pub noise: &'a NoiseLevels,
    /// Standard deviation of the reference's constant error that stands in the
    /// model's covariance, degrees.
    pub reference_constant_sd_deg: f64,
    /// 1 where the reference is a gyro, 0 where it is a satellite compass.
    pub gyro_share: f64,
    /// Where the ship is.
    pub here: EarthField,
    /// Other waters in which the band is to be narrow; if none are given, those
    /// of every magnetic latitude that ships sail in.
    pub elsewhere: &'a [EarthField],
    /// Where the data are: it gives the fields of the bands they lie in.
    pub coverage: &'a Coverage,
}

/// Why there is no advice.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AdviceError {
    /// A model without a covariance does not say what it knows.
    #[error("the model has no covariance")]
    NoCovariance,
    /// The covariance given could not be anyone's.
    #[error("the model's covariance is not positive definite")]
    NotACovariance,
    /// The noise levels are not finite.
    #[error("the noise levels are not finite numbers")]
    NotNoise,
    /// The model says nothing in the waters asked about.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
}
