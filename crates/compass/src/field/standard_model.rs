//! The standard models of the earth's field and their names.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A standard model of the earth's field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "lowercase")]
pub enum FieldModel {
    /// IGRF-14: 1900 to 2030, linear between its epochs
    /// (IAGA 2024, doi 10.5281/zenodo.14012302).
    #[default]
    Igrf14,
    /// World Magnetic Model 2025 of NOAA and BGS: 2025 to 2030.
    Wmm2025,
}

impl FieldModel {
    /// Name in commands and JSON: `igrf14` or `wmm2025`.
    pub fn name(self) -> &'static str {
        match self {
            FieldModel::Igrf14 => "igrf14",
            FieldModel::Wmm2025 => "wmm2025",
        }
    }
}

impl fmt::Display for FieldModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Error of a name that is not a field model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown field model {0:?}: use igrf14 or wmm2025")]
pub struct UnknownFieldModel(pub String);

impl FromStr for FieldModel {
    type Err = UnknownFieldModel;

    fn from_str(name: &str) -> Result<FieldModel, UnknownFieldModel> {
        match name {
            "igrf14" => Ok(FieldModel::Igrf14),
            "wmm2025" => Ok(FieldModel::Wmm2025),
            _ => Err(UnknownFieldModel(name.to_owned())),
        }
    }
}
