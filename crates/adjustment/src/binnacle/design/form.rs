//! The written form of a binnacle's design (docs/binnacle.md).

use crate::binnacle::axis::Axis;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A design as it is written; [`Design`] is one that was checked.
///
/// [`Design`]: super::Design
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignForm {
    /// Version of this form.
    pub version: u32,
    /// Who makes it.
    pub maker: String,
    /// What the maker calls it.
    pub model: String,
    /// Where its figures come from.
    pub provenance: String,
    /// What kind of compass stands in it.
    pub compass: CompassKind,
    /// Magnetic moment of the needles, A·m²: they magnetise the spheres.
    pub needle_moment_am2: f64,
    /// Kinds of magnets that fit somewhere in it.
    pub magnets: Vec<MagnetKind>,
    /// For the fore-and-aft magnets, against B.
    pub fore_and_aft: Rack,
    /// For the athwartship magnets, against C.
    pub athwartship: Rack,
    /// Spheres, boxes or plates, against D (and E where their brackets slew).
    #[serde(default)]
    pub quadrantal: Option<Quadrantal>,
    /// Flinders bar, against χ13.
    #[serde(default)]
    pub flinders: Option<Flinders>,
    /// Bucket of the vertical magnets, against heeling error.
    #[serde(default)]
    pub heeling: Option<Heeling>,
}

/// Classes of ISO 25862, and what is in neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CompassKind {
    /// Class A.
    ClassA,
    /// Class B.
    ClassB,
    /// Neither.
    Other,
}

/// Magnets of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MagnetKind {
    /// What they are called.
    pub name: String,
    /// From end to end, mm.
    pub length_mm: f64,
    /// Nominal magnetic moment, A·m².
    pub moment_am2: f64,
    /// Relative standard deviation of a magnet's moment about the nominal one.
    pub moment_tolerance: f64,
}

/// What magnets are put into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Carrier {
    /// Straight into a hole.
    Hole,
    /// Into a tray that hangs at one of the holes or marks.
    Tray,
}

/// Where the magnets of one axis may stand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rack {
    /// What magnets are put into.
    pub carrier: Carrier,
    /// How many trays there are, or how many holes may hold magnets at once.
    pub at_once: u8,
    /// How many magnets each takes; all of one kind, red ends the same way.
    pub magnets_each: u8,
    /// Sideways distance of each magnet from the binnacle's middle plane, mm.
    #[serde(default)]
    pub off_centre_mm: f64,
    /// Standard deviation of a magnet's height, mm.
    #[serde(default)]
    pub position_sd_mm: f64,
    /// Names of the kinds that fit.
    pub magnets: Vec<String>,
    /// The holes, numbered from the bottom.
    pub holes: Vec<Hole>,
}

/// A numbered height below the card.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hole {
    /// From 1, at the bottom, upwards (ISO 25862).
    pub number: u16,
    /// From the card's centre down to the magnets' centre, mm.
    pub below_card_mm: f64,
}

/// Soft iron in pairs at the card's height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quadrantal {
    /// Sizes that fit the brackets.
    pub sizes: Vec<IronSize>,
    /// Positions on the brackets' scale.
    pub marks: Vec<Mark>,
    /// Angles to which the brackets turn from athwartships, degrees clockwise seen
    /// from above: positive brings the starboard one aft. 90 is fore and aft.
    #[serde(default = "not_slewed")]
    pub slews_deg: Vec<f64>,
}

fn not_slewed() -> Vec<f64> {
    vec![0.0]
}

/// One size of a pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IronSize {
    /// What it is called.
    pub name: String,
    /// What it looks like.
    pub shape: Shape,
    /// Diameter of the sphere; of boxes and plates, that of the spheres that do
    /// the same.
    pub diameter_mm: f64,
    /// Relative standard deviation of its effect about the formula's.
    pub tolerance: f64,
}

/// Shapes of quadrantal correctors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A solid or hollow sphere.
    Sphere,
    /// A box of soft iron chain or rods.
    Box,
    /// Plates, often within the binnacle.
    Plate,
}

/// A position of the pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mark {
    /// What the scale says, mm.
    pub mark_mm: f64,
    /// From the card's centre to the centre of either, mm.
    pub centre_mm: f64,
}

/// The holder of the Flinders bar; its top pole is at the card's height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flinders {
    /// Diameter of the bar, mm.
    pub diameter_mm: f64,
    /// From the card's centre to the bar's axis, mm.
    pub axis_mm: f64,
    /// The longest bar that the holder takes, mm.
    pub longest_mm: f64,
    /// On which sides of the card it can stand.
    pub sides: Vec<Side>,
    /// Angles by which the holder turns from there, degrees clockwise from above.
    #[serde(default = "not_slewed")]
    pub slews_deg: Vec<f64>,
    /// Relative standard deviation of its effect about the formula's.
    pub tolerance: f64,
}

/// Before or abaft the card.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Before the card.
    Forward,
    /// Abaft it.
    Aft,
}

/// The bucket under the card.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heeling {
    /// The kind of magnets that fits, upright.
    pub magnet: String,
    /// How many it takes.
    pub at_most: u8,
    /// Its positions, numbered from the bottom.
    pub positions: Vec<Hole>,
}

impl DesignForm {
    /// The kind of magnets of this name.
    pub fn magnet(&self, name: &str) -> Option<&MagnetKind> {
        self.magnets.iter().find(|kind| kind.name == name)
    }

    /// The rack of an axis.
    pub fn rack(&self, axis: Axis) -> &Rack {
        match axis {
            Axis::ForeAndAft => &self.fore_and_aft,
            Axis::Athwartship => &self.athwartship,
        }
    }
}

impl Rack {
    /// The hole of this number.
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
