//! Published fit, for comparison: Basterretxea-Iribar, Sotés & Uriarte 2016, J. Navigation
//! 69, eq. 11.
//!
//! Ordinary least squares in force: every sample counts alike whatever the earth's field,
//! the row is taken at the compass heading as read, and noise is assumed independent. The
//! product's own fit is [`fit_robust`](super::fit_robust).

use super::heading_check::check_headings;
use super::normal_equations::{
    Matrix, Vector, as_mounted, check_number, covariance, find_turn, identifiable, invert,
};
use super::robust::{check_field, is_usable};
use crate::observation::{Observation, mean_h_nt};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::result::FitError;
use binnacle_compass::ship::{EarthField, PARAMETERS};

/// Fits eq. 11 by least squares. The model has no constant but the angle by which the
/// compass is mounted turned. Observations of weight zero,
/// and those in a field too weak for a compass, are left out and counted as rejected; all
/// others count alike.
///
/// # Errors
/// Fails when there are too few samples or headings, or all lie at one magnetic latitude,
/// where eq. 11 has no unique solution.
pub fn fit_paper(observations: &[Observation]) -> Result<Model, FitError> {
    check_field(observations)?;
    let mut rows = observations.to_vec();
    rows.retain(is_usable);
    let found = rows.len() as u64;
    check_number(found)?;
    check_headings(&rows)?;
    let turn = find_turn(&rows);
    if let Some(turn) = turn {
        rows = turn.straighten(&rows);
    }
    let mut normal = Matrix::zeros();
    let mut right = Vector::zeros();
    let mut squares = 0.0;
    for o in &rows {
        let (row, force) = equation_11(o);
        normal += row * row.transpose();
        right += row * force;
        squares += force * force;
    }
    let inverse = invert(&normal)?;
    let solution = inverse * right;
    let freedom = (rows.len() - PARAMETERS) as f64;
    let variance = ((squares - solution.dot(&right)) / freedom).max(0.0);

    let parameters = Parameters::from_array(solution.into());
    let covariance = covariance(&inverse, variance);
    let straight = Model {
        parameters_over_lambda: parameters,
        constant_deg: 0.0,
        covariance: Some(covariance),
        identifiable: Some(identifiable(&covariance)),
        rms_deg: Some(rms_deg(&parameters, &rows)?),
        samples_used: found,
        samples_rejected: observations.len() as u64 - found,
        quality: None,
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: mean_h_nt(&rows),
        needles: None,
    };
    Ok(as_mounted(straight, turn))
}

/// Returns eq. 11's row for M/λ and its right side H sin δ, nT.
fn equation_11(o: &Observation) -> (Vector, f64) {
    let (sin, cos) = o.compass.radians().sin_cos();
    let deviation = o.deviation.degrees_east().to_radians();
    let (sin2, cos2) = (2.0 * o.compass.radians() + deviation).sin_cos();
    let half = o.h_nt / 2.0;
    let row = Vector::from([
        sin,
        o.z_nt * sin,
        cos,
        o.z_nt * cos,
        half * sin2,
        half * (cos2 - deviation.cos()),
        half * (cos2 + deviation.cos()),
    ]);
    (row, o.h_nt * deviation.sin())
}

/// Returns the root mean square of measured less predicted at the compass heading.
fn rms_deg(p: &Parameters, observations: &[Observation]) -> Result<f64, FitError> {
    let mut squares = 0.0;
    for o in observations {
        let ambiguous = FitError::AmbiguousHeadings { h_nt: o.h_nt };
        let earth = EarthField {
            h_nt: o.h_nt,
            z_nt: o.z_nt,
        };
        let predicted = Coefficients::new(p, earth)
            .ok()
            .and_then(|coefficients| coefficients.deviation_at_compass_rad(o.compass.radians()))
            .ok_or(ambiguous)?;
        squares += wrap_180(o.deviation.degrees_east() - predicted.to_degrees()).powi(2);
    }
    Ok((squares / observations.len() as f64).sqrt())
}
