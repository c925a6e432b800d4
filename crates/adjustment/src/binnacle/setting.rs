//! Setting of all correctors.

use super::axis::{Axis, Red};
use super::design::Side;
use serde::{Deserialize, Deserializer, Serialize};

/// Setting of all correctors; an empty list or null is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CorrectorSetting))]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Fore-and-aft magnets by hole.
    #[serde(default, deserialize_with = "in_order")]
    pub fore_and_aft: Vec<Tray>,
    /// Athwartship magnets by hole.
    #[serde(default, deserialize_with = "in_order")]
    pub athwartship: Vec<Tray>,
    /// Spheres, boxes or plates.
    #[serde(default)]
    pub quadrantal: Option<PairSetting>,
    /// Flinders bar.
    #[serde(default)]
    pub flinders: Option<BarSetting>,
    /// Vertical magnets.
    #[serde(default)]
    pub heeling: Option<HeelingSetting>,
}

/// Magnets in one hole or tray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = MagnetsInHole))]
#[serde(deny_unknown_fields)]
pub struct Tray {
    /// Number of the hole, from the bottom.
    #[serde(deserialize_with = "numbered")]
    pub hole: u16,
    /// Kind of the magnets.
    #[cfg_attr(feature = "openapi", schema(example = "200 mm"))]
    pub magnet: String,
    /// Number of magnets.
    pub count: u8,
    /// Direction of the red, north-seeking ends.
    pub red: Red,
}

/// A pair of spheres, boxes or plates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct PairSetting {
    /// Name of the size.
    #[cfg_attr(feature = "openapi", schema(example = "7 inch"))]
    pub size: String,
    /// Position on the scale, mm.
    pub mark_mm: f64,
    /// Slew, degrees clockwise from athwartships, seen from above.
    #[serde(default)]
    pub slew_deg: f64,
}

/// Setting of a Flinders bar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct BarSetting {
    /// Total length of its pieces, mm.
    pub length_mm: f64,
    /// Side of the card.
    pub side: Side,
    /// Slew, degrees clockwise from there, seen from above.
    #[serde(default)]
    pub slew_deg: f64,
}

/// Setting of the heeling magnets in the bucket.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct HeelingSetting {
    /// Number of the bucket's position, from the bottom.
    #[serde(deserialize_with = "numbered")]
    pub position: u16,
    /// Number of magnets.
    pub count: u8,
    /// Direction of the red ends: up or down.
    pub red: Red,
}

/// Soft iron of a setting, set before the magnets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soft {
    /// Spheres, boxes or plates.
    pub quadrantal: Option<PairSetting>,
    /// Flinders bar.
    pub flinders: Option<BarSetting>,
}

impl Setting {
    /// Returns the magnets of an axis.
    pub fn trays(&self, axis: Axis) -> &Vec<Tray> {
        match axis {
            Axis::ForeAndAft => &self.fore_and_aft,
            Axis::Athwartship => &self.athwartship,
        }
    }

    /// Returns the magnets of an axis for modification.
    pub fn trays_mut(&mut self, axis: Axis) -> &mut Vec<Tray> {
        match axis {
            Axis::ForeAndAft => &mut self.fore_and_aft,
            Axis::Athwartship => &mut self.athwartship,
        }
    }

    /// Returns the soft iron.
    pub fn soft(&self) -> Soft {
        Soft {
            quadrantal: self.quadrantal.clone(),
            flinders: self.flinders.clone(),
        }
    }
}

/// Reads the magnets of an axis, by hole, kind and end: the order in which someone names them
/// makes no other setting.
fn in_order<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Tray>, D::Error> {
    let mut trays = Vec::<Tray>::deserialize(from)?;
    trays.sort_by(|a, b| {
        (a.hole, &a.magnet, a.red, a.count).cmp(&(b.hole, &b.magnet, b.red, b.count))
    });
    Ok(trays)
}

/// Reads the number of a hole or position.
fn numbered<'de, D: Deserializer<'de>>(from: D) -> Result<u16, D::Error> {
    let number = i64::deserialize(from)?;
    u16::try_from(number).map_err(|_| {
        let what = format!("there is no {number}: holes and positions are numbered from 1");
        serde::de::Error::custom(what)
    })
}
