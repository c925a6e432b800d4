//! Whitening of rows with correlated errors, and the noise levels that fit them.

mod filter;
mod likelihood_slopes;
mod noise_levels;

pub(crate) use filter::{Drift, Part, Pass, Whitening, whiten};
pub(crate) use noise_levels::{PriorTerms, SearchEffort, fit_levels, sampled_rows};
