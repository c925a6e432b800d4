//! What a deviation card says; its form as JSON.

use crate::binnacles::SettingSchema;
use crate::compasses::Compass;
use crate::deviation::{HandbookSchema, Row, Worst};
use crate::ids::{ModelId, VesselId};
use crate::streams::CardWithdrawnSchema;
use crate::time::Time;
use binnacle_magnetics::binnacle::{Setting, Shape};
use binnacle_magnetics::handbook::Handbook;
use binnacle_wire::messages::CardWithdrawn;
use serde::Serialize;
use utoipa::ToSchema;

/// What every card says of itself.
pub(super) const STATEMENT: &str = "Predicted from observations under way by a model of the \
     ship's magnetism. Not a certificate of adjustment: no adjuster has signed it.";

/// A deviation card of one compass, at a place and a date.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = DeviationCard)]
pub struct Card {
    /// What the card is worth.
    pub status: Status,
    /// The same in words, to stand wherever figures of the card stand.
    pub statement: &'static str,
    /// The ship.
    pub vessel: Ship,
    /// The compass: each magnetic element has a card of its own.
    pub compass: Compass,
    /// Where and when it holds.
    pub place: Place,
    /// By compass heading from 0, each 15°.
    pub rows: Vec<CardRow>,
    /// The heading with the greatest deviation.
    pub worst: Worst,
    /// Half the 95 % band where it is widest, degrees.
    #[schema(example = 0.8)]
    pub widest_band95_deg: f64,
    /// The coefficients there.
    pub coefficients: Coefficients,
    /// Why no card from before the model's epoch holds; none where there was no change.
    #[schema(required, value_type = Option<CardWithdrawnSchema>)]
    pub replaces: Option<CardWithdrawn>,
    /// The binnacle's correctors as they were last recorded; none where nobody recorded
    /// them.
    #[schema(required)]
    pub correctors: Option<Correctors>,
    /// Magnetic cargo on board at that date, by the logbook.
    pub cargo: Vec<CargoAboard>,
    /// The last degaussing or deperming in the logbook.
    #[schema(required)]
    pub degaussed_at: Option<Time>,
    /// The last adjustment in the logbook.
    #[schema(required)]
    pub adjusted_at: Option<Time>,
    /// What belongs on a card and is not recorded here: a person must write it.
    pub not_recorded: Vec<NotRecorded>,
    /// The model that says so.
    pub model: Source,
    /// What the reader must know, a sentence each; the most pressing first.
    pub notes: Vec<String>,
    /// Each 5°, for the curve.
    #[serde(skip)]
    pub curve: Vec<Row>,
}

/// What a card is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CardStatus)]
pub enum Status {
    /// By the model alone.
    Predicted,
}

/// The ship that a card is of.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = CardVessel)]
pub struct Ship {
    /// The vessel's id.
    pub id: VesselId,
    /// Her name.
    #[schema(example = "Nao Victoria")]
    pub name: String,
    /// Her IMO number.
    #[schema(required, example = "9074729")]
    pub imo_number: Option<String>,
    /// Her call sign.
    #[schema(required, example = "EAVN")]
    pub call_sign: Option<String>,
    /// Her flag state.
    #[schema(required, example = "Spain")]
    pub flag: Option<String>,
}

/// Where and when a card holds, and the earth's field there.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = CardPlace)]
pub struct Place {
    /// Degrees north.
    #[schema(example = 43.4)]
    pub lat: f64,
    /// Degrees east.
    #[schema(example = -3.1)]
    pub lon: f64,
    /// When.
    pub at: Time,
    /// Variation, degrees, east positive.
    #[schema(example = 0.4)]
    pub variation_deg: f64,
    /// The model of the earth's field that says so.
    #[schema(example = "igrf14")]
    pub variation_source: String,
    /// Horizontal field, nT.
    #[schema(example = 24_300.0)]
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    #[schema(example = 39_600.0)]
    pub z_nt: f64,
}

/// A line of a card.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = CardRow)]
pub struct CardRow {
    /// Compass heading.
    #[schema(example = 15.0)]
    pub compass_deg: f64,
    /// The magnetic heading then.
    #[schema(example = 17.3)]
    pub magnetic_deg: f64,
    /// The deviation that remains, degrees, east positive.
    #[schema(example = 2.3)]
    pub deviation_deg: f64,
    /// Half the width of its 95 % band, degrees.
    #[schema(example = 0.6)]
    pub band95_deg: f64,
    /// Samples within 7½° of the heading that the model rests on.
    #[schema(example = 41)]
    pub samples: u64,
    /// Their mean of observed less predicted deviation, degrees; none without samples.
    #[schema(required, example = -0.1)]
    pub residual_deg: Option<f64>,
}

/// Coefficients at a card's place, degrees.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[schema(as = CardCoefficients)]
pub struct Coefficients {
    /// The exact ones, × 57.3.
    #[schema(value_type = HandbookSchema)]
    pub exact: Handbook,
    /// What the model adds on every heading: alignment, reference and variation
    /// offsets. The handbook's A includes it.
    #[schema(example = 0.2)]
    pub constant_deg: f64,
    /// What an adjuster would find who swung the ship.
    #[schema(value_type = HandbookSchema)]
    pub handbook: Handbook,
}

/// How a binnacle's correctors stand.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = CardCorrectors)]
pub struct Correctors {
    /// The revision of the binnacle that says so.
    #[schema(example = 3)]
    pub revision: i64,
    /// When it was written.
    pub at: Time,
    /// The binnacle: maker, model and serial number.
    #[schema(example = "Cassens & Plath type 11, no. 2047")]
    pub binnacle: String,
    /// How each of them stands.
    #[schema(value_type = SettingSchema)]
    pub setting: Setting,
    /// What the quadrantal correctors are.
    #[serde(skip)]
    pub shape: Option<Shape>,
}

/// Magnetic cargo on board.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct CargoAboard {
    /// Since when.
    pub since: Time,
    /// What it is: `steel`, `scrap`, `containers` or `other`; none where the logbook does
    /// not say.
    #[schema(required, example = "steel")]
    pub cargo: Option<String>,
}

/// What belongs on a card and nobody has recorded here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CardNotRecorded)]
pub enum NotRecorded {
    /// Where magnets, spheres and Flinders bar are.
    Correctors,
    /// How the degaussing coils are set.
    DegaussingCoils,
    /// The adjuster, with licence, firm and signature.
    Adjuster,
    /// When the compass is due to be adjusted next.
    NextDue,
}

/// The model that a card is made from.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = CardModel)]
pub struct Source {
    /// The model version's id.
    pub id: ModelId,
    /// Counts the compass's models from 1.
    #[schema(example = 12)]
    pub version: i64,
    /// When it was fitted.
    pub fitted_at: Time,
    /// The time of the first sample in it.
    pub data_from: Time,
    /// The time of the last sample in it.
    pub data_until: Time,
    /// Samples that carried weight.
    #[schema(example = 412)]
    pub samples_used: u64,
    /// Root mean square of the residuals, degrees.
    #[schema(required, example = 0.3)]
    pub rms_deg: Option<f64>,
    /// The estimator that made it.
    #[schema(example = "state-space-9")]
    pub estimator: String,
    /// SHA-256 of everything that it was made from.
    pub input_hash: String,
}
