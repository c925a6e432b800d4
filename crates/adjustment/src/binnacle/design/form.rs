//! Written form of a binnacle's design (docs/binnacle.md).

use crate::binnacle::axis::Axis;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Written form of a binnacle's design; docs/binnacle.md explains every field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BinnacleDesign))]
#[serde(deny_unknown_fields)]
pub struct DesignForm {
    /// Version of the form: 1.
    pub version: u32,
    /// Name of the maker.
    pub maker: String,
    /// Maker's name of the model.
    pub model: String,
    /// Source of the figures.
    pub provenance: String,
    /// Class of its compass by ISO 25862: A, B or neither.
    pub compass: CompassKind,
    /// Magnetic moment of the compass needles, A·m², which magnetise the spheres.
    pub needle_moment_am2: f64,
    /// Kinds of magnets that fit it.
    pub magnets: Vec<MagnetKind>,
    /// Holes or trays of the fore-and-aft magnets, against B.
    pub fore_and_aft: Rack,
    /// Holes or trays of the athwartship magnets, against C.
    pub athwartship: Rack,
    /// Spheres, boxes or plates, against D (and against E on slewing brackets).
    #[serde(default)]
    pub quadrantal: Option<Quadrantal>,
    /// Flinders bar, against χ13.
    #[serde(default)]
    pub flinders: Option<Flinders>,
    /// Bucket of the vertical magnets, against heeling error.
    #[serde(default)]
    pub heeling: Option<Heeling>,
}

/// Class of a compass by ISO 25862.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CompassClass))]
#[serde(rename_all = "snake_case")]
pub enum CompassKind {
    /// Class A.
    ClassA,
    /// Class B.
    ClassB,
    /// Neither class A nor class B.
    Other,
}

/// A kind of magnets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct MagnetKind {
    /// Name of the kind.
    pub name: String,
    /// Length from end to end, mm.
    pub length_mm: f64,
    /// Nominal magnetic moment, A·m².
    pub moment_am2: f64,
    /// Relative standard deviation of a magnet's moment about the nominal one.
    pub moment_tolerance: f64,
}

/// Carrier of magnets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = MagnetCarrier))]
#[serde(rename_all = "snake_case")]
pub enum Carrier {
    /// A hole in the binnacle.
    Hole,
    /// A tray that hangs at one of the holes or marks.
    Tray,
}

/// Places for the magnets of one axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = MagnetRack))]
#[serde(deny_unknown_fields)]
pub struct Rack {
    /// Carrier of the magnets.
    pub carrier: Carrier,
    /// Number of trays, or of holes that may hold magnets at once.
    pub at_once: u8,
    /// Greatest number of magnets in each: all of one kind, red ends in the same direction.
    pub magnets_each: u8,
    /// Sideways distance of each magnet from the binnacle's middle plane, mm.
    #[serde(default)]
    pub off_centre_mm: f64,
    /// Standard deviation of a magnet's height, mm.
    #[serde(default)]
    pub position_sd_mm: f64,
    /// Names of the kinds that fit.
    pub magnets: Vec<String>,
    /// Holes, numbered from the bottom.
    pub holes: Vec<Hole>,
}

/// A numbered hole or position below the card.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = NumberedHeight))]
#[serde(deny_unknown_fields)]
pub struct Hole {
    /// Number, from 1 at the bottom upwards (ISO 25862).
    pub number: u16,
    /// Vertical distance from the card's centre down to the magnets' centre, mm.
    pub below_card_mm: f64,
}

/// Quadrantal correctors: soft iron in pairs at the card's height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = QuadrantalBrackets))]
#[serde(deny_unknown_fields)]
pub struct Quadrantal {
    /// Sizes that fit the brackets.
    pub sizes: Vec<IronSize>,
    /// Positions on the brackets' scale.
    pub marks: Vec<Mark>,
    /// Slew angles of the brackets, degrees clockwise from athwartships seen from above:
    /// positive moves the starboard one aft, 90 is fore and aft.
    #[serde(default = "not_slewed")]
    pub slews_deg: Vec<f64>,
}

fn not_slewed() -> Vec<f64> {
    vec![0.0]
}

/// A size of quadrantal correctors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct IronSize {
    /// Name of the size.
    pub name: String,
    /// Shape of the correctors.
    pub shape: Shape,
    /// Diameter of the sphere; for boxes and plates, of the equivalent spheres, mm.
    pub diameter_mm: f64,
    /// Relative standard deviation of the effect about the formula's.
    pub tolerance: f64,
}

/// Shape of quadrantal correctors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = IronShape))]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A solid or hollow sphere.
    Sphere,
    /// A box of soft iron chain or rods.
    Box,
    /// Plates, often within the binnacle.
    Plate,
}

/// A position of the pair on the brackets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BracketMark))]
#[serde(deny_unknown_fields)]
pub struct Mark {
    /// Mark on the scale, mm.
    pub mark_mm: f64,
    /// Distance from the card's centre to the centre of either corrector, mm.
    pub centre_mm: f64,
}

/// The holder of the Flinders bar; its top pole is at the card's height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = FlindersHolder))]
#[serde(deny_unknown_fields)]
pub struct Flinders {
    /// Diameter of the bar, mm.
    pub diameter_mm: f64,
    /// Distance from the card's centre to the bar's axis, mm.
    pub axis_mm: f64,
    /// Greatest length of the bar, mm.
    pub longest_mm: f64,
    /// Possible sides of the card.
    pub sides: Vec<Side>,
    /// Slew angles of the holder from there, degrees clockwise seen from above.
    #[serde(default = "not_slewed")]
    pub slews_deg: Vec<f64>,
    /// Relative standard deviation of the effect about the formula's.
    pub tolerance: f64,
}

/// Side of the card.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BarSide))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Forward of the card.
    Forward,
    /// Abaft the card.
    Aft,
}

/// Bucket of the heeling magnets under the card.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = HeelingBucket))]
#[serde(deny_unknown_fields)]
pub struct Heeling {
    /// Kind of magnets that fits, upright.
    pub magnet: String,
    /// Greatest number of magnets.
    pub at_most: u8,
    /// Positions, numbered from the bottom.
    pub positions: Vec<Hole>,
}

impl DesignForm {
    /// Finds the kind of magnets of this name.
    pub fn magnet(&self, name: &str) -> Option<&MagnetKind> {
        self.magnets.iter().find(|kind| kind.name == name)
    }

    /// Returns the rack of an axis.
    pub fn rack(&self, axis: Axis) -> &Rack {
        match axis {
            Axis::ForeAndAft => &self.fore_and_aft,
            Axis::Athwartship => &self.athwartship,
        }
    }
}

impl Rack {
    /// Finds the hole of this number.
    pub fn hole(&self, number: u16) -> Option<Hole> {
        self.holes.iter().copied().find(|h| h.number == number)
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Side::Forward => "forward",
            Side::Aft => "aft",
        })
    }
}

impl fmt::Display for Carrier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Carrier::Hole => "hole",
            Carrier::Tray => "tray",
        })
    }
}
