//! What is known of a ship's magnetism before her first sample.

use binnacle_compass::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};

/// Standard deviations over ships of bx, χ13, by, χ23, χ11−χ22, χ12 and χ21,
/// all over λ; fields in nT. Of the size of the ship in Basterretxea-Iribar,
/// Sotés & Uriarte 2016.
pub(crate) const POPULATION_SD: [f64; PARAMETERS] =
    [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008];

/// Most compasses are bolted down to half a degree; that some are a few degrees
/// askew is what the prior's tail is for.
const ALIGNMENT_SD_DEG: f64 = 0.5;

/// Degrees of freedom of Student's distribution over ships: the seven parameters
/// together, and the constant. A ship far out in the tail is believed.
const FREEDOM: [f64; 2] = [6.0, 3.0];

/// How far the induced parts may move when the permanent ones are upset, as a
/// part of the population's standard deviations.
const INDUCED_UPSET: f64 = 0.4;

/// The largest step of permanent magnetism that lightning is known to leave, nT.
const LARGEST_STEP_NT: f64 = 20_000.0;
/// A step may be so many times as large in what has not been seen as in what has, however
/// large that was.
const BEYOND_SEEN: f64 = 1.2;
/// Two-sided 95 % of a normal distribution, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

/// What is known beforehand: of ships at large, or of the same ship's epoch
/// before. The constant is as headings show it, the reference's own in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// The seven parameters and the constant, in the order of
    /// [`Covariance`](binnacle_compass::model::Covariance).
    pub mean: [f64; 8],
    /// Their covariance in the same order.
    pub covariance: binnacle_compass::model::Covariance,
}

impl Prior {
    /// Ships at large, whose reference has a constant error of
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

    /// A ship whose permanent magnetism was upset after `model` was fitted with
    /// a reference of the given constant error: bx and by may be anything, what
    /// the iron's shape induces is much as it was. None when the model has no
    /// covariance.
    pub fn after_upset(
        model: &binnacle_compass::model::Model,
        reference_constant_sd_deg: f64,
    ) -> Option<Prior> {
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
        // The reference errs now as it did then: what headings will show of the
        // constant is known better than the constant itself.
        let constant = &mut covariance[PARAMETERS][PARAMETERS];
        *constant = (*constant - reference_constant_sd_deg.powi(2)).max(0.01);
        Some(Prior { mean, covariance })
    }

    /// The same ship by a compass whose zero moved so that the constant is more by so much,
    /// degrees.
    pub(crate) fn by_turned_compass(&self, moved_deg: f64) -> Prior {
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

/// Standard deviation, nT, of what a step left where no heading has shown it, when `seen_nt`
/// of it have been: across the needle on one course, and along it as yet nothing.
///
/// Steps go in any direction, and as many are from 1 to 2 µT as from 5 to 10: then what is
/// unseen has the density 1/(seen² + unseen²), up to the largest step there is. The 95 % of
/// that are those of the normal distribution which this is of.
pub(crate) fn unseen_sd_nt(seen_nt: f64) -> f64 {
    let seen = seen_nt.abs().max(1.0);
    let most = (LARGEST_STEP_NT.powi(2) - seen * seen).max(0.0).sqrt();
    let within_95 = seen * (0.95 * (most / seen).atan()).tan();
    (within_95 / NORMAL_95).max(BEYOND_SEEN * seen)
}

/// How far a solution lies out in the prior's tail: factors for the standard
/// deviations of the seven parameters and of the constant, from the solution's
/// distance to the mean with its covariance.
pub(crate) fn tail(
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
    let mut out = [factor(FREEDOM[0], 7.0, distance(0, PARAMETERS)); 8];
    out[PARAMETERS] = factor(FREEDOM[1], 1.0, distance(PARAMETERS, 8));
    out
}

/// The population's standard deviations, the constant's (one degree) last: the
/// units in which the estimator works, so that its matrices are well scaled.
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
        // What is as large as any step yet has no more to hide.
        assert!((times(20_000.0) - BEYOND_SEEN).abs() < 1e-9);
        assert!(unseen_sd_nt(0.0) < 10.0);
    }

    #[test]
    fn of_many_steps_in_any_direction_the_band_holds_what_is_unseen_of_95_in_100() {
        // Sizes with the density 1/size from 0.02 to 20 µT, directions evenly.
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
