//! Ordinary least squares, for comparison: the fit of a careful user of today's tools with
//! the same samples.
//!
//! The deviation is exact and residuals are in angle. But every sample counts alike, rows
//! are taken at the compass heading as read, noise is assumed independent from row to row,
//! and there is no prior. The product's own fit is [`fit_robust`](super::fit_robust).

use super::heading_check::check_headings;
use super::normal_equations::{
    Matrix, Vector, as_mounted, check_number, covariance, find_turn, identifiable, invert,
};
use super::robust::{check_field, is_usable};
use crate::observation::{Observation, mean_h_nt};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::linearised_at_compass;
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::result::FitError;
use binnacle_compass::ship::{EarthField, PARAMETERS};

/// Greatest number of Gauss–Newton steps: five or six suffice for a ship, more among wild
/// outliers.
const ITERATIONS: u32 = 100;
/// Greatest number of halvings of a step.
const HALVINGS: u32 = 30;
/// Root-mean-square move of the predictions below which the fit has settled.
const SETTLED_DEG: f64 = 1e-9;
/// Relative rounding of the sum of squares near the end.
const ROUNDING: f64 = 1e-12;

/// Fits the exact deviation to observations by least squares in angle.
///
/// The unknowns are the seven ratios. The constant is held at zero, or at the angle by which
/// the compass is mounted turned: no set of headings separates it from A = (χ21 − χ12)/2
/// (docs/science.md, §3), so that χ12 and χ21 take up the rest with no loss to the deviation.
///
/// An observation's weight divides the variance of its noise. Observations of weight zero,
/// and those in a field too weak for a compass, are left out and counted as rejected.
///
/// # Errors
/// Fails when there are too few samples or headings, all lie at one magnetic latitude, the
/// fitted ship's headings are ambiguous at a sample's field, or the iteration does not
/// settle.
pub fn fit_ols(observations: &[Observation]) -> Result<Model, FitError> {
    check_field(observations)?;
    let mut rows = observations.to_vec();
    rows.retain(is_usable);
    let found = rows.len() as u64;
    check_number(found)?;
    check_headings(&rows)?;
    let weights: f64 = rows.iter().map(|o| o.weight).sum();
    let turn = find_turn(&rows);
    if let Some(turn) = turn {
        rows = turn.straighten(&rows);
    }

    let (parameters, at) = settle(&rows, weights)?;
    let freedom = (rows.len() - PARAMETERS) as f64;
    let covariance = covariance(&invert(&at.normal)?, at.squares / freedom);
    let straight = Model {
        parameters_over_lambda: parameters,
        constant_deg: 0.0,
        covariance: Some(covariance),
        identifiable: Some(identifiable(&covariance)),
        rms_deg: Some((at.squares / weights).sqrt()),
        samples_used: found,
        samples_rejected: observations.len() as u64 - found,
        quality: None,
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: mean_h_nt(&rows),
        needles: None,
    };
    Ok(as_mounted(straight, turn))
}

/// Normal equations for some parameters.
struct Linearised {
    normal: Matrix,
    /// Right side for the step.
    score: Vector,
    /// Weighted squares of the residuals, degrees².
    squares: f64,
}

/// Runs Gauss–Newton with halved steps, from a ship without magnetism.
fn settle(rows: &[Observation], weights: f64) -> Result<(Parameters, Linearised), FitError> {
    let mut parameters = Parameters::from_array([0.0; PARAMETERS]);
    let mut at = linearise(rows, &parameters)?;
    for _ in 0..ITERATIONS {
        let step = invert(&at.normal)? * at.score;
        let moves_deg = (step.dot(&at.score).max(0.0) / weights).sqrt();
        if moves_deg < SETTLED_DEG {
            return Ok((parameters, at));
        }
        (parameters, at) = halve_until_no_worse(rows, &parameters, &at, step)?;
    }
    Err(FitError::NotConverged)
}

/// Returns the first of the step, its half, its quarter, … that is no worse.
fn halve_until_no_worse(
    rows: &[Observation],
    from: &Parameters,
    at: &Linearised,
    mut step: Vector,
) -> Result<(Parameters, Linearised), FitError> {
    let no_worse = at.squares * (1.0 + ROUNDING);
    let mut why = FitError::NotConverged;
    for _ in 0..HALVINGS {
        let tried = Parameters::from_array((Vector::from(from.to_array()) + step).into());
        match linearise(rows, &tried) {
            Ok(there) if there.squares <= no_worse => return Ok((tried, there)),
            Ok(_) => why = FitError::NotConverged,
            Err(ambiguous) => why = ambiguous,
        }
        step /= 2.0;
    }
    Err(why)
}

/// Returns the rows' residuals and slopes in degrees (docs/science.md, eq. 8 and 10).
fn linearise(rows: &[Observation], parameters: &Parameters) -> Result<Linearised, FitError> {
    let mut sums = Linearised {
        normal: Matrix::zeros(),
        score: Vector::zeros(),
        squares: 0.0,
    };
    for o in rows {
        let earth = EarthField {
            h_nt: o.h_nt,
            z_nt: o.z_nt,
        };
        let (predicted, gradient) = linearised_at_compass(parameters, o.compass.radians(), earth)
            .map_err(|_| FitError::AmbiguousHeadings { h_nt: o.h_nt })?;
        let residual = wrap_180(o.deviation.degrees_east() - predicted.to_degrees());
        let slopes = Vector::from(gradient.map(f64::to_degrees));
        sums.normal += slopes * slopes.transpose() * o.weight;
        sums.score += slopes * (o.weight * residual);
        sums.squares += o.weight * residual * residual;
    }
    Ok(sums)
}
