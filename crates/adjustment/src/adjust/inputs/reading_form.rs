//! Written form of a magnetometer reading at the berth, in a file for `plan` and in the API
//! alike (docs/plan.md).
//!
//! Invariants: the unit is always named, never guessed. A form is accepted with all its
//! errors, or the error names the field or the single misreadings that explain the reading.

use super::number_error::NumberError;
use super::unit::Unit;
use super::vertical_reading::VerticalReading;
use crate::berth::{Alignment, BerthError, BerthReading, ReadingErrors};
use binnacle_compass::angle::{MagneticHeading, TrueHeading, Variation, wrap_180};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Magnetometer reading at the berth; docs/plan.md explains every field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BerthReading, example = json!({
    "at": "2026-11-22T08:20:00Z", "lat": 43.35, "lon": -3.04,
    "heading_true_deg": 312.0, "heading_from": "model_reference",
    "forward": 17.2, "starboard": 14.9, "unit": "microtesla",
    "magnetometer": "fluxgate", "compass_deg": 310.5
})))]
#[serde(deny_unknown_fields)]
pub struct ReadingForm {
    /// Time of the reading.
    pub at: Timestamp,
    /// Latitude of the berth, degrees north.
    #[cfg_attr(feature = "openapi", schema(minimum = -90, maximum = 90))]
    pub lat: f64,
    /// Longitude of the berth, degrees east.
    #[cfg_attr(feature = "openapi", schema(minimum = -180, maximum = 180))]
    pub lon: f64,
    /// True heading of the vessel, degrees.
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub heading_true_deg: f64,
    /// Source of that heading: `model_reference`, the gyro or satellite compass of the
    /// model's fit, or `ashore`.
    pub heading_from: HeadingFrom,
    /// Standard deviation of the heading, including variation, degrees; 0.5 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 5))]
    pub heading_sd_deg: Option<f64>,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    pub forward: f64,
    /// Horizontal field there, starboard positive.
    pub starboard: f64,
    /// Vertical field there, down positive, if measured; without it the heeling magnets
    /// stay.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<f64>,
    /// Unit of all three parts.
    pub unit: Unit,
    /// Kind of magnetometer.
    pub magnetometer: Magnetometer,
    /// Maker, type and serial number of the magnetometer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(max_length = 200))]
    pub magnetometer_serial: Option<String>,
    /// Standard deviation of each part, nT; by default that of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 5000))]
    pub field_sd_nt: Option<f64>,
    /// Relative standard deviation of the magnetometer's scale; by default that of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 0.5))]
    pub scale_sd: Option<f64>,
    /// Standard deviation of the magnetometer's alignment, degrees; by default that of the
    /// kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 5))]
    pub alignment_sd_deg: Option<f64>,
    /// Standard deviation of the magnetometer's tilt in roll and in pitch, degrees; by
    /// default that of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 4))]
    pub tilt_sd_deg: Option<f64>,
    /// Standard deviation of the field of nearby steel in each part, nT.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 5000))]
    pub steel_sd_nt: Option<f64>,
    /// Compass heading before the bowl was taken out, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub compass_deg: Option<f64>,
    /// Heel of the vessel, degrees to starboard.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(minimum = -5, maximum = 5))]
    pub heel_deg: f64,
    /// Steel nearby: a crane, a ship alongside, a quay of steel piles.
    #[serde(default)]
    pub steel_nearby: bool,
    /// Magnetic cargo on board that the model does not include.
    #[serde(default)]
    pub cargo_on_board: bool,
    /// Reading after the vessel was shifted to another heading of this berth, before anything
    /// was moved: it shows steel on the quay that would pass for λ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shifted: Option<ShiftedReading>,
}

/// Reading on another heading of the berth by the same magnetometer in the same unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ShiftedReading {
    /// True heading of the vessel from the same source, degrees; at least 30 degrees from
    /// the first.
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub heading_true_deg: f64,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    pub forward: f64,
    /// Horizontal field there, starboard positive.
    pub starboard: f64,
}

/// Least difference of two headings of a berth, degrees: with less, hardly anything of λ is
/// separated from the quay's steel.
const LEAST_SHIFT_DEG: f64 = 30.0;

