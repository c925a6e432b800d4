//! Mistakes in a reference heading about the variation.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Mistake in a reference heading about the variation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum VariationMistake {
    /// A magnetic heading.
    Missing,
    /// Subtracted where it is east.
    WrongSign,
    /// Added twice.
    Doubled,
}

impl VariationMistake {
    /// All mistakes.
    pub const ALL: [VariationMistake; 3] = [
        VariationMistake::Missing,
        VariationMistake::WrongSign,
        VariationMistake::Doubled,
    ];

    /// Returns the reference's error in variations.
    pub fn variations_in_error(self) -> f64 {
        match self {
            VariationMistake::Missing => -1.0,
            VariationMistake::WrongSign => -2.0,
            VariationMistake::Doubled => 1.0,
        }
    }
}

impl fmt::Display for VariationMistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            VariationMistake::Missing => "the variation is missing in it, it is magnetic",
            VariationMistake::WrongSign => "the variation is in it with the wrong sign",
            VariationMistake::Doubled => "the variation is in it twice",
        })
    }
}
