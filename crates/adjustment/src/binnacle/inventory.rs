//! Written form of the correctors on board (docs/binnacle.md).

use serde::{Deserialize, Serialize};

/// Correctors on board, including those in use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CorrectorsAboard))]
#[serde(deny_unknown_fields)]
pub struct Inventory {
    /// Magnets by their kind.
    pub magnets: Vec<Lot>,
    /// Names of the sizes with a pair on board.
    #[serde(default)]
    pub quadrantal: Vec<String>,
    /// Length of each piece of the Flinders bar, mm.
    #[serde(default)]
    pub flinders_pieces_mm: Vec<f64>,
}

/// Magnets of one kind on board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = MagnetLot))]
#[serde(deny_unknown_fields)]
pub struct Lot {
    /// Kind of the magnets.
    #[cfg_attr(feature = "openapi", schema(example = "200 mm"))]
    pub magnet: String,
    /// Number of magnets, including those in use.
    pub count: u16,
    /// Tested moment, A·m²; without it the nominal moment applies.
    #[serde(default)]
    pub tested_moment_am2: Option<f64>,
    /// Relative standard deviation of the tested moment; the default is 0.02.
    #[serde(default)]
    pub tested_sd: Option<f64>,
}
