//! How the OpenAPI document describes plans; they themselves are the science crate's.

use binnacle_fleet::binnacles::{BarSchema, BucketSchema, PairSchema, SettingSchema, TraySchema};
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

/// What the planner offers.
#[derive(ToSchema)]
#[schema(as = PlanOffer)]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Outcome")]
pub(crate) struct OfferSchema {
    /// What the berth told, and how well each coefficient shows on this heading.
    #[schema(value_type = Option<Object>)]
    berth: Option<Value>,
    /// Empty: a refusal is a problem document.
    #[schema(value_type = Vec<Object>)]
    refusals: Vec<Value>,
    /// What the adjuster should know.
    notes: Vec<String>,
    /// The recommended plan first, then others that cost more or less.
    plans: Vec<PlanSchema>,
    /// How well the search knows that nothing is better.
    optimality: Option<OptimalitySchema>,
}

/// A plan that was chosen.
#[derive(ToSchema)]
#[schema(as = ChosenPlan)]
#[allow(dead_code, reason = "describes Planned")]
pub(crate) struct ChosenPlanSchema {
    /// Which of those that were offered, from 1.
    chosen: usize,
    /// All that were offered, in short.
    offered: Vec<InShortSchema>,
    /// What the adjuster should know.
    notes: Vec<String>,
    /// How well the search knows that nothing is better.
    optimality: Option<OptimalitySchema>,
    /// The plan.
    plan: PlanSchema,
}

/// A plan in short.
#[derive(ToSchema)]
#[schema(as = PlanInShort)]
#[allow(dead_code, reason = "describes InShort")]
struct InShortSchema {
    /// Movements of hand that it takes.
    moves: u32,
    /// Worst foretold residual, weighted over the waters, degrees.
    worst_residual_deg: f64,
    /// The widest 95 % band, degrees.
    widest_band_deg: f64,
}

/// One way to set the correctors.
#[derive(ToSchema)]
#[schema(as = CorrectorPlan)]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Plan")]
pub(crate) struct PlanSchema {
    /// How they will stand.
    setting: SettingSchema,
    /// Movements of hand that it takes.
    moves: u32,
    /// Worst foretold residual on any heading, weighted over the waters, degrees.
    worst_residual_deg: f64,
    /// The widest 95 % band, degrees.
    widest_band_deg: f64,
    /// λ with this setting.
    lambda: f64,
    /// Deviations as they are, at the berth and in the waters.
    before: Vec<TableSchema>,
    /// Residuals as they will be.
    after: Vec<TableSchema>,
    /// What becomes of the heeling magnets.
    heeling: HeelingSchema,
    /// What to do, in order.
    steps: Vec<StepSchema>,
    /// The model that holds from the last step on.
    model_after: binnacle_fleet::models::ModelSchema,
}

/// Deviations foretold at one place.
#[derive(ToSchema)]
#[schema(as = PredictedTable)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::PredictedTable"
)]
struct TableSchema {
    /// `berth`, or the name of a water.
    place: String,
    /// Horizontal field, nT.
    h_nt: f64,
    /// Vertical field, nT, down positive.
    z_nt: f64,
    /// Every 15° of compass heading; empty where headings are ambiguous.
    rows: Vec<RowSchema>,
    /// The greatest deviation on any heading, degrees.
    #[schema(required)]
    worst_deg: Option<f64>,
    /// The compass heading of that.
    #[schema(required)]
    worst_compass_deg: Option<f64>,
    /// The greatest deviation with its band, degrees.
    #[schema(required)]
    reach_deg: Option<f64>,
    /// The widest band, degrees.
    #[schema(required)]
    widest_band_deg: Option<f64>,
}

/// One compass heading.
#[derive(ToSchema)]
#[schema(as = PredictedRow)]
#[allow(
    dead_code,
    clippy::struct_field_names,
    reason = "describes binnacle_adjustment::adjust::PredictedRow"
)]
struct RowSchema {
    compass_deg: f64,
    /// East positive.
    deviation_deg: f64,
    #[schema(required)]
    band95_deg: Option<f64>,
}