/// Source of a heading at the berth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum HeadingFrom {
    /// The reference of the model's fit, with the magnetometer along the compass's lubber
    /// line.
    ModelReference,
    /// A source outside the vessel (a surveyed quay, leading marks, the sun), with the
    /// magnetometer along the keel.
    Ashore,
}

/// Kind of magnetometer, by precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Magnetometer {
    /// A purpose-made fluxgate or proton magnetometer.
    Fluxgate,
    /// An instrument with a magnetoresistive sensor.
    Magnetoresistive,
    /// A telephone: precise enough for magnets, too poor for spheres.
    Phone,
    /// Another instrument.
    Other,
}

/// Usual standard deviations of a kind.
struct Usual {
    field_sd_nt: f64,
    scale_sd: f64,
    alignment_sd_deg: f64,
    tilt_sd_deg: f64,
}

/// Greatest credible improvement of a telephone over the usual errors.
const PHONE_TIMES: f64 = 3.0;
/// Steel of an ordinary quay, nT.
const USUAL_STEEL_NT: f64 = 100.0;
/// Steel nearby, nT.
const NEARBY_STEEL_NT: f64 = 500.0;
/// Heading from ashore or from the vessel's own reference, degrees.
const USUAL_HEADING_SD_DEG: f64 = 0.5;

impl Magnetometer {
    fn usual(self) -> Usual {
        let (field_sd_nt, scale_sd, alignment_sd_deg, tilt_sd_deg) = match self {
            Magnetometer::Fluxgate => (100.0, 0.004, 0.5, 0.3),
            Magnetometer::Magnetoresistive => (300.0, 0.01, 0.5, 0.5),
            Magnetometer::Phone => (1_500.0, 0.03, 2.0, 1.0),
            Magnetometer::Other => (500.0, 0.02, 1.0, 0.5),
        };
        Usual {
            field_sd_nt,
            scale_sd,
            alignment_sd_deg,
            tilt_sd_deg,
        }
    }
}

impl ReadingForm {
    /// Checks the ranges of all numbers; plausibility is checked by [`ReadingForm::check`].
    ///
    /// # Errors
    /// Names the field outside its range.
    pub fn check_ranges(&self) -> Result<(), NumberError> {
        let or_nil = |value: Option<f64>| value.unwrap_or(0.0);
        let usual = self.magnetometer.usual();
        // The limit holds for any claimed error.
        let best = |usual: f64| match self.magnetometer {
            Magnetometer::Phone => usual / PHONE_TIMES,
            _ => 0.0,
        };
        let claimed = |claim: Option<f64>, usual: f64| (claim.unwrap_or(usual), best(usual));
        let (field_sd_nt, best_nt) = claimed(self.field_sd_nt, usual.field_sd_nt);
        let (scale_sd, best_scale) = claimed(self.scale_sd, usual.scale_sd);
        let (lies_sd_deg, best_lies_deg) = claimed(self.alignment_sd_deg, usual.alignment_sd_deg);
        let (tilt_sd_deg, best_tilt_deg) = claimed(self.tilt_sd_deg, usual.tilt_sd_deg);
        for (field, value, least, greatest) in [
            ("lat", self.lat, -90.0, 90.0),
            ("lon", self.lon, -180.0, 180.0),
            ("heading_true_deg", self.heading_true_deg, 0.0, 360.0),
            ("heading_sd_deg", or_nil(self.heading_sd_deg), 0.0, 5.0),
            ("field_sd_nt", field_sd_nt, best_nt.max(1.0), 5_000.0),
            ("scale_sd", scale_sd, best_scale, 0.5),
            ("alignment_sd_deg", lies_sd_deg, best_lies_deg, 5.0),
            ("tilt_sd_deg", tilt_sd_deg, best_tilt_deg, 4.0),
            ("steel_sd_nt", or_nil(self.steel_sd_nt), 0.0, 5_000.0),
            ("compass_deg", or_nil(self.compass_deg), 0.0, 360.0),
            ("heel_deg", self.heel_deg, -5.0, 5.0),
        ] {
            if !(least..=greatest).contains(&value) {
                return Err(NumberError {
                    field,
                    what: format!("{value} is not between {least} and {greatest}"),
                });
            }
        }
        self.check_shifted()
    }

