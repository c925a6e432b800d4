//! The earth's magnetic field at a place and time, from the standard models.
//!
//! IGRF-14 and WMM2025 are summed in f64 from the coefficient files in this
//! crate's `data` (docs/science.md, §1). The files are read once; an evaluation
//! allocates nothing, and is regular everywhere, the poles included. At a pole
//! north is taken along the meridian that the longitude names.

mod coefficients;
mod synthesis;

use crate::angle::Variation;
use crate::position::Position;
use crate::ship::EarthField;
use crate::time::Timestamp;
use coefficients::{Between, Terms};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A standard model of the earth's field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FieldModel {
    /// IGRF-14: 1900 to 2030, linear between its epochs
    /// (IAGA 2024, doi 10.5281/zenodo.14012302).
    #[default]
    Igrf14,
    /// World Magnetic Model 2025 of NOAA and BGS: 2025 to 2030.
    Wmm2025,
}

/// The lowest altitude the models are evaluated at, metres above the ellipsoid.
pub const LOWEST_ALTITUDE_M: f64 = -10_000.0;
/// The highest altitude the models are evaluated at, metres above the
/// ellipsoid: that of the WMM2025 technical report.
pub const HIGHEST_ALTITUDE_M: f64 = 850_000.0;

/// Why there is no field for a time or place.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The date lies outside the model, or is not a number.
    #[error("{model} knows the years {first} to {last}, not {year:.4}")]
    DateOutside {
        /// The model asked.
        model: FieldModel,
        /// The decimal year asked for.
        year: f64,
        /// The first decimal year it knows.
        first: f64,
        /// The last decimal year it knows.
        last: f64,
    },
    /// The altitude is not finite or far from the sea.
    #[error(
        "altitude {0} m is not between {LOWEST_ALTITUDE_M} and {HIGHEST_ALTITUDE_M} m \
         above the ellipsoid"
    )]
    Altitude(f64),
}

/// The earth's field at one place and time, in nanotesla.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Towards true (geodetic) north.
    pub x_nt: f64,
    /// Towards east.
    pub y_nt: f64,
    /// Down.
    pub z_nt: f64,
}

impl Field {
    /// Horizontal intensity, nT: what the compass points by.
    ///
    /// Below 6000 nT the WMM calls declination a matter of caution, below
    /// 2000 nT unusable.
    pub fn h_nt(&self) -> f64 {
        self.x_nt.hypot(self.y_nt)
    }

    /// Total intensity, nT.
    pub fn f_nt(&self) -> f64 {
        self.h_nt().hypot(self.z_nt)
    }

    /// Declination, which seamen call variation: east positive.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
    pub fn declination(&self) -> Variation {
        Variation::new(self.y_nt.atan2(self.x_nt).to_degrees())
            .expect("a field is only made from finite parts")
    }

    /// Dip: degrees below the horizon, positive north of the magnetic equator.
    pub fn inclination_deg(&self) -> f64 {
        self.z_nt.atan2(self.h_nt()).to_degrees()
    }

    /// Dip latitude: the magnetic latitude whose dipole has this dip, degrees.
    pub fn magnetic_latitude_deg(&self) -> f64 {
        self.z_nt.atan2(2.0 * self.h_nt()).to_degrees()
    }

    /// The parts a ship meets: horizontal and vertical.
    pub fn for_ship(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt(),
            z_nt: self.z_nt,
        }
    }
}

/// The field at a place (geodetic, WGS 84), an altitude in metres above the
/// ellipsoid, and a time.
///
/// # Errors
/// When the model does not know the date, or the altitude is absurd.
pub fn field(
    model: FieldModel,
    position: Position,
    altitude_m: f64,
    time: Timestamp,
) -> Result<Field, FieldError> {
    let instant = around(model, time.decimal_year())?;
    synthesise(&instant.terms(), position, altitude_m)
}

/// A model's coefficients for one instant: for many places at that time.
///
/// The field changes by less than a nanotesla a day anywhere, so an evaluator
/// made for noon serves the day's samples well.
#[derive(Clone, Debug)]
pub struct FieldAt {
    terms: Terms,
}

impl FieldAt {
    /// The model at an instant.
    ///
    /// # Errors
    /// When the model does not know the date.
    pub fn time(model: FieldModel, time: Timestamp) -> Result<FieldAt, FieldError> {
        FieldAt::year(model, time.decimal_year())
    }

    /// The model at a decimal year, such as 2026.5.
    ///
    /// # Errors
    /// When the model does not know the date, or it is not a number.
    pub fn year(model: FieldModel, decimal_year: f64) -> Result<FieldAt, FieldError> {
        let instant = around(model, decimal_year)?;
        Ok(FieldAt {
            terms: instant.terms(),
        })
    }

    /// The field at a place and an altitude in metres above the ellipsoid.
    ///
    /// # Errors
    /// When the altitude is not finite or far from the sea.
    pub fn at(&self, position: Position, altitude_m: f64) -> Result<Field, FieldError> {
        synthesise(&self.terms, position, altitude_m)
    }
}

fn around(model: FieldModel, year: f64) -> Result<Between, FieldError> {
    let table = coefficients::table(model);
    table.around(year).ok_or_else(|| FieldError::DateOutside {
        model,
        year,
        first: table.first_year(),
        last: table.last_year(),
    })
}

fn synthesise(terms: &Terms, position: Position, altitude_m: f64) -> Result<Field, FieldError> {
    if !(LOWEST_ALTITUDE_M..=HIGHEST_ALTITUDE_M).contains(&altitude_m) {
        return Err(FieldError::Altitude(altitude_m));
    }
    Ok(synthesis::synthesise(terms, position, altitude_m))
}

impl FieldModel {
    /// The name in commands and JSON: `igrf14` or `wmm2025`.
    pub fn name(self) -> &'static str {
        match self {
            FieldModel::Igrf14 => "igrf14",
            FieldModel::Wmm2025 => "wmm2025",
        }
    }

    /// The first and last decimal year the model knows.
    pub fn years(self) -> (f64, f64) {
        let table = coefficients::table(self);
        (table.first_year(), table.last_year())
    }
}

impl fmt::Display for FieldModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no field model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no field model: it is igrf14 or wmm2025")]
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

#[cfg(test)]
mod tests;
