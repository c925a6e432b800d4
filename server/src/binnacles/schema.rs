//! How the OpenAPI document describes binnacles; they themselves are the science
//! crate's, and docs/binnacle.md says what each field means.

use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

/// A binnacle on board; docs/binnacle.md has every field.
#[derive(ToSchema)]
#[schema(as = Binnacle)]
#[allow(
    dead_code,
    reason = "describes binnacle_magnetics::binnacle::BinnacleForm"
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
    /// How they stand now.
    setting: SettingSchema,
    /// What was measured of them; it wins over the formulas.
    #[schema(required = false, value_type = Vec<Object>)]
    calibration: Vec<Value>,
}

/// A maker's design; docs/binnacle.md has every field.
#[derive(ToSchema)]
#[schema(as = BinnacleDesign)]
#[allow(
    dead_code,
    reason = "describes binnacle_magnetics::binnacle::DesignForm"
)]
pub(super) struct DesignSchema {
    /// Of this form: 1.
    version: u32,
    /// Who makes it.
    maker: String,
    /// What the maker calls it.
    model: String,
    /// Where its figures come from.
    provenance: String,
    /// `class_a`, `class_b` or `other`.
    compass: String,
    /// Magnetic moment of the needles, A·m².
    needle_moment_am2: f64,
    /// Kinds of magnets that fit somewhere in it.
    #[schema(value_type = Vec<Object>)]
    magnets: Vec<Value>,
    /// Trays or holes of the fore-and-aft magnets.
    #[schema(value_type = Object)]
    fore_and_aft: Value,
    /// Trays or holes of the athwartship magnets.
    #[schema(value_type = Object)]
    athwartship: Value,
    /// Spheres, boxes or plates.
    #[schema(value_type = Option<Object>)]
    quadrantal: Option<Value>,
    /// Holder of the Flinders bar.
    #[schema(value_type = Option<Object>)]
    flinders: Option<Value>,
    /// Bucket of the vertical magnets.
    #[schema(value_type = Option<Object>)]
    heeling: Option<Value>,
}

/// Correctors on board, those in use included.
#[derive(ToSchema)]
#[schema(as = CorrectorsAboard)]
#[allow(dead_code, reason = "describes binnacle_magnetics::binnacle::Aboard")]
struct AboardSchema {
    /// Magnets by their kind: `magnet`, `count`, `tested_moment_am2`, `tested_sd`.
    #[schema(value_type = Vec<Object>)]
    magnets: Vec<Value>,
    /// Sizes of which there is a pair.
    #[schema(required = false)]
    quadrantal: Vec<String>,
    /// Lengths of the Flinders bar's pieces, mm.
    #[schema(required = false)]
    flinders_pieces_mm: Vec<f64>,
}

/// How every corrector stands; an empty list or null is none.
#[derive(ToSchema)]
#[schema(as = CorrectorSetting)]
#[allow(dead_code, reason = "describes binnacle_magnetics::binnacle::Setting")]
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
#[derive(ToSchema)]
#[schema(as = MagnetsInHole)]
#[allow(dead_code, reason = "describes binnacle_magnetics::binnacle::Tray")]
struct TraySchema {
    /// Number of the hole, from the bottom.
    hole: u16,
    /// Their kind.
    #[schema(example = "200 mm")]
    magnet: String,
    /// How many.
    count: u8,
    /// Where their red, north-seeking ends point.
    red: RedSchema,
}

/// Where a red, north-seeking end points.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = RedEnd)]
#[allow(dead_code, reason = "describes binnacle_magnetics::binnacle::Red")]
enum RedSchema {
    Forward,
    Aft,
    Starboard,
    Port,
    Up,
    Down,
}

/// A pair of spheres, boxes or plates.
#[derive(ToSchema)]
#[schema(as = PairSetting)]
#[allow(
    dead_code,
    reason = "describes binnacle_magnetics::binnacle::PairSetting"
)]
struct PairSchema {
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
#[derive(ToSchema)]
#[schema(as = BarSetting)]
#[allow(
    dead_code,
    reason = "describes binnacle_magnetics::binnacle::BarSetting"
)]
struct BarSchema {
    /// Length of all its pieces, mm.
    length_mm: f64,
    /// `forward` or `aft` of the card.
    side: String,
    /// Degrees clockwise from there, seen from above.
    #[schema(required = false)]
    slew_deg: f64,
}

/// Magnets in the bucket.
#[derive(ToSchema)]
#[schema(as = HeelingSetting)]
#[allow(
    dead_code,
    reason = "describes binnacle_magnetics::binnacle::HeelingSetting"
)]
struct BucketSchema {
    /// Number of its position, from the bottom.
    position: u16,
    /// How many magnets.
    count: u8,
    /// Where their red ends point: up or down.
    red: RedSchema,
}
