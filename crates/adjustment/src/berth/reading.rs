//! Reading of the magnetometer at the berth.

use super::error::BerthError;
use super::reading_errors::ReadingErrors;
use binnacle_compass::angle::MagneticHeading;

/// Three times the earth's strongest field, nT; a larger value has the wrong unit.
const GREATEST_FIELD_NT: f64 = 200_000.0;
/// Greatest useful error of a magnetometer, nT.
const GREATEST_FIELD_SD_NT: f64 = 10_000.0;
/// Greatest error of an angle, degrees; the linear propagation needs small errors.
const GREATEST_ANGLE_SD_DEG: f64 = 5.0;
/// Least horizontal field of a working magnetometer, nT.
const LEAST_FIELD_NT: f64 = 1.0;

/// Reference of heading and magnetometer, which determines the use of the model's constant.
///
/// The constant is the offset of the model's reference (and variation) less that of the
/// compass's lubber line; the two cannot be separated. For a mixed case use
/// [`Alignment::Keel`] and include the instrument's own offset in the errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// The heading comes from outside the ship's instruments (a surveyed quay, leading
    /// marks, the sun) and the magnetometer is aligned with the keel. Neither offset
    /// occurs, and the constant is not applied.
    Keel,
    /// The heading comes from the reference of the model's fit, and the magnetometer is
    /// aligned with the compass's lubber line. Both offsets occur as in the fit, and the
    /// constant is subtracted from the heading.
    AsFitted,
}

/// Valid reading of the horizontal field at the card's centre on a known heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BerthReading {
    magnetic: MagneticHeading,
    field_nt: [f64; 2],
    errors: ReadingErrors,
    alignment: Alignment,
}

impl BerthReading {
    /// Makes a reading of the field `[forward, starboard]`, nT, on a magnetic heading (true
    /// heading less variation).
    ///
    /// # Errors
    /// Names the first value that is not finite, a negative error, or so large that its
    /// unit is wrong.
    pub fn new(
        magnetic: MagneticHeading,
        field_nt: [f64; 2],
        errors: ReadingErrors,
        alignment: Alignment,
    ) -> Result<BerthReading, BerthError> {
        let [forward_nt, starboard_nt] = field_nt;
        for (name, value, least, greatest) in [
            (
                "forward_nt",
                forward_nt,
                -GREATEST_FIELD_NT,
                GREATEST_FIELD_NT,
            ),
            (
                "starboard_nt",
                starboard_nt,
                -GREATEST_FIELD_NT,
                GREATEST_FIELD_NT,
            ),
            (
                "field_sd_nt",
                errors.field_sd_nt,
                f64::MIN_POSITIVE,
                GREATEST_FIELD_SD_NT,
            ),
            (
                "heading_sd_deg",
                errors.heading_sd_deg,
                0.0,
                GREATEST_ANGLE_SD_DEG,
            ),
            (
                "alignment_sd_deg",
                errors.alignment_sd_deg,
                0.0,
                GREATEST_ANGLE_SD_DEG,
            ),
            (
                "tilt_sd_deg",
                errors.tilt_sd_deg,
                0.0,
                GREATEST_ANGLE_SD_DEG,
            ),
        ] {
            if !(least..=greatest).contains(&value) {
                return Err(BerthError::Reading {
                    name,
                    value,
                    least,
                    greatest,
                });
            }
        }
        if forward_nt.hypot(starboard_nt) < LEAST_FIELD_NT {
            return Err(BerthError::NothingRead);
        }
        Ok(BerthReading {
            magnetic,
            field_nt,
            errors,
            alignment,
        })
    }

    /// Returns the magnetic heading at the berth.
    pub fn magnetic(&self) -> MagneticHeading {
        self.magnetic
    }

    /// Returns the measured field, `[forward, starboard]`, nT.
    pub fn field_nt(&self) -> [f64; 2] {
        self.field_nt
    }

    /// Returns the standard deviations of the reading.
    pub fn errors(&self) -> ReadingErrors {
        self.errors
    }

    /// Returns the reference of heading and magnetometer.
    pub fn alignment(&self) -> Alignment {
        self.alignment
    }
}
