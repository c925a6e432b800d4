//! Generalised least squares for a ship's magnetism: the exact model, and noise
//! that remembers.
//!
//! A gyro swings with its Schuler period after every turn and its settling
//! point wanders over days; the variation is off by what the crust adds for an
//! hour's sailing. Residuals minutes apart therefore tell almost the same thing
//! twice, and a fit that takes them for independent believes itself far too
//! much. Here those errors are a linear stochastic process; a Kalman filter over
//! that process alone whitens the residuals and the columns of the design
//! together, so that the parameters follow from ordinary normal equations on
//! the whitened rows. Cost is linear in the number of observations.
//!
//! The equations and the constants' reasons are in docs/science.md, §7.
//!
//! What always holds:
//! - rows are linearised at the heading fused from compass and reference, never
//!   at the noisy compass heading alone, which would bias the fit;
//! - every unknown has a prior, so that the normal matrix is positive definite
//!   and no result is ever NaN;
//! - where the ship's magnetism drifts, the parameters are those at the last
//!   observation.

mod noise_process;
mod prior;
mod products;
mod robust_loss;
mod rows;
mod solve;
mod undated_rows;
mod whitening;

pub(crate) use noise_process::{
    COMPASS_SWING_S, SCHULER_DAMPING, SCHULER_PER_S, SLOW_GYRO_S, Transition, VARIATION_NM,
};
pub(crate) use prior::POPULATION_SD;
pub use prior::Prior;
pub(crate) use prior::unseen_sd_nt;
pub(crate) use robust_loss::{loss_of, weight};
pub(crate) use rows::{
    CONSTANT, OFFSET_SD_DEG, Point, Row, Station, UNKNOWNS, USUAL_FUSION, Unknowns, row, stations,
};
pub(crate) use solve::{Options, Rough, estimate, rough};
pub(crate) use undated_rows::are_times_believed;
