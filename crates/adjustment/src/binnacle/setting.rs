//! How the correctors stand, and whether they can stand so.

use super::axis::{Axis, Red};
use super::design::Side;
use serde::{Deserialize, Deserializer, Serialize};

/// Where every corrector stands; an empty list or null is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Fore-and-aft magnets, a hole each.
    #[serde(default)]
    pub fore_and_aft: Vec<Tray>,
    /// Athwartship magnets, a hole each.
    #[serde(default)]
    pub athwartship: Vec<Tray>,
    /// Spheres, boxes or plates.
    #[serde(default)]
    pub quadrantal: Option<PairSetting>,
    /// The Flinders bar.
    #[serde(default)]
    pub flinders: Option<BarSetting>,
    /// The vertical magnets.
    #[serde(default)]
    pub heeling: Option<HeelingSetting>,
}

/// Magnets in one hole or tray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tray {
    /// Number of the hole, from the bottom.
    #[serde(deserialize_with = "numbered")]
    pub hole: u16,
    /// Their kind.
    pub magnet: String,
    /// How many.
    pub count: u8,
    /// Where their red ends point.
    pub red: Red,
}

/// A pair of spheres, boxes or plates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSetting {
    /// Name of the size.
    pub size: String,
    /// Position on the scale, mm.
    pub mark_mm: f64,
    /// Degrees clockwise from athwartships, seen from above.
    #[serde(default)]
    pub slew_deg: f64,
}

/// A Flinders bar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarSetting {
    /// Length of all its pieces, mm.
    pub length_mm: f64,
    /// On which side of the card.
    pub side: Side,
    /// Degrees clockwise from there, seen from above.
    #[serde(default)]
    pub slew_deg: f64,
}

/// Magnets in the bucket.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeelingSetting {
    /// Number of its position, from the bottom.
    #[serde(deserialize_with = "numbered")]
    pub position: u16,
    /// How many magnets.
    pub count: u8,
    /// Where their red ends point: up or down.
    pub red: Red,
}

/// The soft iron of a setting: what is set before the magnets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soft {
    /// Spheres, boxes or plates.
    pub quadrantal: Option<PairSetting>,
    /// The Flinders bar.
    pub flinders: Option<BarSetting>,
}

impl Setting {
    /// The magnets of an axis.
    pub fn trays(&self, axis: Axis) -> &Vec<Tray> {
        match axis {
            Axis::ForeAndAft => &self.fore_and_aft,
            Axis::Athwartship => &self.athwartship,
        }
    }

    /// The magnets of an axis, to change.
    pub fn trays_mut(&mut self, axis: Axis) -> &mut Vec<Tray> {
        match axis {
            Axis::ForeAndAft => &mut self.fore_and_aft,
            Axis::Athwartship => &mut self.athwartship,
        }
    }

    /// Its soft iron.
    pub fn soft(&self) -> Soft {
        Soft {
            quadrantal: self.quadrantal.clone(),
            flinders: self.flinders.clone(),
        }
    }
}

/// A number of a hole or position; what cannot be one is said in an adjuster's words.
fn numbered<'de, D: Deserializer<'de>>(from: D) -> Result<u16, D::Error> {
    let number = i64::deserialize(from)?;
    u16::try_from(number).map_err(|_| {
        let what = format!("there is no {number}: holes and positions are numbered from 1");
        serde::de::Error::custom(what)
    })
}
