//! The written form of what is found at the berth (docs/plan.md).
//!
//! What always holds: a form that was read gives a field at the berth, a reading with
//! all its errors, and waters; else the complaint names the field.

use super::{Adjustment, Circumstances, Limits, VerticalReading, Water};
use crate::angle::{MagneticHeading, TrueHeading, Variation};
use crate::berth::{Alignment, BerthError, BerthReading, ReadingErrors};
use crate::binnacle::Binnacle;
use crate::field::{Field, FieldModel, field};
use crate::model::Model;
use crate::position::Position;
use crate::ship::EarthField;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// No field to steer by is weaker, aboard any ship, nT.
const LEAST_FIELD_NT: f64 = 500.0;
/// Steel of an ordinary quay, nT.
const USUAL_STEEL_NT: f64 = 100.0;
/// A heading from ashore or from the ship's own reference, degrees.
const USUAL_HEADING_SD_DEG: f64 = 0.5;

/// What is found at the berth, as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BerthForm {
    /// When it was read.
    pub time: Timestamp,
    /// Latitude, degrees north, with longitude; or the field itself.
    #[serde(default)]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[serde(default)]
    pub lon: Option<f64>,
    /// Horizontal field, nT.
    #[serde(default)]
    pub h_nt: Option<f64>,
    /// Vertical field, nT, down positive.
    #[serde(default)]
    pub z_nt: Option<f64>,
    /// Variation, degrees, east positive.
    #[serde(default)]
    pub variation_deg: Option<f64>,
    /// True heading of the bow.
    #[serde(default)]
    pub true_heading_deg: Option<f64>,
    /// Magnetic heading of the bow, instead of that.
    #[serde(default)]
    pub magnetic_heading_deg: Option<f64>,
    /// Where the heading comes from.
    #[serde(default)]
    pub heading_from: HeadingFrom,
    /// Standard deviation of the heading, variation included, degrees.
    #[serde(default)]
    pub heading_sd_deg: Option<f64>,
    /// Field forward at the card's place, bowl out, nT.
    pub forward_nt: f64,
    /// Field to starboard, nT.
    pub starboard_nt: f64,
    /// Field downwards, nT, if it was read.
    #[serde(default)]
    pub down_nt: Option<f64>,
    /// What it was read with.
    pub magnetometer: Magnetometer,
    /// What steel near the berth may add to each part, standard deviation, nT.
    #[serde(default)]
    pub steel_sd_nt: Option<f64>,
    /// Heel at the reading, degrees.
    #[serde(default)]
    pub heel_deg: f64,
    /// What the compass read before the bowl was taken out.
    #[serde(default)]
    pub compass_deg: Option<f64>,
    /// Whether magnetic cargo is on board that the model does not know.
    #[serde(default)]
    pub cargo_on_board: bool,
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

/// Where a heading comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeadingFrom {
    /// From outside the ship: a surveyed quay, leading marks, the sun; and the
    /// magnetometer lies along the keel.
    #[default]
    Ashore,
    /// From the reference that the model was fitted with; and the magnetometer lies
    /// along the compass's lubber line.
    ModelReference,
}

/// A magnetometer; what is not said of it is usual for its kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Magnetometer {
    /// What kind it is.
    pub kind: MagnetometerKind,
    /// Noise of each part, nT.
    #[serde(default)]
    pub field_sd_nt: Option<f64>,
    /// Relative standard deviation of its scale.
    #[serde(default)]
    pub scale_sd: Option<f64>,
    /// Of its alignment, degrees.
    #[serde(default)]
    pub alignment_sd_deg: Option<f64>,
    /// Of its tilt in roll and in pitch, degrees.
    #[serde(default)]
    pub tilt_sd_deg: Option<f64>,
}

/// Kinds of magnetometers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MagnetometerKind {
    /// A fluxgate or a proton magnetometer made for it.
    Fluxgate,
    /// A telephone's.
    Phone,
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

