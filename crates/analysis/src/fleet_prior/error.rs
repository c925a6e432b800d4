//! Reasons why vessels are no prior for another.

use super::{Class, FEWEST_SHIPS, METHOD};

/// Error of a class or of one of its vessels. The population's prior remains in all cases.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FleetPriorError {
    /// Fewer vessels than show a spread: a sister fleet of one.
    #[error("{class} has {ships} vessels besides the one in question; {FEWEST_SHIPS} are needed")]
    TooFewShips {
        /// Class in question.
        class: Class,
        /// Number of vessels with evidence, without the one that the prior is for.
        ships: usize,
    },
    /// Vessel given twice, which would count its evidence twice.
    #[error("vessel {vessel:?} occurs twice in the {class}")]
    SameShipTwice {
        /// Class in question.
        class: Class,
        /// Id of the vessel.
        vessel: String,
    },
    /// Model without a covariance, or with numbers that are none.
    #[error("the model of vessel {vessel:?} has no covariance that is positive definite")]
    NoCovariance {
        /// Id of the vessel.
        vessel: String,
    },
    /// Model that says no more than the prior it was fitted with.
    #[error("the model of vessel {vessel:?} says no more than its prior")]
    NothingLearnt {
        /// Id of the vessel.
        vessel: String,
    },
    /// Prior without hypotheses, or with one that has no covariance.
    #[error("a vessel's prior has no hypothesis with a covariance that is positive definite")]
    NoHypothesis,
    /// Artefact of another version of the method.
    #[error("the fleet's prior is of method {method}; this program has method {METHOD}")]
    OtherMethod {
        /// Version in the artefact.
        method: u32,
    },
}
