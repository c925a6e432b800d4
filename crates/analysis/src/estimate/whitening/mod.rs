//! Whitening of rows whose errors are correlated, and the noise levels that fit them best.

mod filter;
mod likelihood_slopes;
mod noise_levels;

pub(crate) use filter::{Drift, Part, Pass, Whitening, whiten};
pub(crate) use noise_levels::{Pull, Sought, fit_levels, looked_at};
