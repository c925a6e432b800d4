//! Written form of a berth for the command line (docs/plan.md): the reading, in the same
//! form as in the API, and the data that a server has by itself.
//!
//! Invariants: a valid form gives a field at the berth, a reading with all its errors, and
//! waters. Otherwise the error names the field of the form.

use super::adjustment::{Adjustment, Circumstances, Water};
use super::limits::Limits;
use super::reading_form::ReadingForm;
use super::second_reading_form::SecondReadingForm;
use super::vertical_reading::VerticalReading;
use crate::berth::{BerthError, BerthReading};
use crate::binnacle::Binnacle;
use binnacle_compass::angle::Variation;
use binnacle_compass::field::{Field, FieldModel, field};
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Written form of a berth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BerthForm {
    /// Magnetometer reading.
    pub reading: ReadingForm,
    /// Earth's field at the berth, where known better than from the IGRF.
    #[serde(default)]
    pub field: Option<FieldForm>,
    /// Time of the model's last sample.
    #[serde(default)]
    pub model_until: Option<Timestamp>,
    /// Trading waters; the berth alone by default.
    #[serde(default)]
    pub waters: Vec<WaterForm>,
    /// Limits of a plan.
    #[serde(default)]
    pub limits: Limits,
}

/// Earth's field at a berth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FieldForm {
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Variation, degrees, east positive.
    pub variation_deg: f64,
}

/// A trading water, by field or by position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaterForm {
    /// Name of the water.
    pub name: String,
    /// Horizontal field, nT.
    #[serde(default)]
    pub h_nt: Option<f64>,
    /// Vertical field, nT, down positive.
    #[serde(default)]
    pub z_nt: Option<f64>,
    /// Latitude, degrees north, instead of the field.
    #[serde(default)]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[serde(default)]
    pub lon: Option<f64>,
    /// Relative time spent there.
    pub weight: f64,
}

/// Completed steps of a plan, with the magnetometer reading afterwards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PostCheckForm {
    /// Number of the plan that was followed, from 1.
    #[serde(default = "recommended")]
    pub plan: usize,
    /// Turn of the compass at each step, degrees; none where it was not read or too small
    /// to read.
    #[serde(default)]
    pub turned_deg: Vec<Option<f64>>,
    /// Magnetometer reading after the steps.
    pub reading: SecondReadingForm,
}

fn recommended() -> usize {
    1
}

/// Error of an invalid form, with the field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct FormError {
    /// Path of the field, as in JSON.
    pub field: String,
    /// Description of the error.
    pub what: String,
}

impl FormError {
    pub(crate) fn new(field: impl Into<String>, what: impl Into<String>) -> FormError {
        FormError {
            field: field.into(),
            what: what.into(),
        }
    }
}

/// Valid data of a berth.
#[derive(Clone, Debug)]
pub struct Berth {
    /// Earth's field.
    pub earth: EarthField,
    /// Magnetometer reading.
    pub reading: BerthReading,
    /// Relative standard deviation of the magnetometer's scale.
    pub scale_sd: f64,
    /// Compass heading before the steps, degrees.
    pub compass_deg: Option<f64>,
    /// Vertical field, if measured.
    pub vertical: Option<VerticalReading>,
    /// Trading waters.
    pub waters: Vec<Water>,
    /// Circumstances of model and vessel.
    pub circumstances: Circumstances,
    /// Limits of a plan.
    pub limits: Limits,
}

impl Berth {
    /// Makes the complete input of a plan.
    pub fn adjustment<'a>(&'a self, model: &'a Model, binnacle: &'a Binnacle) -> Adjustment<'a> {
        Adjustment {
            model,
            earth: self.earth,
            reading: &self.reading,
            scale_sd: self.scale_sd,
            compass_deg: self.compass_deg,
            vertical: self.vertical,
            binnacle,
            now: None,
            waters: &self.waters,
            circumstances: self.circumstances,
            limits: self.limits,
        }
    }
}

