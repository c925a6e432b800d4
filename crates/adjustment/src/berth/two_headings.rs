//! λ from readings at two headings of one berth, and whether they agree.
//!
//! On one heading a field along the needle changes the strength, like another λ. Shifted, the
//! ship lies otherwise to the steel of the quay, and her own field turns with her: one λ then
//! explains the four parts of both readings only where neither adds a field of its own.

use super::error::BerthError;
use super::expected_field::{ExpectedField, UNKNOWNS};
use super::reading::BerthReading;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use nalgebra::{SMatrix, SVector};

/// Parts of two readings.
const PARTS: usize = 4;
/// 99.7 % of χ² with the three degrees of freedom that λ leaves.
const CHI_SQUARED_997: f64 = 13.93;

/// λ from readings on two headings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoHeadings {
    /// λ by both readings.
    pub lambda: f64,
    /// Standard error of λ, without the magnetometer's scale.
    pub standard_error: f64,
    /// Covariance of λ with each of the model's unknowns.
    pub with_model: [f64; UNKNOWNS],
    /// Field that one λ leaves unexplained in both readings together, nT.
    pub left_nt: f64,
    /// True where errors do not explain that field: steel on the quay, a change of the ship
    /// since the model, or a wrong reading.
    pub is_foreign: bool,
}

/// Determines λ by generalised least squares over both readings, for a usual λ in their
/// errors.
///
/// # Errors
/// Fails when the model or the earth's field is invalid, or the model leaves no directive
/// force on one of the headings.
pub fn lambda_by_two_headings(
    model: &Model,
    earth: EarthField,
    readings: [&BerthReading; 2],
    usual_lambda: f64,
) -> Result<TwoHeadings, BerthError> {
    let mut over_lambda = SVector::<f64, PARTS>::zeros();
    let mut measured = SVector::<f64, PARTS>::zeros();
    let mut slopes = SMatrix::<f64, PARTS, UNKNOWNS>::zeros();
    let mut errors = SMatrix::<f64, PARTS, PARTS>::zeros();
    for (index, reading) in readings.into_iter().enumerate() {
        let expected = ExpectedField::new(model, earth, reading)?;
        let noise = expected.part_errors(reading, earth, usual_lambda);
        for (axis, noise) in noise.into_iter().enumerate() {
            let row = 2 * index + axis;
            measured[row] = reading.field_nt()[axis];
            over_lambda[row] = expected.u[axis];
            for (unknown, slope) in expected.by_unknown.iter().enumerate() {
                slopes[(row, unknown)] = usual_lambda * slope[axis];
            }
            for (other, part) in noise.into_iter().enumerate() {
                errors[(row, 2 * index + other)] = part;
            }
        }
    }
    let covariance = model.covariance.unwrap_or_default();
    let covariance = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|r, c| covariance[r][c]);
    errors += slopes * covariance * slopes.transpose();
    let inverse = errors.try_inverse().unwrap_or_default();
    let variance = over_lambda.dot(&(inverse * over_lambda)).recip();
    let gain = over_lambda.transpose() * inverse * variance;
    let lambda = (gain * measured)[0];
    let left = measured - over_lambda * lambda;
    let with_model = gain * slopes * covariance * -1.0;
    Ok(TwoHeadings {
        lambda,
        standard_error: variance.max(0.0).sqrt(),
        with_model: std::array::from_fn(|unknown| with_model[unknown]),
        left_nt: left.norm(),
        is_foreign: left.dot(&(inverse * left)) > CHI_SQUARED_997,
    })
}
