//! The normal equations of the two fits by ordinary least squares, and what
//! follows from them when noise is held to be independent from row to row.

use crate::estimate::POPULATION_SD;
use binnacle_compass::model::{Covariance, Identifiable};
use binnacle_compass::result::FitError;
use binnacle_compass::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};

/// One more than there are unknowns, so that a residual is left.
const NEEDED_SAMPLES: u64 = PARAMETERS as u64 + 1;
/// Columns of unit length whose normal matrix has an eigenvalue below this are
/// the same column twice.
const SMALLEST_EIGENVALUE: f64 = 1e-10;

/// One row's slopes, or the normal equations' right side.
pub(super) type Vector = SVector<f64, PARAMETERS>;
/// The normal matrix, or its inverse.
pub(super) type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;

pub(super) fn check_number(found: u64) -> Result<(), FitError> {
    if found >= NEEDED_SAMPLES {
        return Ok(());
    }
    Err(FitError::TooFewSamples {
        found,
        needed: NEEDED_SAMPLES,
    })
}

/// The inverse of a normal matrix; refused where two columns are one, which
/// after a check of the headings means that all rows have the same dip.
pub(super) fn invert(normal: &Matrix) -> Result<Matrix, FitError> {
    // nT and pure numbers differ by five orders of magnitude.
    let scale = Matrix::from_diagonal(&normal.diagonal().map(|square| 1.0 / square.sqrt()));
    let scaled = scale * normal * scale;
    let smallest = scaled.symmetric_eigenvalues().min();
    // NaN (a column of zeros) is not above either.
    if smallest.is_nan() || smallest < SMALLEST_EIGENVALUE {
        return Err(FitError::OneMagneticLatitude);
    }
    let factor = scaled.cholesky().ok_or(FitError::OneMagneticLatitude)?;
    Ok(scale * factor.inverse() * scale)
}

/// s²(XᵀX)⁻¹; the constant is no unknown of these fits and has no variance.
pub(super) fn covariance(inverse: &Matrix, variance: f64) -> Covariance {
    let mut covariance = [[0.0; 8]; 8];
    for i in 0..PARAMETERS {
        for j in 0..PARAMETERS {
            covariance[i][j] = variance * inverse[(i, j)];
        }
    }
    covariance
}

/// A parameter is the data's when its standard error is below half of what
/// ships differ by.
pub(super) fn identifiable(covariance: &Covariance) -> Identifiable {
    let told = |j: usize| covariance[j][j].sqrt() < POPULATION_SD[j] / 2.0;
    Identifiable {
        bx_nt: told(0),
        chi13: told(1),
        by_nt: told(2),
        chi23: told(3),
        chi11_minus_chi22: told(4),
        chi12: told(5),
        chi21: told(6),
        constant_deg: false,
    }
}
