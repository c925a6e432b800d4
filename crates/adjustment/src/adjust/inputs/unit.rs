//! Units of the magnetic field.

use serde::{Deserialize, Serialize};

/// A unit of the magnetic field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = FieldUnit))]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Nanotesla, nT.
    Nanotesla,
    /// Microtesla, µT.
    Microtesla,
    /// Gauss, G.
    Gauss,
    /// Milligauss, mG.
    Milligauss,
}

impl Unit {
    /// All units.
    pub const ALL: [Unit; 4] = [
        Unit::Nanotesla,
        Unit::Microtesla,
        Unit::Gauss,
        Unit::Milligauss,
    ];

    /// Returns the size of the unit, nT.
    pub fn nt(self) -> f64 {
        match self {
            Unit::Nanotesla => 1.0,
            Unit::Microtesla => 1e3,
            Unit::Gauss => 1e5,
            Unit::Milligauss => 100.0,
        }
    }
}
