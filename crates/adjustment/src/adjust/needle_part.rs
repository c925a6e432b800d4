//! The model as a magnetometer in the bowl's place sees the ship: without the needles.
//!
//! Headings include the needles' induction in the spheres, and a magnetometer measures the
//! field without bowl and needles. Their part of D and E is known from the correctors,
//! except for λ, to which they add nothing.

use crate::berth::{BerthError, BerthEstimate, BerthReading, lambda_at_berth};
use crate::binnacle::Binnacle;
use crate::corrector::{Effect, effect};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::Model;
use binnacle_compass::ship::{EarthField, ShipMagnetism};

/// Usual λ, with which the search for λ starts.
const FIRST_LAMBDA: f64 = 0.9;
/// Number of rounds in which λ settles.
const ROUNDS: u32 = 4;

/// Determines λ from a reading, with the correctors in the binnacle's setting. The model
/// contains the needles' part as in the horizontal field `reference_h_nt`.
pub(crate) fn lambda_without_needles(
    model: &Model,
    binnacle: &Binnacle,
    reference_h_nt: f64,
    earth: EarthField,
    reading: &BerthReading,
) -> Result<BerthEstimate, BerthError> {
    let mut lambda = FIRST_LAMBDA;
    for _ in 1..ROUNDS {
        let without = at_lambda(model, binnacle, reference_h_nt, lambda)?;
        lambda = lambda_at_berth(&without, earth, reading)?.lambda.value;
    }
    let without = at_lambda(model, binnacle, reference_h_nt, lambda)?;
    lambda_at_berth(&without, earth, reading)
}

/// Returns the model without the needles' part for a usual λ; the model itself where that
/// cannot be computed.
pub(crate) fn without_needles(model: &Model, binnacle: &Binnacle, earth: EarthField) -> Model {
    let reference_h_nt = model.reference_h_nt().unwrap_or(earth.h_nt);
    let without = at_lambda(model, binnacle, reference_h_nt, FIRST_LAMBDA);
    without.unwrap_or_else(|_| model.clone())
}

/// Returns the model without the needles' part for this λ.
pub(crate) fn at_lambda(
    model: &Model,
    binnacle: &Binnacle,
    reference_h_nt: f64,
    lambda: f64,
) -> Result<Model, DeviationError> {
    let needles = Effect {
        needle_nt: effect(binnacle, &binnacle.setting).needle_nt,
        ..Effect::default()
    };
    let chi = needles.chi_at(reference_h_nt);
    let mut ship = ShipMagnetism::from_parameters(&model.parameters_over_lambda, lambda);
    for (row, of_needles) in ship.chi.iter_mut().zip(chi) {
        for (part, needle) in row.iter_mut().zip(of_needles) {
            *part -= needle;
        }
    }
    let parameters = ship.parameters_over_lambda();
    Ok(Model {
        parameters_over_lambda: parameters.map_err(|_| DeviationError::NotFinite)?,
        needles: None,
        ..model.clone()
    })
}
