//! Reasons to refuse an observation.

use crate::angle::AngleError;
use crate::field::FieldError;
use crate::number::CompactNumber;
use crate::position::PositionError;

/// Refusal of an observation, with the field at fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {problem}")]
pub struct AzimuthError {
    /// Field as it is written.
    pub field: &'static str,
    /// Fault in it.
    pub problem: AzimuthProblem,
}

/// Fault of an observation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AzimuthProblem {
    /// A value is missing.
    #[error("is missing: {0}")]
    Missing(&'static str),
    /// A value is given that this kind of observation does not use.
    #[error("is not used for {0}")]
    Unused(&'static str),
    /// An angle is not one.
    #[error(transparent)]
    Angle(#[from] AngleError),
    /// The position is not one.
    #[error(transparent)]
    Position(#[from] PositionError),
    /// A number is outside its range.
    #[error("{} {unit} is not between {low} and {high}", CompactNumber(*value))]
    OutOfRange {
        /// Value as written.
        value: f64,
        /// Unit of the three numbers.
        unit: &'static str,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
    /// The variation is not known at that time.
    #[error("the variation is not known: {0}")]
    NoVariation(#[from] FieldError),
    /// The sun is below the horizon.
    #[error("the sun is below the horizon then and there (its altitude is {altitude_deg:.1}°)")]
    BelowHorizon {
        /// Altitude of its centre.
        altitude_deg: f64,
    },
    /// The sun is not on the horizon.
    #[error("the sun is not on the horizon then and there (its altitude is {altitude_deg:.1}°)")]
    NotOnHorizon {
        /// Altitude of its centre.
        altitude_deg: f64,
    },
    /// The sun only touches the horizon, or does not come to it.
    #[error("the sun neither rises nor sets in this latitude on that day")]
    NeverOnHorizon,
    /// The values are possible and unlikely.
    #[error("{0}; confirm it if it was observed so")]
    Question(String),
}

impl AzimuthError {
    pub(super) fn new(field: &'static str, problem: impl Into<AzimuthProblem>) -> AzimuthError {
        AzimuthError {
            field,
            problem: problem.into(),
        }
    }

    /// Question whether an unlikely value was observed.
    pub(super) fn question(text: String) -> AzimuthError {
        AzimuthError::new("confirmed", AzimuthProblem::Question(text))
    }

    /// True when the observation is accepted once it is confirmed.
    pub fn is_question(&self) -> bool {
        matches!(self.problem, AzimuthProblem::Question(_))
    }
}
