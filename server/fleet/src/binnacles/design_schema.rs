//! OpenAPI descriptions of the parts of a binnacle's design.

use serde::Serialize;
use utoipa::ToSchema;

/// Classes of ISO 25862, and what is in neither.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CompassClass)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::CompassKind"
)]
pub(super) enum CompassKindSchema {
    ClassA,
    ClassB,
    Other,
}

/// Magnets of one kind.
#[derive(ToSchema)]
#[schema(as = MagnetKind)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::MagnetKind"
)]
pub(super) struct MagnetKindSchema {
    /// Name of the magnets.
    name: String,
    /// From end to end, mm.
    length_mm: f64,
    /// Nominal magnetic moment, A·m².
    moment_am2: f64,
    /// Relative standard deviation of a magnet's moment about the nominal one.
    moment_tolerance: f64,
}

/// Carrier of magnets.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = MagnetCarrier)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Carrier")]
enum CarrierSchema {
    Hole,
    Tray,
}

/// Positions of the magnets of one axis.
#[derive(ToSchema)]
#[schema(as = MagnetRack)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Rack")]
pub(super) struct RackSchema {
    /// Carrier of the magnets.
    carrier: CarrierSchema,
    /// Number of trays, or of holes that may hold magnets at once.
    at_once: u8,
    /// Magnets in each.
    magnets_each: u8,
    /// Sideways distance of each magnet from the middle plane, mm.
    #[schema(required = false)]
    off_centre_mm: f64,
    /// Standard deviation of a magnet's height, mm.
    #[schema(required = false)]
    position_sd_mm: f64,
    /// Names of the kinds that fit.
    magnets: Vec<String>,
    /// The holes, numbered from the bottom.
    holes: Vec<HeightSchema>,
}

/// A numbered height below the card.
#[derive(ToSchema)]
#[schema(as = NumberedHeight)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Hole")]
struct HeightSchema {
    /// From 1, at the bottom, upwards.
    number: u16,
    /// From the card's centre down to the magnets' centre, mm.
    below_card_mm: f64,
}

/// Soft iron in pairs at the card's height.
#[derive(ToSchema)]
#[schema(as = QuadrantalBrackets)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::Quadrantal"
)]
pub(super) struct QuadrantalSchema {
    /// Sizes that fit the brackets.
    sizes: Vec<IronSizeSchema>,
    /// Positions on the brackets' scale.
    marks: Vec<MarkSchema>,
    /// Angles to which the brackets turn from athwartships, degrees clockwise.
    #[schema(required = false)]
    slews_deg: Vec<f64>,
}

/// One size of a pair.
#[derive(ToSchema)]
#[schema(as = IronSize)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::IronSize"
)]
struct IronSizeSchema {
    /// Name of the correctors.
    name: String,
    /// Their shape.
    shape: ShapeSchema,
    /// Diameter of the sphere; of boxes and plates, that of the spheres that do the same.
    diameter_mm: f64,
    /// Relative standard deviation of its effect about the formula's.
    tolerance: f64,
}

/// Shapes of quadrantal correctors.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = IronShape)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Shape")]
enum ShapeSchema {
    Sphere,
    Box,
    Plate,
}

/// A position of the pair.
#[derive(ToSchema)]
#[schema(as = BracketMark)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Mark")]
struct MarkSchema {
    /// Scale mark, mm.
    mark_mm: f64,
    /// From the card's centre to the centre of either, mm.
    centre_mm: f64,
}

/// The holder of the Flinders bar.
#[derive(ToSchema)]
#[schema(as = FlindersHolder)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::Flinders"
)]
pub(super) struct FlindersSchema {
    /// Diameter of the bar, mm.
    diameter_mm: f64,
    /// From the card's centre to the bar's axis, mm.
    axis_mm: f64,
    /// The longest bar that the holder takes, mm.
    longest_mm: f64,
    /// On which sides of the card it can stand.
    sides: Vec<SideSchema>,
    /// Angles by which the holder turns from there, degrees clockwise.
    #[schema(required = false)]
    slews_deg: Vec<f64>,
    /// Relative standard deviation of its effect about the formula's.
    tolerance: f64,
}

/// Before or abaft the card.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = BarSide)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Side")]
pub(super) enum SideSchema {
    /// Before the card.
    Forward,
    /// Abaft it.
    Aft,
}

/// The bucket of the vertical magnets.
#[derive(ToSchema)]
#[schema(as = HeelingBucket)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Heeling")]
pub(super) struct HeelingHolderSchema {
    /// The kind of magnets that fits, upright.
    magnet: String,
    /// Greatest number of magnets in it.
    at_most: u8,
    /// Positions of the bucket, numbered from the bottom.
    positions: Vec<HeightSchema>,
}
