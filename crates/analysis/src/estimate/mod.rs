//! Generalised least squares for a vessel's magnetism: the exact model, and correlated
//! noise.
//!
//! A gyro swings with its Schuler period after every turn, and its settling point wanders
//! over days; the crust disturbs the variation for an hour's sailing. Residuals minutes
//! apart therefore say almost the same, and a fit that takes them for independent is far
//! too confident. Here those errors are a linear stochastic process. A Kalman filter over
//! that process alone whitens the residuals and the columns of the design together, so that
//! the parameters follow from ordinary normal equations on the whitened rows. The cost is
//! linear in the number of observations.
//!
//! The equations and the reasons for the constants are in docs/science.md, §7.
//!
//! Invariants:
//! - rows are linearised at the heading fused from compass and reference, never at the
//!   noisy compass heading alone, which would bias the fit;
//! - every unknown has a prior, so that the normal matrix is positive definite and no
//!   result is ever NaN;
//! - where the magnetism drifts, the parameters are those at the last observation.

mod noise_process;
mod prior;
mod products;
mod robust_loss;
mod rows;
mod solve;
mod undated_rows;
mod whitening;

pub use noise_process::{COMPASS_SWING_S, SATELLITE_S, SLOW_GYRO_S, VARIATION_NM, swing_over};
pub(crate) use noise_process::{SCHULER_DAMPING, SCHULER_PER_S};
pub use prior::{POPULATION_SD, Prior};
pub use robust_loss::{heavy_tailed_loss, weight};
pub use rows::{Direction, Needle, Scatter, WhiteNoise};
pub(crate) use solve::{Options, Turn, estimate};
