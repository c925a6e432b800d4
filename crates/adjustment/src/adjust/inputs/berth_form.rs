//! The written form of a berth, for the command line (docs/plan.md): the reading, as the
//! API takes it too, and what a server would know by itself.
//!
//! What always holds: a form that was read gives a field at the berth, a reading with
//! all its errors, and waters; else the complaint names the field.

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

/// What is found at the berth, as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BerthForm {
    /// What was read.
    pub reading: ReadingForm,
    /// The earth's field there, where it is known better than by the IGRF.
    #[serde(default)]
    pub field: Option<FieldForm>,
    /// When the model's last sample was taken.
    #[serde(default)]
    pub model_until: Option<Timestamp>,
    /// Where the vessel trades; the berth alone where it is not said.
    #[serde(default)]
    pub waters: Vec<WaterForm>,
    /// What a plan must keep to.
    #[serde(default)]
    pub limits: Limits,
}

/// The earth's field at a berth.
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

/// A place where the vessel trades, by its field or by its position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaterForm {
    /// What it is called.
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
    /// How much of her time she is there.
    pub weight: f64,
}

/// What was done at the berth after a plan, and what the magnetometer read then.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PostCheckForm {
    /// Which of the plans was followed, from 1.
    #[serde(default = "recommended")]
    pub plan: usize,
    /// By how much the compass turned at each of its steps, degrees; none where it was not
    /// read, or was too little to be told.
    #[serde(default)]
    pub turned_deg: Vec<Option<f64>>,
    /// What was read.
    pub reading: SecondReadingForm,
}

fn recommended() -> usize {
    1
}

/// Names the field of the form, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct FormError {
    /// The field, as in JSON.
    pub field: String,
    /// What is wrong.
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

/// What is found at the berth, checked.
#[derive(Clone, Debug)]
pub struct Berth {
    /// The earth's field.
    pub earth: EarthField,
    /// What the magnetometer read.
    pub reading: BerthReading,
    /// Of its scale.
    pub scale_sd: f64,
    /// What the compass read before.
    pub compass_deg: Option<f64>,
    /// The vertical part, if it was read.
    pub vertical: Option<VerticalReading>,
    /// Where the vessel trades.
    pub waters: Vec<Water>,
    /// What the model and the ship are like.
    pub circumstances: Circumstances,
    /// What a plan must keep to.
    pub limits: Limits,
}

impl Berth {
    /// All that a plan rests on.
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
    /// The berth that is meant.
    ///
    /// # Errors
    /// Names the field that cannot be, or is missing.
    pub fn parse(&self) -> Result<Berth, FormError> {
        let given = &self.reading;
        given
            .check_ranges()
            .map_err(|error| FormError::new(format!("reading.{}", error.field), error.what))?;
        self.limits
            .check_ranges()
            .map_err(|error| FormError::new(format!("limits.{}", error.field), error.what))?;
        let (earth, variation) = self.field()?;
        let reading = given.reading(variation).map_err(|error| match &error {
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
        })?;
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
                ..Circumstances::default()
            },
            limits: self.limits,
        })
    }

    /// The second reading that is meant, all else as at this berth.
    ///
    /// # Errors
    /// Names the field of it that cannot be.
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
                name: "the waters of her berth".to_owned(),
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

/// A figure as it was given, unless that would fill the page.
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
