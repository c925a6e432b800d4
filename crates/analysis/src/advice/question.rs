//! Questions for advice, and errors of the answer.

use binnacle_compass::coverage::Coverage;
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::Model;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::EarthField;

/// Least narrowing of the band by three watches for a suggestion, degrees.
pub const NOTICEABLE_DEG: f64 = 0.05;

/// Question for advice.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// Model in force; it must have a covariance.
    pub model: &'a Model,
    /// Noise levels.
    pub noise: &'a NoiseLevels,
    /// Standard deviation of the reference's constant error in the model's covariance,
    /// degrees.
    pub reference_constant_sd_deg: f64,
    /// 1 where the reference is a gyro, 0 where it is a satellite compass.
    pub gyro_share: f64,
    /// Field at the vessel's place.
    pub here: EarthField,
    /// Other waters in which the band is to be narrow; if none are given, those of every
    /// magnetic latitude that ships sail in.
    pub elsewhere: &'a [EarthField],
    /// Coverage of the data, which gives the fields of their bands.
    pub coverage: &'a Coverage,
}

/// Error of advice.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AdviceError {
    /// The model has no covariance, and so no known uncertainty.
    #[error("the model has no covariance")]
    NoCovariance,
    /// The covariance is not positive definite.
    #[error("the model's covariance is not positive definite")]
    NotACovariance,
    /// The noise levels are not finite.
    #[error("the noise levels are not finite numbers")]
    NotNoise,
    /// The model has no deviation in the waters asked about.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
}
