//! The fit as it was published, for comparison: Basterretxea-Iribar, Sotés &
//! Uriarte 2016, J. Navigation 69, eq. 11.
//!
//! Ordinary least squares in force: every sample counts alike whatever the
//! earth's field, the row is taken at the compass heading as it was read, and
//! noise is held to be independent. The product's own fit is
//! [`fit_robust`](super::fit_robust).

use super::robust::check_headings;
use super::{FitError, Observation};
use crate::angle::wrap_180;
use crate::deviation::Coefficients;
use crate::estimate::POPULATION_SD;
use crate::model::{Identifiable, Model, Parameters};
use crate::ship::{EarthField, PARAMETERS};
use nalgebra::{SMatrix, SVector};

/// One more than there are unknowns, so that a residual is left.
const NEEDED_SAMPLES: u64 = 8;
/// Columns of unit length whose normal matrix has an eigenvalue below this are
/// the same column twice.
const SMALLEST_EIGENVALUE: f64 = 1e-10;

type Normal = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Fits eq. 11 by least squares. The model has no constant.
///
/// # Errors
/// When there are too few samples or headings, or all lie at one magnetic
/// latitude, where eq. 11 has no unique solution.
pub fn fit_paper(observations: &[Observation]) -> Result<Model, FitError> {
    let found = observations.len() as u64;
    if found < NEEDED_SAMPLES {
        return Err(FitError::TooFewSamples {
            found,
            needed: NEEDED_SAMPLES,
        });
    }
    check_headings(observations)?;
    let mut normal = Normal::zeros();
    let mut right = SVector::<f64, PARAMETERS>::zeros();
    let mut squares = 0.0;
    for o in observations {
        let (row, force) = equation_11(o);
        normal += row * row.transpose();
        right += row * force;
        squares += force * force;
    }
    // nT and pure numbers differ by five orders of magnitude.
    let scale = normal.diagonal().map(|square| 1.0 / square.sqrt());
    let scaled = Normal::from_diagonal(&scale) * normal * Normal::from_diagonal(&scale);
    let smallest = scaled.symmetric_eigenvalues().min();
    // NaN (a column of zeros) is not above either.
    if smallest.is_nan() || smallest < SMALLEST_EIGENVALUE {
        return Err(FitError::OneMagneticLatitude);
    }
    let inverse = scaled
        .cholesky()
        .ok_or(FitError::OneMagneticLatitude)?
        .inverse();
    let inverse = Normal::from_diagonal(&scale) * inverse * Normal::from_diagonal(&scale);
    let solution = inverse * right;
    let freedom = (found - PARAMETERS as u64) as f64;
    let variance = ((squares - solution.dot(&right)) / freedom).max(0.0);

    let parameters = Parameters::from_array(solution.into());
    let mut covariance = [[0.0; 8]; 8];
    for i in 0..PARAMETERS {
        for j in 0..PARAMETERS {
            covariance[i][j] = variance * inverse[(i, j)];
        }
    }
    let told = |j: usize| covariance[j][j].sqrt() < POPULATION_SD[j] / 2.0;
    Ok(Model {
        parameters_over_lambda: parameters,
        constant_deg: 0.0,
        covariance: Some(covariance),
        identifiable: Some(Identifiable {
            bx_nt: told(0),
            chi13: told(1),
            by_nt: told(2),
            chi23: told(3),
            chi11_minus_chi22: told(4),
            chi12: told(5),
            chi21: told(6),
            constant_deg: false,
        }),
        rms_deg: Some(rms_deg(&parameters, observations)?),
        samples_used: found,
        samples_rejected: 0,
    })
}

/// Eq. 11's row for M/λ and its right side H sin δ, nT.
fn equation_11(o: &Observation) -> (SVector<f64, PARAMETERS>, f64) {
    let (sin, cos) = o.compass.radians().sin_cos();
    let deviation = o.deviation.degrees_east().to_radians();
    let (sin2, cos2) = (2.0 * o.compass.radians() + deviation).sin_cos();
    let half = o.h_nt / 2.0;
    let row = SVector::from([
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

/// Measured less predicted on the compass heading, root mean square.
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
