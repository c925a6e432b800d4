//! A first fit that outliers cannot lead astray: Huber weights on rows taken
//! for independent, their spread from the median of the residuals.

use crate::estimate::products::Products;
use crate::estimate::rows::{Point, Row, Station, UNKNOWNS, USUAL_FUSION, Unknowns, row};
use crate::observation::Observation;
use nalgebra::{SMatrix, SVector};

/// Enough for any ship whose headings are not ambiguous.
const ITERATIONS: u32 = 30;
/// A step below this, in population standard deviations, is no step.
const SETTLED: f64 = 3e-3;
/// More rows do not make the start better.
const ENOUGH: usize = 4000;
/// The median of |x| of a Gaussian is this part of its standard deviation.
const MEDIAN_TO_SD: f64 = 0.674_489_8;
/// Residuals beyond so many standard deviations pull no harder than at that.
const HUBER: f64 = 2.5;
/// No instrument is better than this; it keeps perfect data from dividing by zero.
const LEAST_SD_DEG: f64 = 0.02;

/// Unknowns from an iteratively reweighted fit, and the residuals' robust
/// standard deviation in degrees.
pub(crate) fn start(
    observations: &[Observation],
    stations: &[Station],
    prior_mean: &Unknowns,
    prior_information: &SMatrix<f64, UNKNOWNS, UNKNOWNS>,
) -> (Unknowns, f64) {
    let mut unknowns = *prior_mean;
    let mut sd = f64::INFINITY;
    // Every n-th row is as good a start as all of them.
    let every = observations.len().div_ceil(ENOUGH).max(1);
    let stations: Vec<&Station> = stations.iter().step_by(every).collect();
    for _ in 0..ITERATIONS {
        let point = Point::at(&unknowns, USUAL_FUSION);
        let rows: Vec<Row> = observations
            .iter()
            .step_by(every)
            .zip(&stations)
            .map(|(o, s)| row(o, s, &point))
            .collect();
        sd = robust_sd(rows.iter().map(|r| r.residual));
        let mut information = Products::new();
        let mut score = prior_information * (SVector::from(*prior_mean) - SVector::from(unknowns));
        for (r, s) in rows.iter().zip(&stations) {
            let own_sd = s.white.variance(sd * sd).sqrt();
            let weight = huber_weight(r.residual / own_sd) / (own_sd * own_sd);
            information.add(&r.columns, weight);
            score += SVector::from(r.columns) * (r.residual * weight);
        }
        let information = information.to_matrix() + prior_information;
        let Some(factor) = information.cholesky() else {
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
    (unknowns, sd)
}

/// 1 up to [`HUBER`] standard deviations, then falling as 1/|z|.
fn huber_weight(z: f64) -> f64 {
    (HUBER / z.abs()).min(1.0)
}

/// Standard deviation of the bulk of the residuals about zero.
fn robust_sd(residuals: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = residuals.map(f64::abs).collect();
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    (*median / MEDIAN_TO_SD).max(LEAST_SD_DEG)
}
