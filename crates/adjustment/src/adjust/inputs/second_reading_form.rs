//! What the magnetometer read after the steps, as it is written (docs/plan.md).

use super::number_error::NumberError;
use super::reading_form::ReadingForm;
use super::unit::Unit;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// What the magnetometer of the first reading reads after the steps, in the same place and
/// lying the same way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondReadingForm {
    /// When it was read.
    pub at: Timestamp,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    pub forward: f64,
    /// The same, starboard positive.
    pub starboard: f64,
    /// Vertical field there, down positive, if it was read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<f64>,
    /// What all three are in.
    pub unit: Unit,
    /// The true heading of the bow, by the same means, where it is no longer what it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading_true_deg: Option<f64>,
    /// What the compass read before the bowl was taken out, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compass_deg: Option<f64>,
}

impl SecondReadingForm {
    /// The same as a reading of its own, all else as at the first one.
    ///
    /// # Errors
    /// Names what cannot be a number of its kind, or a time before the first reading's.
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
            ..first.clone()
        };
        reading.check_ranges()?;
        Ok(reading)
    }
}
