//! Checks single values.

use super::ScenarioError;
use super::error::Source;
use super::raw::{Matrix, Number, Vector};
use binnacle_compass::position::Position;
use std::ops::RangeInclusive;

pub(super) type Checked<T> = Result<T, ScenarioError>;

/// Limits of permanent magnetism, nT.
pub(super) const PERMANENT_NT: RangeInclusive<f64> = -60_000.0..=60_000.0;
/// Limits of the soft-iron coefficients.
const INDUCED: RangeInclusive<f64> = -0.8..=0.8;
/// Polar waters are excluded: a rhumb line and a magnetic compass end there.
const LATITUDES: RangeInclusive<f64> = -78.0..=78.0;

impl Source<'_> {
    /// Returns a number within a range, which NaN and infinity are not.
    pub(super) fn number(
        &self,
        field: &str,
        value: &Number,
        range: RangeInclusive<f64>,
    ) -> Checked<f64> {
        let found = *value.get_ref();
        if range.contains(&found) {
            return Ok(found);
        }
        let problem = format!("{found} is not within {} to {}", range.start(), range.end());
        Err(self.error(value.span(), field, problem))
    }

    /// Returns an optional number within a range, or the default.
    pub(super) fn or(
        &self,
        field: &str,
        value: Option<&Number>,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Checked<f64> {
        value.map_or(Ok(default), |value| self.number(field, value, range))
    }

    pub(super) fn position(&self, lat: &Number, lon: &Number) -> Checked<Position> {
        let span = lon.span();
        let lat = self.number("lat", lat, LATITUDES)?;
        let lon = self.number("lon", lon, -180.0..=180.0)?;
        Position::new(lat, lon).map_err(|error| self.error(span, "lon", error.to_string()))
    }

    pub(super) fn vector(
        &self,
        field: &str,
        raw: &Vector,
        range: RangeInclusive<f64>,
    ) -> Checked<[f64; 3]> {
        let mut vector = [0.0; 3];
        for (value, raw) in vector.iter_mut().zip(raw) {
            *value = self.number(field, raw, range.clone())?;
        }
        Ok(vector)
    }

    pub(super) fn matrix(&self, field: &str, raw: &Matrix) -> Checked<[[f64; 3]; 3]> {
        let mut matrix = [[0.0; 3]; 3];
        for (row, raw) in matrix.iter_mut().zip(raw) {
            *row = self.vector(field, raw, INDUCED)?;
        }
        Ok(matrix)
    }
}
