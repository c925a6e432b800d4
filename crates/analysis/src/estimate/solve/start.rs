//! Robust first fit: Huber weights on rows taken as independent, with their spread from the
//! median of the residuals.

use crate::estimate::products::Products;
use crate::estimate::rows::{
    LinearisationPoint, Row, RowFrame, UNKNOWNS, USUAL_REFERENCE_SHARE, Unknowns, row,
};
use crate::observation::Observation;
use crate::robust_scale::robust_sd;
use nalgebra::{SMatrix, SVector};

/// Greatest number of iterations: enough for any vessel whose headings are not ambiguous.
const ITERATIONS: u32 = 30;
/// Step, in population standard deviations, below which the fit has settled.
const SETTLED: f64 = 3e-3;
/// Number of rows beyond which the start gets no better.
const ENOUGH: usize = 4000;
/// Residual, in standard deviations, beyond which its pull is constant.
const HUBER: f64 = 2.5;
/// Least standard deviation: no instrument is better, and perfect data do not divide by
/// zero.
const LEAST_SD_DEG: f64 = 0.02;

/// Robust first fit.
pub(crate) struct RobustStart {
    pub(crate) unknowns: Unknowns,
    /// Robust standard deviation of the residuals, degrees.
    pub(crate) sd_deg: f64,
    /// Information of rows, taken as independent, and prior.
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
}

/// Returns an iteratively reweighted fit.
pub(crate) fn start(
    observations: &[Observation],
    frames: &[RowFrame],
    prior_mean: &Unknowns,
    prior_information: &SMatrix<f64, UNKNOWNS, UNKNOWNS>,
) -> RobustStart {
    let mut unknowns = *prior_mean;
    let mut sd = f64::INFINITY;
    let mut shown = *prior_information;
    // Every n-th row is as good a start as all of them.
    let every = observations.len().div_ceil(ENOUGH).max(1);
    let frames: Vec<&RowFrame> = frames.iter().step_by(every).collect();
    for _ in 0..ITERATIONS {
        let point = LinearisationPoint::at(&unknowns, USUAL_REFERENCE_SHARE);
        let rows: Vec<Row> = observations
            .iter()
            .step_by(every)
            .zip(&frames)
            .map(|(o, s)| row(o, s, &point))
            .collect();
        // The spread of the bulk of the residuals about zero.
        let spread = robust_sd(rows.iter().map(|r| r.residual), 0.0);
        sd = spread.unwrap_or_default().max(LEAST_SD_DEG);
        let mut information = Products::new();
        let mut score = prior_information * (SVector::from(*prior_mean) - SVector::from(unknowns));
        for (r, s) in rows.iter().zip(&frames) {
            let own_sd = s.white.variance(sd * sd).sqrt();
            let weight = huber_weight(r.residual / own_sd) / (own_sd * own_sd);
            information.add(&r.columns, weight);
            score += SVector::from(r.columns) * (r.residual * weight);
        }
        shown = information.to_matrix() + prior_information;
        let Some(factor) = shown.cholesky() else {
            break;
        };
        let step = factor.solve(&score);
        for (u, d) in unknowns.iter_mut().zip(step.iter()) {
            *u += d;
        }
        if step.amax() < SETTLED {
            break;
        }
    }
    RobustStart {
        unknowns,
        sd_deg: sd,
        information: shown,
    }
}

/// Returns 1 up to [`HUBER`] standard deviations, and a weight falling as 1/|z| beyond.
fn huber_weight(z: f64) -> f64 {
    (HUBER / z.abs()).min(1.0)
}