    fn check_shifted(&self) -> Result<(), NumberError> {
        let Some(shifted) = &self.shifted else {
            return Ok(());
        };
        let degrees = shifted.heading_true_deg;
        if !(0.0..=360.0).contains(&degrees) {
            return Err(NumberError {
                field: "shifted",
                what: format!("heading_true_deg {degrees} is not between 0 and 360"),
            });
        }
        let apart_deg = wrap_180(degrees - self.heading_true_deg).abs();
        if apart_deg < LEAST_SHIFT_DEG {
            return Err(NumberError {
                field: "shifted",
                what: format!(
                    "heading_true_deg {degrees} is only {apart_deg:.0} degrees from the first \
                     heading: at least {LEAST_SHIFT_DEG} are needed"
                ),
            });
        }
        Ok(())
    }

    /// Converts the reading on the other heading, if there is one.
    ///
    /// # Errors
    /// Fails when no ship has such a field.
    pub fn shifted_reading(
        &self,
        variation: Variation,
    ) -> Result<Option<BerthReading>, BerthError> {
        let Some(shifted) = &self.shifted else {
            return Ok(None);
        };
        let other = ReadingForm {
            heading_true_deg: shifted.heading_true_deg,
            forward: shifted.forward,
            starboard: shifted.starboard,
            down: None,
            shifted: None,
            ..self.clone()
        };
        other.reading(variation).map(Some)
    }

    /// Returns the relative standard deviation of the magnetometer's scale.
    pub fn scale_sd(&self) -> f64 {
        self.scale_sd.unwrap_or(self.magnetometer.usual().scale_sd)
    }

    /// Returns the vertical field, if measured.
    pub fn vertical(&self) -> Option<VerticalReading> {
        let down_nt = self.down? * self.unit.nt();
        Some(VerticalReading { down_nt })
    }

    /// Converts the form to a berth reading.
    ///
    /// # Errors
    /// Fails when no ship has such a field.
    pub fn reading(&self, variation: Variation) -> Result<BerthReading, BerthError> {
        if let Some(vertical) = self.vertical() {
            vertical.check_range()?;
        }
        BerthReading::new(
            self.magnetic(variation)?,
            self.field_nt(),
            self.errors(),
            self.alignment(),
        )
    }

    pub(crate) fn field_nt(&self) -> [f64; 2] {
        [self.forward, self.starboard].map(|part| part * self.unit.nt())
    }

    pub(crate) fn magnetic(&self, variation: Variation) -> Result<MagneticHeading, BerthError> {
        let heading = TrueHeading::new(self.heading_true_deg);
        let heading = heading.ok_or(BerthError::Reading {
            name: "heading_true_deg",
            value: self.heading_true_deg,
            least: 0.0,
            greatest: 360.0,
        })?;
        Ok(heading - variation)
    }

    pub(crate) fn errors(&self) -> ReadingErrors {
        let usual = self.magnetometer.usual();
        let usual_steel_nt = if self.steel_nearby {
            NEARBY_STEEL_NT
        } else {
            USUAL_STEEL_NT
        };
        let noise_nt = self.field_sd_nt.unwrap_or(usual.field_sd_nt);
        let tilt_sd_deg = self.tilt_sd_deg.unwrap_or(usual.tilt_sd_deg);
        ReadingErrors {
            field_sd_nt: noise_nt.hypot(self.steel_sd_nt.unwrap_or(usual_steel_nt)),
            heading_sd_deg: self.heading_sd_deg.unwrap_or(USUAL_HEADING_SD_DEG),
            alignment_sd_deg: self.alignment_sd_deg.unwrap_or(usual.alignment_sd_deg),
            // Levelling is limited by the vessel's heel.
            tilt_sd_deg: tilt_sd_deg.hypot(self.heel_deg / 2.0),
        }
    }

    pub(crate) fn alignment(&self) -> Alignment {
        match self.heading_from {
            HeadingFrom::ModelReference => Alignment::AsFitted,
            HeadingFrom::Ashore => Alignment::Keel,
        }
    }
}
