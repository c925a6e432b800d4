//! Contents of a deviation card, and their JSON.
//!
//! Invariant: a card is predicted until headings at sea have verified the adjustment that its model
//! comes from. It is never a certificate.

use binnacle_adjustment::binnacle::{Setting, Shape};
use binnacle_compass::deviation::CoefficientsInDegrees;
use binnacle_fleet::compasses::Compass;
use binnacle_fleet::deviation::{DeviationRow, WorstHeading};
use binnacle_platform::ids::{ModelId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::messages::CardWithdrawn;
use serde::Serialize;
use utoipa::ToSchema;

/// Returns the statement of a card whose prediction no headings at sea have verified.
pub(super) fn predicted_at_berth(adjusted_at: Time, order: OrderId) -> String {
    format!(
        "Predicted from the adjustment at the berth on {} by work order {order}. Not yet \
         verified by headings at sea. Not a certificate of adjustment: no adjuster has signed it.",
        adjusted_at.day()
    )
}

/// Statement of a predicted card.
pub(super) const PREDICTED: &str = "Predicted from observations under way by a model of the \
     ship's magnetism. Not a certificate of adjustment: no adjuster has signed it.";

/// Returns the statement of a verified card: its verification, and that it is no certificate.
pub(super) fn verified(by: &CardVerification) -> String {
    format!(
        "Verified at sea: {} headings up to {} agree to {:.1} degrees with the prediction of the \
         adjustment on {} by work order {}. Not a certificate of adjustment: no adjuster has \
         signed it.",
        by.headings,
        by.until.to_the_minute(),
        by.rms_deg,
        by.adjusted_at.day(),
        by.order
    )
}

/// A deviation card of one compass, at a place and a date.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = DeviationCard)]
pub struct Card {
    /// CardStatus of the card.
    pub status: CardStatus,
    /// The status in words, to accompany figures of the card wherever they are shown.
    pub statement: String,
    /// Its verification; none for a predicted card.
    #[schema(required)]
    pub verified: Option<CardVerification>,
    /// The work order whose adjustment at the berth the model comes from, while headings at
    /// sea have not verified it.
    #[schema(required)]
    pub unverified_order: Option<OrderId>,
    /// The ship.
    pub vessel: CardVessel,
    /// The compass: each magnetic element has a card of its own.
    pub compass: Compass,
    /// CardPlace and time at which it holds.
    pub place: CardPlace,
    /// By compass heading from 0, each 15°.
    pub rows: Vec<CardRow>,
    /// The heading with the greatest deviation.
    pub worst: WorstHeading,
    /// Half the 95 % band where it is widest, degrees.
    #[schema(example = 0.8)]
    pub widest_band95_deg: f64,
    /// The coefficients there.
    pub coefficients: CardCoefficients,
    /// Change that withdrew cards from before the model's epoch; none where there was no change.
    #[schema(required)]
    pub replaces: Option<CardWithdrawn>,
    /// The binnacle's correctors as they were last recorded; none where nobody recorded
    /// them.
    #[schema(required)]
    pub correctors: Option<CardCorrectors>,
    /// Magnetic cargo on board at that date, by the logbook.
    pub cargo: Vec<MagneticCargo>,
    /// State of the degaussing coils, as recorded of the vessel.
    #[schema(required, example = "no coils fitted")]
    pub degaussing: Option<String>,
    /// The last degaussing or deperming in the logbook.
    #[schema(required)]
    pub degaussed_at: Option<Time>,
    /// The last adjustment in the logbook.
    #[schema(required)]
    pub adjusted_at: Option<Time>,
    /// Adjuster of that adjustment, by the work order; none where no work order covers it.
    #[schema(required)]
    pub adjusted_by: Option<CardAdjuster>,
    /// Due date of the next adjustment. None where no adjustment is on record, or where headings at
    /// sea have not verified the last.
    #[schema(required)]
    pub next_due: Option<CardNextDue>,
    /// Items that belong on a card and are not recorded here: a person must write them.
    pub not_recorded: Vec<CardNotRecorded>,
    /// The model behind it.
    pub model: CardModel,
    /// Notes for the reader, a sentence each; the most pressing first.
    pub notes: Vec<String>,
    /// Code by which anyone who holds the card can check it: `GET /card-checks/{code}`.
    pub check_code: String,
    /// Address of the page that does so, which the sheet has as a QR code; none where the server's
    /// public address is not configured.
    #[schema(required, example = "https://binnacle.example.com/check/AXk…")]
    pub check_url: Option<String>,
    /// Each 5°, for the curve.
    #[serde(skip)]
    pub curve: Vec<DeviationRow>,
}

/// CardStatus of a card.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CardStatus {
    /// By the model alone.
    Predicted,
    /// Headings at sea agree with the prediction of the adjustment.
    Verified,
}

/// Verification of a card at sea.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct CardVerification {
    /// The work order whose adjustment was verified.
    pub order: OrderId,
    /// Time of the adjustment.
    pub adjusted_at: Time,
    /// Time at which the headings were enough.
    pub verified_at: Time,
    /// Headings that counted, 15° or more apart.
    #[schema(example = 9)]
    pub headings: usize,
    /// Samples on them.
    #[schema(example = 131)]
    pub samples: usize,
    /// The time of the last of these.
    pub until: Time,
    /// Root mean square of the headings' differences from the prediction, degrees.
    #[schema(example = 0.4)]
    pub rms_deg: f64,
}

