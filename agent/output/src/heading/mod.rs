//! The corrected heading, as far as it is known, and the times at which it is sent.

mod schedule;

pub(crate) use schedule::Schedule;
pub use schedule::Trigger;

use binnacle_compass::angle::{CompassHeading, Deviation, MagneticHeading, TrueHeading, Variation};

/// Corrected heading, as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heading {
    /// Raw reading.
    pub compass: Option<CompassHeading>,
    /// Deviation of the model on this heading.
    pub deviation: Option<Deviation>,
    /// Variation of the field.
    pub variation: Option<Variation>,
    /// Compass heading with both applied; `None` while it is withheld.
    pub true_heading: Option<TrueHeading>,
    /// Standard error of the deviation.
    pub standard_error_deg: Option<f64>,
}

impl Heading {
    /// Returns the compass heading with the deviation applied; none while it is withheld.
    pub fn magnetic(&self) -> Option<MagneticHeading> {
        self.true_heading?;
        Some(self.compass? + self.deviation?)
    }
}

#[cfg(test)]
impl Heading {
    /// Creates a heading that is not withheld, from degrees, east positive.
    pub(crate) fn from_degrees(compass: f64, deviation: f64, variation: f64) -> Heading {
        let compass = CompassHeading::new(compass).unwrap();
        let deviation = Deviation::new(deviation).unwrap();
        let variation = Variation::new(variation).unwrap();
        Heading {
            compass: Some(compass),
            deviation: Some(deviation),
            variation: Some(variation),
            true_heading: Some(compass + deviation + variation),
            standard_error_deg: Some(0.25),
        }
    }
}
