//! Written form of the magnetometer reading after the steps (docs/plan.md).

use super::number_error::NumberError;
use super::reading_form::ReadingForm;
use super::unit::Unit;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Second reading with the same magnetometer in the same place and alignment, after the
/// steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = SecondReading, example = json!({
    "at": "2026-11-22T10:05:00Z", "forward": 15.1, "starboard": 17.7, "unit": "microtesla"
})))]
#[serde(deny_unknown_fields)]
pub struct SecondReadingForm {
    /// Time of the reading.
    pub at: Timestamp,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    pub forward: f64,
    /// Horizontal field there, starboard positive.
    pub starboard: f64,
    /// Vertical field there, down positive, if measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<f64>,
    /// Unit of all three parts.
    pub unit: Unit,
    /// True heading of the vessel from the same source, if it changed, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub heading_true_deg: Option<f64>,
    /// Compass heading before the bowl was taken out, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub compass_deg: Option<f64>,
}

impl SecondReadingForm {
    /// Makes a complete reading with everything else from the first one.
    ///
    /// # Errors
    /// Names a number outside its range, or a time before the first reading's.
    pub fn as_reading(&self, first: &ReadingForm) -> Result<ReadingForm, NumberError> {
        if self.at.seconds_since(first.at) < 0.0 {
            return Err(NumberError {
                field: "at",
                what: "is before the first reading's time".to_owned(),
            });
        }
        let reading = ReadingForm {
            at: self.at,
            heading_true_deg: self.heading_true_deg.unwrap_or(first.heading_true_deg),
            forward: self.forward,
            starboard: self.starboard,
            down: self.down,
            unit: self.unit,
            compass_deg: self.compass_deg,
            shifted: None,
            ..first.clone()
        };
        reading.check_ranges()?;
        Ok(reading)
    }
}
