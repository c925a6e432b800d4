//! Error of a berth reading that gives no λ.

use super::consistency::Consistency;
use super::lambda_range::{GREATEST_LAMBDA, LEAST_LAMBDA};
use binnacle_compass::deviation::{DeviationError, ModelError};

/// Reason for the refusal of a berth reading.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BerthError {
    /// A value of the reading is not finite, negative where that is not allowed, or in the
    /// wrong unit.
    #[error("{name} is {value}, not a number between {least} and {greatest}")]
    Reading {
        /// Name of the value.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Least accepted value.
        least: f64,
        /// Greatest accepted value.
        greatest: f64,
    },
    /// The measured horizontal field is zero.
    #[error("the magnetometer read no horizontal field at all")]
    NothingRead,
    /// The model's numbers are invalid.
    #[error("invalid model: {0}")]
    Model(#[from] ModelError),
    /// The earth's field at the berth is invalid.
    #[error(transparent)]
    Field(#[from] DeviationError),
    /// The model leaves hardly any directive force on this heading, so λ cannot be
    /// determined.
    #[error(
        "the model leaves {directive_force:.3} of the mean directive force on magnetic heading \
         {magnetic_deg:.1}: turn the ship"
    )]
    NoDirectiveForce {
        /// Magnetic heading in the model's terms, degrees.
        magnetic_deg: f64,
        /// Directive force as a share of its mean over headings.
        directive_force: f64,
    },
    /// The field's direction differs from the model's by more than the given errors.
    #[error("the berth is inconsistent: {0}")]
    Inconsistent(Consistency),
    /// The direction is right, but the strength is not.
    #[error(
        "lambda is {0:.4}, outside {LEAST_LAMBDA} to {GREATEST_LAMBDA}: the magnetometer's unit or \
         scale, or the given earth's field, is wrong"
    )]
    Implausible(f64),
}
