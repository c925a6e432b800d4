//! Why a berth reading gives no λ.

use super::consistency::Consistency;
use super::lambda_range::{GREATEST_LAMBDA, LEAST_LAMBDA};
use binnacle_compass::deviation::{DeviationError, ModelError};

/// A refusal; each says what is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BerthError {
    /// A value of the reading is not finite, negative where it may not be, or
    /// in the wrong unit.
    #[error("{name} is {value}, not a number between {least} and {greatest}")]
    Reading {
        /// Which.
        name: &'static str,
        /// What it was.
        value: f64,
        /// The least accepted.
        least: f64,
        /// The greatest accepted.
        greatest: f64,
    },
    /// The horizontal field read is nil.
    #[error("the magnetometer read no horizontal field at all")]
    NothingRead,
    /// The model's numbers cannot be a ship's.
    #[error("the model is none: {0}")]
    Model(#[from] ModelError),
    /// There is no field to steer by at the berth.
    #[error(transparent)]
    Field(#[from] DeviationError),
    /// By the model hardly any force turns the card north on this heading, so
    /// that no factor can be told.
    #[error(
        "the model leaves {directive_force:.3} of the mean directive force on magnetic heading \
         {magnetic_deg:.1}: turn the ship"
    )]
    NoDirectiveForce {
        /// The heading, degrees, as the model takes it.
        magnetic_deg: f64,
        /// The directive force as a share of its mean over headings.
        directive_force: f64,
    },
    /// The field does not point where the model says, beyond what the errors
    /// given explain.
    #[error("the berth is inconsistent: {0}")]
    Inconsistent(Consistency),
    /// The direction is right, the strength is not.
    #[error(
        "lambda is {0:.4}, outside {LEAST_LAMBDA} to {GREATEST_LAMBDA}: the magnetometer's unit or \
         scale, or the earth's field given, is not right"
    )]
    Implausible(f64),
}
