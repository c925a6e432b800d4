//! The earth's magnetic field at a place and time, from the standard models.
//!
//! IGRF-14 and WMM2025 are summed in f64 from the coefficient files in this
//! crate's `data` (docs/science.md, §1). The files are read once; an evaluation
//! allocates nothing, and is regular everywhere, the poles included. At a pole
//! north is taken along the meridian that the longitude names.

mod coefficients;
mod intensity;
mod standard_model;
mod synthesis;

pub use intensity::Field;
pub use standard_model::{FieldModel, UnknownFieldModel};

use crate::position::Position;
use crate::time::Timestamp;
use coefficients::{Between, Terms};

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
    pub fn from_time(model: FieldModel, time: Timestamp) -> Result<FieldAt, FieldError> {
        FieldAt::from_year(model, time.decimal_year())
    }

    /// The model at a decimal year, such as 2026.5.
    ///
    /// # Errors
    /// When the model does not know the date, or it is not a number.
    pub fn from_year(model: FieldModel, decimal_year: f64) -> Result<FieldAt, FieldError> {
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
    /// The first and last decimal year the model knows.
    pub fn years(self) -> (f64, f64) {
        let table = coefficients::table(self);
        (table.first_year(), table.last_year())
    }
}

#[cfg(test)]
mod tests;