/// One movement, to be checked on the spot.
#[derive(ToSchema)]
#[schema(as = PlanStep)]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Step")]
pub(crate) struct StepSchema {
    /// From 1.
    number: u32,
    /// What is moved.
    corrector: CorrectorSchema,
    /// What is done with it.
    action: ActionSchema,
    /// Where it was; none when it comes in.
    #[schema(required)]
    from: Option<PlaceSchema>,
    /// Where it will be; none when it comes out.
    #[schema(required)]
    to: Option<PlaceSchema>,
    /// All of it in a sentence.
    words: String,
    /// What to see to before.
    #[schema(required)]
    check: Option<String>,
    /// What the compass will then read at the berth, degrees.
    expected_compass_deg: f64,
    /// By how much it will have turned, degrees, clockwise positive.
    change_deg: f64,
    /// How far off it may be, degrees.
    tolerance_deg: f64,
    /// Whether on this heading the compass shows the step at all.
    seen: bool,
    /// How the correctors stood before.
    setting_before: SettingSchema,
    /// How they stand then.
    setting_after: SettingSchema,
}

/// What is moved at the binnacle.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = MovedCorrector)]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Corrector")]
enum CorrectorSchema {
    Flinders,
    Quadrantal,
    Heeling,
    ForeAndAft,
    Athwartship,
}

/// What is done with a corrector.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = StepAction)]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Action")]
enum ActionSchema {
    Fit,
    TakeOut,
    Move,
    Change,
}

/// Where a corrector stands.
#[derive(Serialize, ToSchema)]
#[serde(tag = "place", rename_all = "snake_case")]
#[schema(as = CorrectorPlace)]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Place")]
enum PlaceSchema {
    Magnets(TraySchema),
    Pair(PairSchema),
    Bar(BarSchema),
    Bucket(BucketSchema),
}

/// What becomes of the heeling magnets.
#[derive(ToSchema)]
#[schema(as = HeelingPlan)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::HeelingPlan"
)]
struct HeelingSchema {
    /// Degrees of heeling error for each degree of heel on north, at the berth, as it is;
    /// none where the vertical force was not read.
    #[schema(required)]
    before_deg_per_deg: Option<f64>,
    /// The same afterwards.
    #[schema(required)]
    after_deg_per_deg: Option<f64>,
    /// Whether they are left as found for want of a vertical reading.
    left_as_found: bool,
}

/// How well the search knows that nothing is better.
#[derive(ToSchema)]
#[schema(as = PlanOptimality)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::Optimality"
)]
struct OptimalitySchema {
    /// Whether every setting of the catalogue was gone through or excluded.
    proven: bool,
    /// No setting's worst residual is better than the best plan's by more, degrees.
    gap_deg: f64,
    /// Boxes of settings that were looked at.
    nodes: u64,
    /// Most trays or holes of fore-and-aft and athwartship magnets in use at once.
    trays_in_use: [u8; 2],
}

/// What headings at sea say of a prediction.
#[derive(Serialize, ToSchema)]
#[serde(tag = "verdict", rename_all = "snake_case")]
#[schema(as = SeaVerdict)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::Verification"
)]
pub(crate) enum SeaVerdictSchema {
    /// They agree, and are enough.
    Passed {
        /// Headings that counted.
        headings: usize,
        /// The widest 95 % band that is left, degrees.
        band95_deg: f64,
        /// Root mean square of what they are off, degrees.
        rms_deg: f64,
    },
    /// They agree so far.
    MoreNeeded {
        /// Headings that counted.
        headings: usize,
        /// Which others are needed.
        needed: NeededSchema,
    },
    /// One is off by too much.
    Alarm {
        /// Its compass heading, degrees.
        compass_deg: f64,
        /// By how much it is off, degrees.
        off_deg: f64,
        /// The standard error of that, degrees.
        standard_error_deg: f64,
    },
}

/// Headings that are still needed.
#[derive(Serialize, ToSchema)]
#[schema(as = NeededHeadings)]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::NeededHeadings"
)]
pub(crate) struct NeededSchema {
    /// How many.
    count: usize,
    /// Compass headings that would do, degrees, the best first.
    compass_deg: Vec<f64>,
}

/// An entry of an order's log: a line of canonical JSON with its hash.
#[derive(serde::Serialize, ToSchema)]
#[schema(as = WorkOrderEntry)]
pub(crate) struct LineSchema {
    /// Counts from 1.
    pub(crate) seq: i64,
    /// SHA-256 of the line as it stands in the archive, hexadecimal.
    pub(crate) sha256: String,
    /// What happened: `kind`, `at`, `author`, `previous_sha256` and `content`.
    #[schema(value_type = Object)]
    pub(crate) entry: Value,
}

/// A page of an order's log.
#[derive(serde::Serialize, ToSchema)]
#[schema(as = WorkOrderEntryList)]
pub(crate) struct LineList {
    /// In order.
    pub(crate) items: Vec<LineSchema>,
    /// `after` of the next page.
    #[schema(required)]
    pub(crate) next: Option<String>,
}
