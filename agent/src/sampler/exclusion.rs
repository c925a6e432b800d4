//! The crew's word that the compass tells nothing of the ship herself for now.

use super::outcome::Outcome;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Why nothing is sampled until the crew says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Exclusion {
    /// Alongside: the quay's steel disturbs the field.
    Berthed,
    /// Cargo or gear aboard that is magnetic.
    MagneticCargo,
    /// Degaussing coils are on, or the ship is being treated.
    Degaussing,
}

impl Exclusion {
    /// How its windows are counted.
    pub(crate) fn outcome(self) -> Outcome {
        match self {
            Exclusion::Berthed => Outcome::ExcludedBerthed,
            Exclusion::MagneticCargo => Outcome::ExcludedMagneticCargo,
            Exclusion::Degaussing => Outcome::ExcludedDegaussing,
        }
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
