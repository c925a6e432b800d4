//! Prior of one vessel: a mixture of its class and of ships at large.

use super::{Class, FleetPriorError, Matrix, Vector};
use crate::estimate::POPULATION_SD;
use binnacle_compass::ship::PARAMETERS;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Decimal places of the means, by ratio: 0.01 nT, and 10⁻⁸ of a coefficient. Numbers that
/// short pass through JSON unchanged.
const PLACES: [i32; PARAMETERS] = [2, 8, 2, 8, 8, 8, 8];

/// Prior of one vessel's seven ratios. Part of the input of its analysis, and so of that
/// input's hash; a vessel keeps it until it is derived anew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShipPrior {
    /// Vessels that it was made of; none for the population's prior.
    pub basis: Option<Basis>,
    /// Normal distributions whose weights add up to one: the class first, where there is
    /// one, and ships at large last.
    pub components: Vec<PriorComponent>,
}

/// Source of a prior: enough to make it again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Basis {
    /// Version of the method.
    pub method: u32,
    /// Time at which the fleet's prior was made.
    pub made_at: Timestamp,
    /// Class of the vessels.
    pub class: Class,
    /// Vessels used, in the order of their ids.
    pub ships: Vec<ShipUsed>,
}

/// One vessel's model that a prior was made of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShipUsed {
    /// Id of the vessel.
    pub vessel: String,
    /// Hash of its model.
    pub model_hash: String,
}

/// One hypothesis of a prior.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PriorComponent {
    /// Probability of the hypothesis before the vessel's own headings.
    pub weight: f64,
    /// Mean of the seven ratios, in the order of
    /// [`Parameters`](binnacle_compass::model::Parameters).
    pub mean: [f64; PARAMETERS],
    /// Covariance of the ratios in the same order.
    pub covariance: [[f64; PARAMETERS]; PARAMETERS],
}

impl ShipPrior {
    /// Returns the prior of a vessel without a class.
    pub fn population() -> ShipPrior {
        ShipPrior {
            basis: None,
            components: vec![PriorComponent::population(1.0)],
        }
    }

    /// Returns a normal distribution about the first hypothesis's mean that knows at least as
    /// much as each hypothesis in every direction. A model fitted with the mixture knows no more
    /// than this bound and the vessel's own headings together. So its evidence beyond the bound
    /// counts no prior again, whichever hypothesis the headings chose.
    ///
    /// # Errors
    /// Fails when there is no hypothesis, or one has no covariance.
    pub fn bound(&self) -> Result<PriorComponent, FleetPriorError> {
        let mut bound: Option<(Vector, Matrix)> = None;
        for component in &self.components {
            let precision = inverse(&component.covariance_in_population_units())?;
            bound = Some(match bound {
                Some((mean, before)) => (mean, larger(&before, &precision)?),
                None => (component.mean_in_population_units(), precision),
            });
        }
        let (mean, precision) = bound.ok_or(FleetPriorError::NoHypothesis)?;
        let covariance = inverse(&precision)?;
        Ok(PriorComponent::from_population_units(
            1.0,
            &mean,
            &covariance,
        ))
    }
}

/// Returns the least matrix with the first one's axes that is at least as large as both.
fn larger(one: &Matrix, other: &Matrix) -> Result<Matrix, FleetPriorError> {
    let root = one.cholesky().ok_or(FleetPriorError::NoHypothesis)?.l();
    let back = root.try_inverse().ok_or(FleetPriorError::NoHypothesis)?;
    let mut ratio = (back * other * back.transpose()).symmetric_eigen();
    for value in ratio.eigenvalues.iter_mut() {
        *value = value.max(1.0);
    }
    Ok(root * ratio.recompose() * root.transpose())
}

fn inverse(matrix: &Matrix) -> Result<Matrix, FleetPriorError> {
    let factor = matrix.cholesky().ok_or(FleetPriorError::NoHypothesis)?;
    Ok(factor.inverse())
}

impl PriorComponent {
    /// Returns ships at large with some weight.
    pub(super) fn population(weight: f64) -> PriorComponent {
        PriorComponent::from_population_units(weight, &Vector::zeros(), &Matrix::identity())
    }

    pub(super) fn from_population_units(
        weight: f64,
        mean: &Vector,
        covariance: &Matrix,
    ) -> PriorComponent {
        let sd = POPULATION_SD;
        PriorComponent {
            weight: decimal(weight, 6),
            mean: std::array::from_fn(|j| decimal(mean[j] * sd[j], PLACES[j])),
            covariance: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let both = f64::midpoint(covariance[(i, j)], covariance[(j, i)]);
                    decimal(both * (sd[i] * sd[j]), PLACES[i] + PLACES[j])
                })
            }),
        }
    }

    pub(super) fn mean_in_population_units(&self) -> Vector {
        Vector::from_fn(|j, _| self.mean[j] / POPULATION_SD[j])
    }

    pub(super) fn covariance_in_population_units(&self) -> Matrix {
        Matrix::from_fn(|i, j| self.covariance[i][j] / (POPULATION_SD[i] * POPULATION_SD[j]))
    }
}

/// Returns the number rounded to so many decimal places.
pub(super) fn decimal(value: f64, places: i32) -> f64 {
    let scale = 10_f64.powi(places);
    // Zero has one form.
    (value * scale).round() / scale + 0.0
}
