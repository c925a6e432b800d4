//! The crew's word that the compass tells nothing of the ship herself for now.

use crate::sampler::Outcome;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Why nothing is sampled until the crew says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Hold {
    /// Alongside: the quay's steel disturbs the field.
    Berthed,
    /// Cargo or gear aboard that is magnetic.
    MagneticCargo,
    /// Degaussing coils are on, or the ship is being treated.
    Degaussing,
}

impl Hold {
    /// How its windows are counted.
    pub(crate) fn outcome(self) -> Outcome {
        match self {
            Hold::Berthed => Outcome::HoldBerthed,
            Hold::MagneticCargo => Outcome::HoldMagneticCargo,
            Hold::Degaussing => Outcome::HoldDegaussing,
        }
    }
}

impl fmt::Display for Hold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Hold::Berthed => "berthed",
            Hold::MagneticCargo => "magnetic-cargo",
            Hold::Degaussing => "degaussing",
        })
    }
}
