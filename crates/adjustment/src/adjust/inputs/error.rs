//! Error of invalid input.

use crate::berth::BerthError;
use crate::binnacle::BinnacleError;
use binnacle_compass::deviation::DeviationError;

/// Error of invalid input.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdjustError {
    /// Invalid reading, model or field at the berth.
    #[error(transparent)]
    Berth(#[from] BerthError),
    /// Invalid number of a water.
    #[error("waters[{index}].{field} is {value}, not a number between {least} and {greatest}")]
    Water {
        /// Index of the water.
        index: usize,
        /// Name of the field.
        field: &'static str,
        /// Given value.
        value: f64,
        /// Least accepted value.
        least: f64,
        /// Greatest accepted value.
        greatest: f64,
    },
    /// No water, or none with a weight.
    #[error("waters: at least one entry needs a weight above 0")]
    NoWaters,
    /// Invalid limit or other number.
    #[error("{field} is {value}, not a number between {least} and {greatest}")]
    Value {
        /// Name of the field.
        field: &'static str,
        /// Given value.
        value: f64,
        /// Least accepted value.
        least: f64,
        /// Greatest accepted value.
        greatest: f64,
    },
    /// Impossible setting of the correctors.
    #[error(transparent)]
    Binnacle(#[from] BinnacleError),
    /// Failed prediction of the ship's deviation.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
}
