//! OpenAPI descriptions of binnacles. The adjustment crate owns the types; docs/binnacle.md
//! explains each field.

use super::design_schema::{
    CompassKindSchema, FlindersSchema, HeelingHolderSchema, MagnetKindSchema, QuadrantalSchema,
    RackSchema, SideSchema,
};
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

/// A binnacle on board; docs/binnacle.md has every field.
#[derive(ToSchema)]
#[schema(as = Binnacle)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::BinnacleForm"
)]
pub struct BinnacleSchema {
    /// Of this form: 1.
    version: u32,
    /// The maker's number of this one.
    serial: String,
    /// Its design, whole.
    #[schema(rename = "type")]
    design: DesignSchema,
    /// All correctors on board, those in use included.
    aboard: AboardSchema,
    /// Their present setting.
    setting: SettingSchema,
    /// Measured effects of the correctors, which take precedence over the formulas.
    #[schema(required = false, value_type = Vec<Object>)]
    calibration: Vec<Value>,
}

/// A maker's design; docs/binnacle.md has every field.
#[derive(ToSchema)]
#[schema(as = BinnacleDesign)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::DesignForm"
)]
pub(super) struct DesignSchema {
    /// Of this form: 1.
    version: u32,
    /// Its maker.
    maker: String,
    /// The maker's name for it.
    model: String,
    /// Source of its figures.
    provenance: String,
    /// Class A or B of ISO 25862, or neither.
    compass: CompassKindSchema,
    /// Magnetic moment of the needles, A·m².
    needle_moment_am2: f64,
    /// Kinds of magnets that fit somewhere in it.
    magnets: Vec<MagnetKindSchema>,
    /// Trays or holes of the fore-and-aft magnets.
    fore_and_aft: RackSchema,
    /// Trays or holes of the athwartship magnets.
    athwartship: RackSchema,
    /// Spheres, boxes or plates.
    #[schema(required = false)]
    quadrantal: Option<QuadrantalSchema>,
    /// Holder of the Flinders bar.
    #[schema(required = false)]
    flinders: Option<FlindersSchema>,
    /// Bucket of the vertical magnets.
    #[schema(required = false)]
    heeling: Option<HeelingHolderSchema>,
}

/// Correctors on board, those in use included.
#[derive(ToSchema)]
#[schema(as = CorrectorsAboard)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::Inventory"
)]
pub(super) struct AboardSchema {
    /// Magnets by their kind.
    magnets: Vec<LotSchema>,
    /// Sizes of which there is a pair.
    #[schema(required = false)]
    quadrantal: Vec<String>,
    /// Lengths of the Flinders bar's pieces, mm.
    #[schema(required = false)]
    flinders_pieces_mm: Vec<f64>,
}

/// Magnets of one kind on board.
#[derive(ToSchema)]
#[schema(as = MagnetLot)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Lot")]
struct LotSchema {
    /// Their kind.
    #[schema(example = "200 mm")]
    magnet: String,
    /// Number of magnets, those in use included.
    count: u16,
    /// Their moment as it was tested, A·m²; the nominal one counts otherwise.
    #[schema(required = false)]
    tested_moment_am2: Option<f64>,
    /// Relative standard deviation of that; 0.02 where it is not said.
    #[schema(required = false)]
    tested_sd: Option<f64>,
}

/// Setting of every corrector; an empty list or null is none.
#[derive(ToSchema)]
#[schema(as = CorrectorSetting)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Setting")]
pub struct SettingSchema {
    /// Fore-and-aft magnets, a hole each.
    #[schema(required = false)]
    fore_and_aft: Vec<TraySchema>,
    /// Athwartship magnets, a hole each.
    #[schema(required = false)]
    athwartship: Vec<TraySchema>,
    /// Spheres, boxes or plates.
    #[schema(required = false)]
    quadrantal: Option<PairSchema>,
    /// The Flinders bar.
    #[schema(required = false)]
    flinders: Option<BarSchema>,
    /// The vertical magnets.
    #[schema(required = false)]
    heeling: Option<BucketSchema>,
}

/// Magnets in one hole or tray.
#[derive(Serialize, ToSchema)]
#[schema(as = MagnetsInHole)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Tray")]
pub struct TraySchema {
    /// Number of the hole, from the bottom.
    hole: u16,
    /// Their kind.
    #[schema(example = "200 mm")]
    magnet: String,
    /// Number of magnets.
    count: u8,
    /// Direction of their red, north-seeking ends.
    red: RedSchema,
}

/// Direction of a red, north-seeking end.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = RedEnd)]
#[allow(dead_code, reason = "describes binnacle_adjustment::binnacle::Red")]
pub(super) enum RedSchema {
    Forward,
    Aft,
    Starboard,
    Port,
    Up,
    Down,
}

/// A pair of spheres, boxes or plates.
#[derive(Serialize, ToSchema)]
#[schema(as = PairSetting)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::PairSetting"
)]
pub struct PairSchema {
    /// Name of the size.
    #[schema(example = "7 inch")]
    size: String,
    /// Position on the scale, mm.
    mark_mm: f64,
    /// Degrees clockwise from athwartships, seen from above.
    #[schema(required = false)]
    slew_deg: f64,
}

/// A Flinders bar.
#[derive(Serialize, ToSchema)]
#[schema(as = BarSetting)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::BarSetting"
)]
pub struct BarSchema {
    /// Length of all its pieces, mm.
    length_mm: f64,
    /// Before or abaft the card.
    side: SideSchema,
    /// Degrees clockwise from there, seen from above.
    #[schema(required = false)]
    slew_deg: f64,
}

/// Magnets in the bucket.
#[derive(Serialize, ToSchema)]
#[schema(as = HeelingSetting)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::binnacle::HeelingSetting"
)]
pub struct BucketSchema {
    /// Number of its position, from the bottom.
    position: u16,
    /// Number of magnets.
    count: u8,
    /// Direction of their red ends: up or down.
    red: RedSchema,
}
