//! λ and the field of the quay from readings on two headings of one berth.
//!
//! On one heading a field along the needle changes the strength, like another λ. Steel on the
//! quay stays where it is when the ship is shifted to another heading, while the ship's own
//! field turns with her: the four parts of two readings determine λ and the quay's field.

use super::error::BerthError;
use super::expected_field::{ExpectedField, UNKNOWNS};
use super::reading::BerthReading;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use nalgebra::{SMatrix, SVector};

/// Standard deviation of the quay's field in each part, nT: unflagged steel of 4 µT is usual
/// enough to be expected.
const QUAY_SD_NT: f64 = 3_000.0;
/// Parts of two readings.
const PARTS: usize = 4;
/// λ and the quay's field north and east.
const WANTED: usize = 3;
/// 99.7 % of χ² with one and two degrees of freedom.
const CHI_SQUARED_997: [f64; 2] = [8.81, 11.62];

/// λ and the quay's field from readings on two headings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoHeadings {
    /// λ, free of the quay's field.
    pub lambda: f64,
    /// Standard error of λ, without the magnetometer's scale.
    pub standard_error: f64,
    /// Covariance of λ with each of the model's unknowns.
    pub with_model: [f64; UNKNOWNS],
    /// Field of the quay, magnetic north and east, nT.
    pub quay_nt: [f64; 2],
    /// The readings differ from the model's field by more than their errors, unless the quay
    /// adds a field.
    pub is_quay_seen: bool,
    /// No field of the quay explains the readings either: the ship has changed, or one of them
    /// is wrong.
    pub is_unexplained: bool,
}

/// Determines λ and the quay's field by generalised least squares, with an expected size of
/// the quay's field.
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
    let mut design = SMatrix::<f64, PARTS, WANTED>::zeros();
    let mut measured = SVector::<f64, PARTS>::zeros();
    let mut slopes = SMatrix::<f64, PARTS, UNKNOWNS>::zeros();
    let mut errors = SMatrix::<f64, PARTS, PARTS>::zeros();
    for (index, reading) in readings.into_iter().enumerate() {
        let expected = ExpectedField::new(model, earth, reading)?;
        let (sin, cos) = reading.magnetic().radians().sin_cos();
        let noise = expected.part_errors(reading, earth, usual_lambda);
        for (axis, noise) in noise.into_iter().enumerate() {
            let row = 2 * index + axis;
            measured[row] = reading.field_nt()[axis];
            design[(row, 0)] = expected.u[axis];
            let [north, east] = [[cos, sin], [-sin, cos]][axis];
            (design[(row, 1)], design[(row, 2)]) = (north, east);
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
    let information = design.transpose() * inverse * design;
    let quay = SVector::from([0.0, QUAY_SD_NT.powi(-2), QUAY_SD_NT.powi(-2)]);
    let posterior = information + SMatrix::from_diagonal(&quay);
    let posterior = posterior.try_inverse().unwrap_or_default();
    let gain = posterior * design.transpose() * inverse;
    let found = gain * measured;
    let squared = |left: SVector<f64, PARTS>| left.dot(&(inverse * left));
    let strength = design.column(0).into_owned();
    let alone = strength.dot(&(inverse * measured)) / strength.dot(&(inverse * strength));
    let free = information.try_inverse().unwrap_or_default() * design.transpose() * inverse;
    let with_quay = squared(measured - design * (free * measured));
    let without_quay = squared(measured - strength * alone);
    let with_model = gain.row(0) * slopes * covariance * -1.0;
    Ok(TwoHeadings {
        lambda: found[0],
        standard_error: posterior[(0, 0)].max(0.0).sqrt(),
        with_model: std::array::from_fn(|unknown| with_model[unknown]),
        quay_nt: [found[1], found[2]],
        is_quay_seen: without_quay - with_quay > CHI_SQUARED_997[1],
        is_unexplained: with_quay > CHI_SQUARED_997[0],
    })
}
