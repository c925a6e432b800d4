//! Error of invalid input.

use crate::berth::BerthError;
use crate::binnacle::BinnacleError;
use binnacle_compass::deviation::DeviationError;

/// Why there is nothing to plan with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdjustError {
    /// Of the reading, the model or the field at the berth.
    #[error(transparent)]
    Berth(#[from] BerthError),
    /// Of a place where the vessel trades.
    #[error("waters[{index}].{field} is {value}, not a number between {least} and {greatest}")]
    Water {
        /// Which.
        index: usize,
        /// Its field.
        field: &'static str,
        /// What it was.
        value: f64,
        /// The least accepted.
        least: f64,
        /// The greatest accepted.
        greatest: f64,
    },
    /// There are none, or none with a weight.
    #[error("waters: there are none with a weight")]
    NoWaters,
    /// A limit, or another number, that cannot be.
    #[error("{field} is {value}, not a number between {least} and {greatest}")]
    Value {
        /// Which.
        field: &'static str,
        /// What it was.
        value: f64,
        /// The least accepted.
        least: f64,
        /// The greatest accepted.
        greatest: f64,
    },
    /// The correctors cannot stand as they are said to.
    #[error(transparent)]
    Binnacle(#[from] BinnacleError),
    /// The ship cannot be foretold.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
}
