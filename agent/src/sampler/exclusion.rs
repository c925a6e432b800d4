//! Exclusions: the crew reports that the compass is disturbed from outside the vessel's own
//! magnetism.

use super::outcome::Outcome;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Reason for an exclusion, which lasts until the crew ends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Exclusion {
    /// Alongside: the quay's steel disturbs the field.
    Berthed,
    /// Magnetic cargo or gear on board.
    MagneticCargo,
    /// Degaussing coils are on, or the vessel is under treatment.
    Degaussing,
}

impl Exclusion {
    /// Returns the outcome of excluded windows.
    pub(crate) fn outcome(self) -> Outcome {
        match self {
            Exclusion::Berthed => Outcome::ExcludedBerthed,
            Exclusion::MagneticCargo => Outcome::ExcludedMagneticCargo,
            Exclusion::Degaussing => Outcome::ExcludedDegaussing,
        }
    }
}

impl Exclusion {
    /// Describes the change to an exclusion, or to none, for the record of actions.
    pub(crate) fn action(exclusion: Option<Exclusion>) -> String {
        exclusion.map_or_else(|| "hold ended".to_owned(), |hold| format!("hold: {hold}"))
    }
}

impl fmt::Display for Exclusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Exclusion::Berthed => "berthed",
            Exclusion::MagneticCargo => "magnetic-cargo",
            Exclusion::Degaussing => "degaussing",
        })
    }
}
