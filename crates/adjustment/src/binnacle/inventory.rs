//! Written form of the correctors on board (docs/binnacle.md).

use serde::{Deserialize, Serialize};

/// The correctors on board, those in use included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inventory {
    /// Magnets by their kind.
    pub magnets: Vec<Lot>,
    /// Names of the sizes of which there is a pair.
    #[serde(default)]
    pub quadrantal: Vec<String>,
    /// Lengths of the Flinders bar's pieces, mm, each as often as there is one.
    #[serde(default)]
    pub flinders_pieces_mm: Vec<f64>,
}

/// Magnets of one kind on board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lot {
    /// Their kind.
    pub magnet: String,
    /// How many there are.
    pub count: u16,
    /// Their moment as it was tested, A·m²; the nominal one counts otherwise.
    #[serde(default)]
    pub tested_moment_am2: Option<f64>,
    /// Relative standard deviation of the tested moment; 0.02 where it is not said.
    #[serde(default)]
    pub tested_sd: Option<f64>,
}
