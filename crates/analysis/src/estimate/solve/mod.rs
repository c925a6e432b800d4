//! Iterated least squares on whitened rows, from a robust start to the evaluated estimate.

mod alignment;
mod estimator;
mod least_squares;
mod quality;
mod start;

pub(crate) use alignment::Turn;
pub(crate) use estimator::{Options, estimate};
