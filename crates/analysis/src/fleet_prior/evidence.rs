//! Evidence of one vessel: the likelihood of its ratios by its own headings, without the
//! prior of the fit, which would otherwise count again in every sister.

use super::ship_prior::{PriorComponent, ShipUsed, decimal};
use super::{FleetPriorError, Matrix, Vector};
use crate::estimate::POPULATION_SD;
use binnacle_compass::model::{Covariance, Model};
use binnacle_compass::ship::PARAMETERS;
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

/// Least information that counts, in units of the population's: less is rounding.
const LEAST_INFORMATION: f64 = 1e-3;

/// Most information that can be: a standard deviation of 0.05 nT.
const MOST_INFORMATION: f64 = 1e9;

/// Decimal places of the stored numbers, which JSON then carries unchanged.
const PLACES: i32 = 6;

/// Likelihood exp(h·θ − θ·Λθ/2) of a vessel's seven ratios θ by its own headings, in units
/// of the population's standard deviations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct ShipEvidence {
    vessel: String,
    model_hash: String,
    information: [[f64; PARAMETERS]; PARAMETERS],
    score: [f64; PARAMETERS],
}

/// Fields of a [`ShipEvidence`] as read, before its laws are checked.
#[derive(Deserialize)]
struct Unchecked {
    vessel: String,
    model_hash: String,
    information: [[f64; PARAMETERS]; PARAMETERS],
    score: [f64; PARAMETERS],
}

impl TryFrom<Unchecked> for ShipEvidence {
    type Error = FleetPriorError;

    fn try_from(read: Unchecked) -> Result<ShipEvidence, FleetPriorError> {
        let information = matrix(&read.information);
        let symmetric = information == information.transpose();
        // Rounding may have left an eigenvalue just below zero.
        let shifted = information + Matrix::identity() * LEAST_INFORMATION;
        let possible = is_possible(&information, &Vector::from(read.score));
        if !(symmetric && possible && shifted.cholesky().is_some()) {
            let vessel = read.vessel;
            return Err(FleetPriorError::NoCovariance { vessel });
        }
        Ok(ShipEvidence {
            vessel: read.vessel,
            model_hash: read.model_hash,
            information: read.information,
            score: read.score,
        })
    }
}

impl ShipEvidence {
    /// Returns the evidence of `vessel` by its model, of which `model_hash` is a hash or
    /// another name for good, less the prior that the model was fitted with. The model
    /// should be one epoch's, fitted from that prior and not from the epoch before.
    ///
    /// # Errors
    /// Fails when the model has no usable covariance, or says no more than its prior.
    pub fn new(
        vessel: &str,
        model_hash: &str,
        model: &Model,
        fitted_with: &PriorComponent,
    ) -> Result<ShipEvidence, FleetPriorError> {
        let no_covariance = || FleetPriorError::NoCovariance {
            vessel: vessel.to_owned(),
        };
        let covariance = model.covariance.ok_or_else(no_covariance)?;
        let posterior = ratios_information(&covariance).ok_or_else(no_covariance)?;
        let prior = fitted_with
            .covariance_in_population_units()
            .cholesky()
            .ok_or_else(no_covariance)?
            .inverse();
        let values = model.parameters_over_lambda.to_array();
        let mean = Vector::from_fn(|j, _| values[j] / POPULATION_SD[j]);
        let score = posterior * mean - prior * fitted_with.mean_in_population_units();
        if !is_possible(&posterior, &score) {
            return Err(no_covariance());
        }
        let Some(likelihood) = positive_part(&(posterior - prior), &score) else {
            let vessel = vessel.to_owned();
            return Err(FleetPriorError::NothingLearnt { vessel });
        };
        Ok(likelihood.named(vessel, model_hash))
    }

    /// Id of the vessel.
    pub fn vessel(&self) -> &str {
        &self.vessel
    }

    /// Hash of the model that the evidence is from.
    pub fn model_hash(&self) -> &str {
        &self.model_hash
    }

    pub(super) fn used(&self) -> ShipUsed {
        ShipUsed {
            vessel: self.vessel.clone(),
            model_hash: self.model_hash.clone(),
        }
    }

    pub(super) fn likelihood(&self) -> Likelihood {
        Likelihood {
            information: matrix(&self.information),
            score: Vector::from(self.score),
        }
    }
}

/// Normal likelihood of the seven ratios, perhaps flat in some directions.
#[derive(Clone, Copy)]
pub(super) struct Likelihood {
    pub(super) information: Matrix,
    pub(super) score: Vector,
}

impl Likelihood {
    /// Returns the logarithm of the likelihood's mean under a normal prior.
    pub(super) fn log_marginal(&self, mean: &Vector, covariance: &Matrix) -> Option<f64> {
        let factor = covariance.cholesky()?.l();
        let inner = Matrix::identity() + factor.transpose() * self.information * factor;
        let inner = inner.cholesky()?;
        let off = factor.transpose() * (self.score - self.information * mean);
        let log_determinant: f64 = inner.l().diagonal().iter().map(|d| d.ln()).sum();
        let at_mean = self.score.dot(mean) - 0.5 * mean.dot(&(self.information * mean));
        Some(at_mean + 0.5 * off.dot(&inner.solve(&off)) - log_determinant)
    }

    fn named(&self, vessel: &str, model_hash: &str) -> ShipEvidence {
        let rounded = |x: f64| decimal(x, PLACES);
        ShipEvidence {
            vessel: vessel.to_owned(),
            model_hash: model_hash.to_owned(),
            information: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    rounded(f64::midpoint(
                        self.information[(i, j)],
                        self.information[(j, i)],
                    ))
                })
            }),
            score: std::array::from_fn(|j| rounded(self.score[j])),
        }
    }
}

/// Returns the information on the seven ratios, the constant being unknown within its own
/// prior, in units of the population.
fn ratios_information(covariance: &Covariance) -> Option<Matrix> {
    let all =
        SMatrix::<f64, 8, 8>::from_fn(|i, j| f64::midpoint(covariance[i][j], covariance[j][i]));
    all.cholesky()?;
    let ratios = Matrix::from_fn(|i, j| all[(i, j)] / (POPULATION_SD[i] * POPULATION_SD[j]));
    Some(ratios.cholesky()?.inverse())
}

fn is_possible(information: &Matrix, score: &Vector) -> bool {
    let all = information.iter().chain(score.iter());
    all.into_iter().all(|x| x.abs() <= MOST_INFORMATION)
}

/// Returns the part of a likelihood in the directions of which the data know something; none
/// when there are none. Nonlinearity and a prior's tail leave the difference of two
/// informations a little below zero where the data know nothing.
fn positive_part(information: &Matrix, score: &Vector) -> Option<Likelihood> {
    let eigen = information.clone_owned().symmetric_eigen();
    let mut known = Likelihood {
        information: Matrix::zeros(),
        score: Vector::zeros(),
    };
    for (&value, direction) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if value > LEAST_INFORMATION {
            known.information += direction * direction.transpose() * value;
            known.score += direction * direction.dot(score);
        }
    }
    (known.information.trace() > 0.0).then_some(known)
}

fn matrix(rows: &[[f64; PARAMETERS]; PARAMETERS]) -> Matrix {
    Matrix::from_fn(|i, j| rows[i][j])
}
