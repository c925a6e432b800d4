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

/// Standard deviation of the induced parameters after a jump of the permanent ones, as a
/// part of the population's.
const INDUCED_JUMP_SHARE: f64 = 0.4;

/// Largest step of permanent magnetism that lightning is known to leave, nT.
const LARGEST_STEP_NT: f64 = 20_000.0;
/// Least ratio of a step's unseen part to its seen part, however large that is.
const BEYOND_SEEN: f64 = 1.2;
/// Two-sided 95 % of a normal distribution, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

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

    /// Returns the prior of a vessel whose permanent magnetism jumped after `model` was
    /// fitted with a reference of the given constant error: bx and by may be anything, and
    /// the induced parameters are much as before. None when the model has no covariance.
    pub fn after_jump(
        model: &binnacle_compass::model::Model,
        reference_constant_sd_deg: f64,
    ) -> Option<Prior> {
        let mut covariance = model.covariance?;
        let mut mean = [0.0; 8];
        mean[..PARAMETERS].copy_from_slice(&model.parameters_over_lambda.to_array());
        mean[PARAMETERS] = model.constant_deg;
        for (j, sd) in POPULATION_SD.iter().enumerate() {
            let interruption = if matches!(j, 0 | 2) {
                *sd
            } else {
                INDUCED_JUMP_SHARE * sd
            };
            covariance[j][j] += interruption * interruption;
        }
        // The reference's error stays the same: headings show the constant better than it
        // is known in itself.
        let constant = &mut covariance[PARAMETERS][PARAMETERS];
        *constant = (*constant - reference_constant_sd_deg.powi(2)).max(0.01);
        Some(Prior { mean, covariance })
    }

    /// Returns the prior after an alignment change by which the constant is larger by
    /// `moved_deg`.
    pub(crate) fn with_compass_turned(&self, moved_deg: f64) -> Prior {
        let mut mean = self.mean;
        let parameters = std::array::from_fn(|j| mean[j]);
        let turned = binnacle_compass::model::Parameters::from_array(parameters)
            .with_compass_turned(-moved_deg.to_radians());
        mean[..PARAMETERS].copy_from_slice(&turned.to_array());
        mean[PARAMETERS] += moved_deg;
        Prior {
            mean,
            covariance: self.covariance,
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

/// Returns the standard deviation, nT, of a step's unseen part, of which `seen_nt` was
/// seen: on one course the part across the needle, and nothing along it.
///
/// Steps have any direction, and as many are from 1 to 2 µT as from 5 to 10. The unseen
/// part then has the density 1/(seen² + unseen²), up to the largest known step. The normal
/// distribution returned has the same 95 %.
pub(crate) fn unseen_sd_nt(seen_nt: f64) -> f64 {
    let seen = seen_nt.abs().max(1.0);
    let most = (LARGEST_STEP_NT.powi(2) - seen * seen).max(0.0).sqrt();
    let within_95 = seen * (0.95 * (most / seen).atan()).tan();
    (within_95 / NORMAL_95).max(BEYOND_SEEN * seen)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_may_be_several_times_as_large_where_nothing_shows_it() {
        let times = |seen_nt: f64| unseen_sd_nt(seen_nt) / seen_nt;
        assert!((3.5..4.5).contains(&times(1000.0)), "{}", times(1000.0));
        assert!((1.6..2.2).contains(&times(4000.0)), "{}", times(4000.0));
        // A step as large as any known has no more to hide.
        assert!((times(20_000.0) - BEYOND_SEEN).abs() < 1e-9);
        assert!(unseen_sd_nt(0.0) < 10.0);
    }

    #[test]
    fn of_many_steps_in_any_direction_the_band_holds_what_is_unseen_of_95_in_100() {
        // Sizes with the density 1/size from 0.02 to 20 µT, in even directions.
        let (mut all, mut held) = (0.0, 0.0);
        for size in 0..300 {
            let nt = 20.0 * 1000_f64.powf(f64::from(size) / 299.0);
            for direction in 0..360 {
                let (sin, cos) = f64::from(direction).to_radians().sin_cos();
                let unseen = (nt * cos).abs();
                all += 1.0;
                held += f64::from(unseen <= 1.96 * unseen_sd_nt(nt * sin));
            }
        }
        assert!(held / all > 0.93, "{}", held / all);
    }
}