/// Names the field of the form, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct FormError {
    /// The field, as in JSON.
    pub field: String,
    /// What is wrong.
    pub what: String,
}

fn wrong(field: impl Into<String>, what: impl Into<String>) -> FormError {
    FormError {
        field: field.into(),
        what: what.into(),
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
    pub fn read(&self) -> Result<Berth, FormError> {
        let (earth, variation) = self.field()?;
        let magnetic = self.magnetic(variation)?;
        self.right_unit()?;
        let usual = self.magnetometer.kind.usual();
        let given = &self.magnetometer;
        let noise = given.field_sd_nt.unwrap_or(usual.field_sd_nt);
        let steel = self.steel_sd_nt.unwrap_or(USUAL_STEEL_NT);
        for (name, value, greatest) in [
            ("steel_sd_nt", steel, 10_000.0),
            ("magnetometer.field_sd_nt", noise, 10_000.0),
            ("heel_deg", self.heel_deg.abs(), 5.0),
        ] {
            if !(0.0..=greatest).contains(&value) {
                return Err(wrong(
                    name,
                    format!("{value} is not between 0 and {greatest}"),
                ));
            }
        }
        let tilt = given.tilt_sd_deg.unwrap_or(usual.tilt_sd_deg);
        let errors = ReadingErrors {
            field_sd_nt: noise.hypot(steel),
            heading_sd_deg: self.heading_sd_deg.unwrap_or(USUAL_HEADING_SD_DEG),
            alignment_sd_deg: given.alignment_sd_deg.unwrap_or(usual.alignment_sd_deg),
            // A heeled ship's magnetometer is levelled by no better than its heel.
            tilt_sd_deg: tilt.hypot(self.heel_deg / 2.0),
        };
        let alignment = match self.heading_from {
            HeadingFrom::Ashore => Alignment::Keel,
            HeadingFrom::ModelReference => Alignment::AsFitted,
        };
        let read_nt = [self.forward_nt, self.starboard_nt];
        let reading = BerthReading::new(magnetic, read_nt, errors, alignment);
        let reading = reading.map_err(|error| match &error {
            BerthError::Reading { name, .. } => wrong(*name, error.to_string()),
            _ => wrong("forward_nt, starboard_nt", error.to_string()),
        })?;
        let age = self
            .model_until
            .map(|until| self.time.seconds_since(until) / 86_400.0);
        if age.is_some_and(|days| days < 0.0) {
            return Err(wrong("model_until", "is after the reading's time"));
        }
        Ok(Berth {
            earth,
            reading,
            scale_sd: given.scale_sd.unwrap_or(usual.scale_sd),
            compass_deg: self.compass_deg,
            vertical: self.down_nt.map(|down_nt| VerticalReading { down_nt }),
            waters: self.waters(earth)?,
            circumstances: Circumstances {
                model_age_days: age,
                cargo_on_board: self.cargo_on_board,
            },
            limits: self.limits,
        })
    }

    fn field(&self) -> Result<(EarthField, Option<Variation>), FormError> {
        let variation = self.variation_deg.map(Variation::try_from).transpose();
        let variation = variation.map_err(|error| wrong("variation_deg", error.to_string()))?;
        if let (Some(h_nt), Some(z_nt)) = (self.h_nt, self.z_nt) {
            return Ok((earth("", h_nt, z_nt)?, variation));
        }
        let (Some(lat), Some(lon)) = (self.lat, self.lon) else {
            return Err(wrong("lat, lon", "are missing, and so are h_nt and z_nt"));
        };
        let found = field_at("", lat, lon, self.time)?;
        Ok((found.for_ship(), variation.or(Some(found.declination()))))
    }

    fn magnetic(&self, variation: Option<Variation>) -> Result<MagneticHeading, FormError> {
        match (self.true_heading_deg, self.magnetic_heading_deg) {
            (Some(_), Some(_)) => Err(wrong(
                "magnetic_heading_deg",
                "is given beside true_heading_deg: one of them is enough",
            )),
            (None, None) => Err(wrong("true_heading_deg", "is missing")),
            (None, Some(degrees)) => MagneticHeading::try_from(degrees)
                .map_err(|error| wrong("magnetic_heading_deg", error.to_string())),
            (Some(degrees), None) => {
                let heading = TrueHeading::try_from(degrees);
                let heading =
                    heading.map_err(|error| wrong("true_heading_deg", error.to_string()))?;
                let Some(variation) = variation else {
                    return Err(wrong("variation_deg", "is missing beside h_nt and z_nt"));
                };
                Ok(heading - variation)
            }
        }
    }

    /// A reading too weak for any ship is one in another unit.
    fn right_unit(&self) -> Result<(), FormError> {
        let size = self.forward_nt.hypot(self.starboard_nt);
        if size.is_nan() || size >= LEAST_FIELD_NT {
            return Ok(());
        }
        let unit = match size {
            gauss if gauss < 1.0 => "gauss: 1 gauss is 100000 nT",
            microtesla if microtesla < 90.0 => "microtesla: 1 microtesla is 1000 nT",
            _ => "milligauss: 1 milligauss is 100 nT",
        };
        let what = format!("{size} nT is no ship's field; this looks like {unit}");
        Err(wrong("forward_nt, starboard_nt", what))
    }

    fn waters(&self, berth: EarthField) -> Result<Vec<Water>, FormError> {
        if self.waters.is_empty() {
            return Ok(vec![Water {
                name: "where she lies".to_owned(),
                h_nt: berth.h_nt,
                z_nt: berth.z_nt,
                weight: 1.0,
            }]);
        }
        let each = self.waters.iter().enumerate();
        each.map(|(index, water)| water.read(index, self.time))
            .collect()
    }
}

impl WaterForm {
    fn read(&self, index: usize, time: Timestamp) -> Result<Water, FormError> {
        let prefix = format!("waters[{index}].");
        let field = match (self.h_nt, self.z_nt, self.lat, self.lon) {
            (Some(h_nt), Some(z_nt), None, None) => earth(&prefix, h_nt, z_nt)?,
            (None, None, Some(lat), Some(lon)) => field_at(&prefix, lat, lon, time)?.for_ship(),
            _ => {
                let what = "give h_nt and z_nt, or lat and lon";
                return Err(wrong(prefix.trim_end_matches('.'), what));
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

fn earth(prefix: &str, h_nt: f64, z_nt: f64) -> Result<EarthField, FormError> {
    for (name, value, least) in [("h_nt", h_nt, 2_000.0), ("z_nt", z_nt, -100_000.0)] {
        if !(least..=100_000.0).contains(&value) {
            let what = format!("{value} is not between {least} and 100000");
            return Err(wrong(format!("{prefix}{name}"), what));
        }
    }
    Ok(EarthField { h_nt, z_nt })
}

fn field_at(prefix: &str, lat: f64, lon: f64, time: Timestamp) -> Result<Field, FormError> {
    Position::new(lat, 0.0).map_err(|error| wrong(format!("{prefix}lat"), error.to_string()))?;
    let position = Position::new(lat, lon)
        .map_err(|error| wrong(format!("{prefix}lon"), error.to_string()))?;
    field(FieldModel::Igrf14, position, 0.0, time).map_err(|error| wrong("time", error.to_string()))
}

/// What is usual for a kind.
struct Usual {
    field_sd_nt: f64,
    scale_sd: f64,
    alignment_sd_deg: f64,
    tilt_sd_deg: f64,
}

impl MagnetometerKind {
    fn usual(self) -> Usual {
        match self {
            MagnetometerKind::Fluxgate => Usual {
                field_sd_nt: 100.0,
                scale_sd: 0.003,
                alignment_sd_deg: 0.3,
                tilt_sd_deg: 0.3,
            },
            MagnetometerKind::Phone => Usual {
                field_sd_nt: 1_000.0,
                scale_sd: 0.03,
                alignment_sd_deg: 1.0,
                tilt_sd_deg: 1.0,
            },
        }
    }
}
