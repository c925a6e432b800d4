//! The earth's magnetic field at a place and time, by the standard models.
//!
//! IGRF-14 and WMM2025 are summed in f64 from the coefficient files in this crate's `data`
//! (docs/science.md, §1). The files are read once. An evaluation allocates nothing and is
//! regular everywhere, including the poles. At a pole, north is along the meridian of the
//! given longitude.

mod coefficients;
mod intensity;
mod standard_model;
mod synthesis;

pub use intensity::Field;
pub use standard_model::{FieldModel, UnknownFieldModel};

use crate::position::Position;
use crate::time::Timestamp;
use coefficients::{Interpolation, Terms};

/// Lowest altitude of an evaluation, metres above the ellipsoid.
pub const LOWEST_ALTITUDE_M: f64 = -10_000.0;
/// Highest altitude of an evaluation, metres above the ellipsoid (WMM2025 technical
/// report).
pub const HIGHEST_ALTITUDE_M: f64 = 850_000.0;

/// Error of a time or place without a field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The date lies outside the model's years, or is not a number.
    #[error("{model} covers the years {first} to {last}, not {year:.4}")]
    DateOutside {
        /// Model that was evaluated.
        model: FieldModel,
        /// Requested decimal year.
        year: f64,
        /// First decimal year of the model.
        first: f64,
        /// Last decimal year of the model.
        last: f64,
    },
    /// The altitude is not finite or outside the models' range.
    #[error(
        "altitude {0} m is not between {LOWEST_ALTITUDE_M} and {HIGHEST_ALTITUDE_M} m \
         above the ellipsoid"
    )]
    Altitude(f64),
}

/// Computes the field at a place (geodetic, WGS 84), an altitude in metres above the
/// ellipsoid, and a time.
///
/// # Errors
/// Fails when the date or the altitude is outside the model's range.
pub fn field(
    model: FieldModel,
    position: Position,
    altitude_m: f64,
    time: Timestamp,
) -> Result<Field, FieldError> {
    let instant = interpolate(model, time.decimal_year())?;
    synthesise(&instant.terms(), position, altitude_m)
}

/// Coefficients of a model at one instant, for evaluation at many places.
///
/// The field changes by less than a nanotesla a day anywhere, so an evaluator
/// made for noon serves the day's samples well.
#[derive(Clone, Debug)]
pub struct FieldAt {
    terms: Terms,
}

impl FieldAt {
    /// Prepares the model for an instant.
    ///
    /// # Errors
    /// Fails when the date is outside the model's years.
    pub fn from_time(model: FieldModel, time: Timestamp) -> Result<FieldAt, FieldError> {
        FieldAt::from_year(model, time.decimal_year())
    }

    /// Prepares the model for a decimal year, such as 2026.5.
    ///
    /// # Errors
    /// Fails when the year is outside the model's years, or not a number.
    pub fn from_year(model: FieldModel, decimal_year: f64) -> Result<FieldAt, FieldError> {
        let instant = interpolate(model, decimal_year)?;
        Ok(FieldAt {
            terms: instant.terms(),
        })
    }

    /// Computes the field at a place and an altitude in metres above the ellipsoid.
    ///
    /// # Errors
    /// Fails when the altitude is not finite or outside the models' range.
    pub fn at(&self, position: Position, altitude_m: f64) -> Result<Field, FieldError> {
        synthesise(&self.terms, position, altitude_m)
    }
}

fn interpolate(model: FieldModel, year: f64) -> Result<Interpolation, FieldError> {
    let table = coefficients::table(model);
    table.bracket(year).ok_or_else(|| FieldError::DateOutside {
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
    /// First and last decimal year of the model.
    pub fn years(self) -> (f64, f64) {
        let table = coefficients::table(self);
        (table.first_year(), table.last_year())
    }
}

#[cfg(test)]
mod tests;
