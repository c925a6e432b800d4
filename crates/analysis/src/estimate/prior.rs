//! Prior knowledge of a vessel's magnetism.

use binnacle_compass::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;

/// Standard deviations over ships of bx, χ13, by, χ23, χ11−χ22, χ12 and χ21, all over λ;
/// fields in nT. Of the size of the ship in Basterretxea-Iribar, Sotés & Uriarte 2016.
pub const POPULATION_SD: [f64; PARAMETERS] = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008];

/// Standard deviation of the alignment: most compasses are bolted down to half a degree.
/// The prior's tail allows for a few degrees.
const ALIGNMENT_SD_DEG: f64 = 0.5;

/// Degrees of freedom of Student's distribution over ships: the seven parameters together,
/// and the constant. Such a tail accepts a vessel far out.
const DEGREES_OF_FREEDOM: [f64; 2] = [6.0, 3.0];

/// Prior knowledge: of ships at large, or of the same vessel's previous epoch. The constant
/// is as headings show it, with the reference's own error in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// The seven parameters and the constant, in the order of
    /// [`Covariance`](binnacle_compass::model::Covariance).
    pub mean: [f64; 8],
    /// Their covariance in the same order.
    pub covariance: binnacle_compass::model::Covariance,
}

impl Prior {
    /// Returns the prior of ships at large, whose reference has a constant error of
    /// `reference_constant_sd_deg`.
    pub fn population(reference_constant_sd_deg: f64) -> Prior {
        let mut covariance = [[0.0; 8]; 8];
        for (j, sd) in POPULATION_SD.iter().enumerate() {
            covariance[j][j] = sd * sd;
        }
        covariance[PARAMETERS][PARAMETERS] =
            ALIGNMENT_SD_DEG.powi(2) + reference_constant_sd_deg.powi(2);
        Prior {
            mean: [0.0; 8],
            covariance,
        }
    }

    /// Returns the prior of the same ship whose compass's zero is known to `sd_deg` only.
    pub(crate) fn with_any_constant(&self, sd_deg: f64) -> Prior {
        let mut prior = self.clone();
        for j in 0..PARAMETERS {
            prior.covariance[j][PARAMETERS] = 0.0;
            prior.covariance[PARAMETERS][j] = 0.0;
        }
        prior.covariance[PARAMETERS][PARAMETERS] = sd_deg * sd_deg;
        prior
    }

    /// Returns mean and information in units of the population's standard deviations; none
    /// when the covariance is not positive definite.
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

/// Returns factors on the standard deviations of the seven parameters and of the constant
/// for a solution in the prior's tail, from its distance to the mean with its covariance.
pub(crate) fn tail_factors(
    off: &SVector<f64, 8>,
    covariance: &SMatrix<f64, 8, 8>,
    information: &SMatrix<f64, 8, 8>,
) -> [f64; 8] {
    let spread = covariance + off * off.transpose();
    let distance = |from: usize, to: usize| -> f64 {
        let of = from..to;
        of.clone()
            .flat_map(|i| of.clone().map(move |j| (i, j)))
            .map(|(i, j)| information[(i, j)] * spread[(i, j)])
            .sum()
    };
    let factor = |freedom: f64, size: f64, distance: f64| {
        ((freedom + distance.max(0.0)) / (freedom + size)).sqrt()
    };
    let mut out = [factor(DEGREES_OF_FREEDOM[0], 7.0, distance(0, PARAMETERS)); 8];
    out[PARAMETERS] = factor(DEGREES_OF_FREEDOM[1], 1.0, distance(PARAMETERS, 8));
    out
}

/// Returns the prior's density per degree where the constant is `off_deg` beyond its mean:
/// Student's with the constant's degrees of freedom.
pub(crate) fn constant_density(prior: &Prior, off_deg: f64) -> f64 {
    let variance = prior.covariance[PARAMETERS][PARAMETERS];
    // Γ(2)/(Γ(3/2) √(3π)) = 2/(π√3), for three degrees of freedom.
    const {
        assert!(DEGREES_OF_FREEDOM[1] == 3.0);
    }
    let peak = 2.0 / (PI * 3_f64.sqrt() * variance.sqrt());
    peak * (1.0 + off_deg * off_deg / (3.0 * variance)).powi(-2)
}

/// Returns the population's standard deviations, the constant's (one degree) last: the
/// estimator's units, in which its matrices are well scaled.
pub(crate) fn scales() -> [f64; 8] {
    let mut scale = [1.0; 8];
    scale[..PARAMETERS].copy_from_slice(&POPULATION_SD);
    scale
}
