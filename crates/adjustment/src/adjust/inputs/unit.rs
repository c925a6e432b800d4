//! Units of the magnetic field.

use serde::{Deserialize, Serialize};

/// A unit of the magnetic field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// nT.
    Nanotesla,
    /// µT.
    Microtesla,
    /// G.
    Gauss,
    /// mG.
    Milligauss,
}

impl Unit {
    /// All of them.
    pub const ALL: [Unit; 4] = [
        Unit::Nanotesla,
        Unit::Microtesla,
        Unit::Gauss,
        Unit::Milligauss,
    ];

    /// One of it, nT.
    pub fn nt(self) -> f64 {
        match self {
            Unit::Nanotesla => 1.0,
            Unit::Microtesla => 1e3,
            Unit::Gauss => 1e5,
            Unit::Milligauss => 100.0,
        }
    }
}