impl BerthForm {
    /// Validates the form.
    ///
    /// # Errors
    /// Names the invalid or missing field.
    pub fn parse(&self) -> Result<Berth, FormError> {
        let given = &self.reading;
        given
            .check_ranges()
            .map_err(|error| FormError::new(format!("reading.{}", error.field), error.what))?;
        self.limits
            .check_ranges()
            .map_err(|error| FormError::new(format!("limits.{}", error.field), error.what))?;
        let (earth, variation) = self.field()?;
        let impossible = |error: BerthError| match &error {
            BerthError::Reading {
                name,
                value,
                least,
                greatest,
            } => FormError::new(
                format!("reading.{}", name.trim_end_matches("_nt")),
                format!(
                    "{} nT is not between {least} and {greatest}",
                    figure(*value)
                ),
            ),
            _ => FormError::new("reading.forward, reading.starboard", error.to_string()),
        };
        let reading = given.reading(variation).map_err(impossible)?;
        let shifted = given.shifted_reading(variation);
        let shifted =
            shifted.map_err(|error| FormError::new("reading.shifted", error.to_string()))?;
        let age = self
            .model_until
            .map(|until| given.at.seconds_since(until) / 86_400.0);
        if age.is_some_and(|days| days < 0.0) {
            return Err(FormError::new("model_until", "is after the reading's time"));
        }
        Ok(Berth {
            earth,
            reading,
            scale_sd: given.scale_sd(),
            compass_deg: given.compass_deg,
            vertical: given.vertical(),
            waters: self.waters(earth)?,
            circumstances: Circumstances {
                model_age_days: age,
                cargo_on_board: given.cargo_on_board,
                shifted,
                ..Circumstances::default()
            },
            limits: self.limits,
        })
    }

    /// Validates the second reading, with everything else as at this berth.
    ///
    /// # Errors
    /// Names the invalid field.
    pub fn parse_after(&self, after: &PostCheckForm) -> Result<Berth, FormError> {
        let reading = after.reading.as_reading(&self.reading);
        let reading = reading
            .map_err(|error| FormError::new(format!("reading.{}", error.field), error.what))?;
        for (index, turned_deg) in after.turned_deg.iter().enumerate() {
            if turned_deg.is_some_and(|deg| !(-180.0..=180.0).contains(&deg)) {
                let what = "is not between -180 and 180";
                return Err(FormError::new(format!("turned_deg[{index}]"), what));
            }
        }
        BerthForm {
            reading,
            ..self.clone()
        }
        .parse()
    }

    pub(crate) fn field(&self) -> Result<(EarthField, Variation), FormError> {
        let given = &self.reading;
        let Some(known) = self.field else {
            let found = field_at("reading.", given.lat, given.lon, given.at)?;
            let there = found.for_ship();
            let there = earth("the berth's ", there.h_nt, there.z_nt)?;
            return Ok((there, found.declination()));
        };
        let variation = Variation::try_from(known.variation_deg);
        let variation =
            variation.map_err(|error| FormError::new("field.variation_deg", error.to_string()))?;
        Ok((earth("field.", known.h_nt, known.z_nt)?, variation))
    }

    fn waters(&self, berth: EarthField) -> Result<Vec<Water>, FormError> {
        if self.waters.is_empty() {
            return Ok(vec![Water {
                name: "the waters of the berth".to_owned(),
                h_nt: berth.h_nt,
                z_nt: berth.z_nt,
                weight: 1.0,
            }]);
        }
        let each = self.waters.iter().enumerate();
        each.map(|(index, water)| water.parse(index, self.reading.at))
            .collect()
    }
}

impl WaterForm {
    fn parse(&self, index: usize, time: Timestamp) -> Result<Water, FormError> {
        let prefix = format!("waters[{index}].");
        let field = match (self.h_nt, self.z_nt, self.lat, self.lon) {
            (Some(h_nt), Some(z_nt), None, None) => earth(&prefix, h_nt, z_nt)?,
            (None, None, Some(lat), Some(lon)) => field_at(&prefix, lat, lon, time)?.for_ship(),
            _ => {
                let what = "give h_nt and z_nt, or lat and lon";
                return Err(FormError::new(prefix.trim_end_matches('.'), what));
            }
        };
        Ok(Water {
            name: self.name.clone(),
            h_nt: field.h_nt,
            z_nt: field.z_nt,
            weight: self.weight,
        })
    }
}

/// Formats a figure as given, or with an exponent where it would be long.
fn figure(value: f64) -> String {
    if value.abs() < 1e12 {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn earth(prefix: &str, h_nt: f64, z_nt: f64) -> Result<EarthField, FormError> {
    for (name, value, least) in [("h_nt", h_nt, 2_000.0), ("z_nt", z_nt, -100_000.0)] {
        if !(least..=100_000.0).contains(&value) {
            let what = format!("{value} is not between {least} and 100000");
            return Err(FormError::new(format!("{prefix}{name}"), what));
        }
    }
    Ok(EarthField { h_nt, z_nt })
}

fn field_at(prefix: &str, lat: f64, lon: f64, time: Timestamp) -> Result<Field, FormError> {
    Position::new(lat, 0.0)
        .map_err(|error| FormError::new(format!("{prefix}lat"), error.to_string()))?;
    let position = Position::new(lat, lon)
        .map_err(|error| FormError::new(format!("{prefix}lon"), error.to_string()))?;
    field(FieldModel::Igrf14, position, 0.0, time)
        .map_err(|error| FormError::new("reading.at", error.to_string()))
}
