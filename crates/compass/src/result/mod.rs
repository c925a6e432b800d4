//! Result of an analysis and its parts.

mod advice;
mod analysis;
mod change;
mod diagnostic;
mod fleet;
mod noise;
mod prediction;
mod references;
mod refusal;

pub use advice::{
    Advice, AzimuthAdvice, Band, HeadingRange, HeadingSuggestion, LatitudeSuggestion, SailNext,
};
pub use analysis::{Analysis, ESTIMATOR, Epoch, LastPlace, STATE_FORM};
pub use change::{Cause, CauseProbability, Change, Step};
pub use diagnostic::{SampleDiagnostic, SampleReason};
pub use fleet::{FleetDisturbance, weigh_with_fleet};
pub use noise::{NOISE_LEVELS, NoiseLevels};
pub use prediction::{PredictionCoverage, expected_inside};
pub use references::{MAX_FAILURE_THRESHOLD_DEG, ReferenceCheck};
pub use refusal::FitError;
