//! What was read at the berth, and how well.

use super::error::BerthError;
use super::reading_errors::ReadingErrors;
use binnacle_compass::angle::MagneticHeading;

/// Three times the earth's strongest field: beyond it the unit is wrong.
const GREATEST_FIELD_NT: f64 = 200_000.0;
/// A magnetometer worse than this tells nothing of a ship.
const GREATEST_FIELD_SD_NT: f64 = 10_000.0;
/// Beyond this an angle's error is no longer small, as the arithmetic takes it.
const GREATEST_ANGLE_SD_DEG: f64 = 5.0;
/// Less than this is a magnetometer that does not work.
const LEAST_FIELD_NT: f64 = 1.0;

/// What heading and magnetometer are held against, which decides about the
/// model's constant.
///
/// The constant is the offset of the model's reference (and variation) less that
/// of the compass's lubber line; which of the two it is cannot be told. With
/// one of each kind give [`Alignment::Keel`] and let the errors include the
/// instrument's own offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// The heading comes from outside the ship's instruments (a surveyed quay,
    /// leading marks, the sun) and the magnetometer lies along the keel: neither
    /// offset is met, and the constant is left out.
    Keel,
    /// The heading is that of the very reference the model was fitted with, and
    /// the magnetometer lies along the compass's lubber line: both offsets are
    /// met as in the fit, and the constant is taken off the heading.
    AsFitted,
}

/// The horizontal field at the card's centre on a known heading: finite, not
/// nil, with errors that are errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BerthReading {
    magnetic: MagneticHeading,
    field_nt: [f64; 2],
    errors: ReadingErrors,
    alignment: Alignment,
}

impl BerthReading {
    /// A reading of the field `[forward, starboard]`, nT, on a magnetic heading:
    /// true heading less variation.
    ///
    /// # Errors
    /// Names the first value that cannot be: not finite, a negative error, or
    /// of a size that only a wrong unit gives.
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

    /// Magnetic heading at the berth.
    pub fn magnetic(&self) -> MagneticHeading {
        self.magnetic
    }

    /// The field read, `[forward, starboard]`, nT.
    pub fn field_nt(&self) -> [f64; 2] {
        self.field_nt
    }

    /// Standard deviations of all of it.
    pub fn errors(&self) -> ReadingErrors {
        self.errors
    }

    /// What heading and magnetometer are held against.
    pub fn alignment(&self) -> Alignment {
        self.alignment
    }
}
