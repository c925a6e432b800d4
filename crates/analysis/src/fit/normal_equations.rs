//! Normal equations of the two fits by ordinary least squares, for noise that is assumed
//! independent from row to row.

use crate::estimate::{POPULATION_SD, Prior, Turn};
use crate::observation::Observation;
use binnacle_compass::model::{Covariance, Identifiable, Model};
use binnacle_compass::result::FitError;
use binnacle_compass::settings::REFERENCE_CONSTANT_SD_DEG;
use binnacle_compass::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};

/// Least number of samples: one more than the unknowns, so that a residual is left.
const NEEDED_SAMPLES: u64 = PARAMETERS as u64 + 1;
/// Eigenvalue of the normal matrix, for columns of unit length, below which two columns are
/// the same.
const SMALLEST_EIGENVALUE: f64 = 1e-10;

/// Slopes of one row, or the right side of the normal equations.
pub(super) type Vector = SVector<f64, PARAMETERS>;
/// Normal matrix, or its inverse.
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

/// Inverts a normal matrix; fails where two columns are the same, which after a check of
/// the headings means that all rows have the same dip.
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

/// Returns s²(XᵀX)⁻¹; the constant is no unknown of these fits and has no variance.
pub(super) fn covariance(inverse: &Matrix, variance: f64) -> Covariance {
    let mut covariance = [[0.0; 8]; 8];
    for i in 0..PARAMETERS {
        for j in 0..PARAMETERS {
            covariance[i][j] = variance * inverse[(i, j)];
        }
    }
    covariance
}

/// Returns the rotation of the compass against the keel; none where it is mounted straight.
pub(super) fn find_turn(rows: &[Observation]) -> Option<Turn> {
    Turn::find(rows, &Prior::population(REFERENCE_CONSTANT_SD_DEG))
}

/// Returns the model of a straightened compass as that of the compass as mounted. All of
/// the rotation is in the constant.
pub(super) fn as_mounted(straight: Model, turn: Option<Turn>) -> Model {
    let Some(turn) = turn else {
        return straight;
    };
    let matrix = turn.matrix(&[1.0; 8]);
    let covariance = straight.covariance.map(|covariance| {
        let of_straight = SMatrix::<f64, 8, 8>::from_fn(|i, j| covariance[i][j]);
        let turned = matrix * of_straight * matrix.transpose();
        std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)]))
    });
    Model {
        parameters_over_lambda: turn.parameters(&straight.parameters_over_lambda),
        constant_deg: turn.constant_deg(straight.constant_deg),
        covariance,
        identifiable: covariance.as_ref().map(identifiable),
        ..straight
    }
}

/// Returns the parameters whose standard error is below half of the population's standard
/// deviation.
pub(super) fn identifiable(covariance: &Covariance) -> Identifiable {
    let shown = |j: usize| covariance[j][j].sqrt() < POPULATION_SD[j] / 2.0;
    Identifiable {
        bx_nt: shown(0),
        chi13: shown(1),
        by_nt: shown(2),
        chi23: shown(3),
        chi11_minus_chi22: shown(4),
        chi12: shown(5),
        chi21: shown(6),
        constant_deg: false,
    }
}