impl CardStatus {
    /// Returns the status in a word, as in JSON.
    pub fn word(self) -> &'static str {
        match self {
            CardStatus::Predicted => "predicted",
            CardStatus::Verified => "verified",
        }
    }
}

/// The ship that a card is of.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CardVessel {
    /// The vessel's id.
    pub id: VesselId,
    /// Its name.
    #[schema(example = "Nao Victoria")]
    pub name: String,
    /// Its IMO number.
    #[schema(required, example = "9074729")]
    pub imo_number: Option<String>,
    /// Its call sign.
    #[schema(required, example = "EAVN")]
    pub call_sign: Option<String>,
    /// Its flag state.
    #[schema(required, example = "Spain")]
    pub flag: Option<String>,
    /// State of its degaussing coils.
    #[serde(skip)]
    pub degaussing: Option<String>,
}

/// CardPlace and time at which a card holds, and the earth's field there.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CardPlace {
    /// Degrees north.
    #[schema(example = 43.4)]
    pub lat: f64,
    /// Degrees east.
    #[schema(example = -3.1)]
    pub lon: f64,
    /// Time.
    pub at: Time,
    /// Variation, degrees, east positive.
    #[schema(example = 0.4)]
    pub variation_deg: f64,
    /// The model of the earth's field behind it.
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
pub struct CardCoefficients {
    /// The exact ones, × 57.3.
    pub exact: CoefficientsInDegrees,
    /// Constant that the model adds on every heading: alignment, reference and variation offsets.
    /// The handbook's A includes it.
    #[schema(example = 0.2)]
    pub constant_deg: f64,
    /// Approximate coefficients, as an adjuster finds them who swings the ship.
    pub handbook: CoefficientsInDegrees,
}

/// Setting of a binnacle's correctors.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CardCorrectors {
    /// The revision of the binnacle behind it.
    #[schema(example = 3)]
    pub revision: i64,
    /// Time of the revision.
    pub at: Time,
    /// The binnacle: maker, model and serial number.
    #[schema(example = "Cassens & Plath type 11, no. 2047")]
    pub binnacle: String,
    /// Setting of each corrector.
    pub setting: Setting,
    /// Shape of the quadrantal correctors.
    #[serde(skip)]
    pub shape: Option<Shape>,
}

/// Magnetic cargo on board.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = CargoAboard)]
pub struct MagneticCargo {
    /// Time from which it is on board.
    pub since: Time,
    /// Its kind: `steel`, `scrap`, `containers` or `other`; none where the logbook does not say.
    #[schema(required, example = "steel")]
    pub cargo: Option<String>,
}

/// Adjuster of a compass, by the record of the work order. The adjuster has signed that record, and
/// no card.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct CardAdjuster {
    /// The work order.
    pub order: OrderId,
    /// The adjuster.
    #[schema(required, example = "M. Etxeberria")]
    pub adjuster: Option<String>,
    /// The number of their licence.
    #[schema(required, example = "ES-CA-114")]
    pub licence: Option<String>,
    /// Their firm.
    #[schema(required, example = "Nervión Compass")]
    pub firm: Option<String>,
}

/// Due date of a compass's next adjustment, by the schedule's rules.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct CardNextDue {
    /// The day.
    #[schema(format = Date, example = "2028-11-21")]
    pub on: String,
    /// Reason, with the rule.
    #[schema(example = "24 months after the adjustment of 2026-11-21 (ISO 25862:2019, Annex G)")]
    pub reason: String,
    /// True if the flag's own rules were applied. They are where the vessel's flag is recorded by
    /// its two letters.
    pub flags_own_rules: bool,
}

/// Item that belongs on a card and is not recorded here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CardNotRecorded {
    /// Positions of magnets, spheres and Flinders bar.
    Correctors,
    /// Setting of the degaussing coils.
    DegaussingCoils,
    /// The adjuster, with licence and firm.
    Adjuster,
    /// An adjuster's signature on the card, which no program makes.
    Signature,
    /// Due date of the next adjustment.
    NextDue,
}

/// The model that a card is made from.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CardModel {
    /// The model version's id.
    pub id: ModelId,
    /// Counts the compass's models from 1.
    #[schema(example = 12)]
    pub version: i64,
    /// Time at which it was fitted or predicted.
    pub fitted_at: Time,
    /// The work order that predicted it; none for a model that was fitted.
    #[schema(required)]
    pub foretold_by: Option<OrderId>,
    /// The time of the first sample in it; for a predicted model, in the model that it was
    /// predicted from.
    pub data_from: Time,
    /// The time of the last of them.
    pub data_until: Time,
    /// Samples that carried weight.
    #[schema(example = 412)]
    pub samples_used: u64,
    /// Root mean square of the residuals, degrees.
    #[schema(required, example = 0.3)]
    pub rms_deg: Option<f64>,
    /// The estimator that made it.
    #[schema(example = "hypotheses-4")]
    pub estimator: String,
    /// SHA-256 of everything that it was made from.
    pub input_hash: String,
}
