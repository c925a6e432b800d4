//! What is known of a ship's magnetism before her first sample.

use crate::ship::PARAMETERS;
use nalgebra::SMatrix;

/// Standard deviations over ships of bx, χ13, by, χ23, χ11−χ22, χ12 and χ21,
/// all over λ; fields in nT. Of the size of the ship in Basterretxea-Iribar,
/// Sotés & Uriarte 2016.
pub(crate) const POPULATION_SD: [f64; PARAMETERS] =
    [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008];

/// A compass may be bolted down a few degrees askew, and some are. So wide a
/// prior leaves the sum of A and the constant to the data.
pub(crate) const ALIGNMENT_SD_DEG: f64 = 3.0;

/// How far the induced parts may move when the permanent ones are upset, as a
/// part of the population's standard deviations.
const INDUCED_UPSET: f64 = 0.4;

/// A model known beforehand: of the same ship's epoch before, say.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// The seven parameters and the constant, in the order of
    /// [`Covariance`](crate::model::Covariance).
    pub mean: [f64; 8],
    /// Their covariance in the same order.
    pub covariance: crate::model::Covariance,
}

impl Prior {
    /// Ships at large.
    pub fn population() -> Prior {
        let mut covariance = [[0.0; 8]; 8];
        for (j, sd) in POPULATION_SD.iter().enumerate() {
            covariance[j][j] = sd * sd;
        }
        covariance[PARAMETERS][PARAMETERS] = ALIGNMENT_SD_DEG.powi(2);
        Prior {
            mean: [0.0; 8],
            covariance,
        }
    }

    /// A ship whose permanent magnetism was upset after `model` was fitted: bx
    /// and by may be anything, what the iron's shape induces is much as it was.
    /// None when the model has no covariance.
    pub fn after_upset(model: &crate::model::Model) -> Option<Prior> {
        let mut covariance = model.covariance?;
        let mut mean = [0.0; 8];
        mean[..PARAMETERS].copy_from_slice(&model.parameters_over_lambda.to_array());
        mean[PARAMETERS] = model.constant_deg;
        for (j, sd) in POPULATION_SD.iter().enumerate() {
            let upset = if matches!(j, 0 | 2) {
                *sd
            } else {
                INDUCED_UPSET * sd
            };
            covariance[j][j] += upset * upset;
        }
        Some(Prior { mean, covariance })
    }

    /// Mean and information in units of the population's standard deviations;
    /// none when the covariance is not positive definite.
    pub(crate) fn in_population_units(&self) -> Option<([f64; 8], SMatrix<f64, 8, 8>)> {
        let scale = scales();
        let mut mean = self.mean;
        for (m, s) in mean.iter_mut().zip(scale) {
            *m /= s;
        }
        let covariance = SMatrix::<f64, 8, 8>::from_fn(|i, j| {
            f64::midpoint(self.covariance[i][j], self.covariance[j][i]) / (scale[i] * scale[j])
        });
        let information = covariance.cholesky()?.inverse();
        let finite = mean.iter().chain(information.iter()).all(|x| x.is_finite());
        finite.then_some((mean, information))
    }
}

/// The population's standard deviations, the constant's (one degree) last: the
/// units in which the estimator works, so that its matrices are well scaled.
pub(crate) fn scales() -> [f64; 8] {
    let mut scale = [1.0; 8];
    scale[..PARAMETERS].copy_from_slice(&POPULATION_SD);
    scale
}
