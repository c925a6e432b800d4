//! Schemas for an OpenAPI document.
//!
//! All types derive theirs; this module corrects them.

use binnacle_compass::openapi::{allow_unknown_properties, remove_defaults, schema_mut};
use utoipa::openapi::OpenApi;

/// Names of the written forms that refuse unknown fields.
const STRICT_FORMS: [&str; 21] = [
    "Binnacle",
    "BinnacleDesign",
    "MagnetKind",
    "MagnetRack",
    "NumberedHeight",
    "QuadrantalBrackets",
    "IronSize",
    "BracketMark",
    "FlindersHolder",
    "HeelingBucket",
    "CorrectorsAboard",
    "MagnetLot",
    "CorrectorSetting",
    "MagnetsInHole",
    "PairSetting",
    "BarSetting",
    "HeelingSetting",
    "BerthReading",
    "SecondReading",
    "ShiftedReading",
    "PlanLimits",
];

/// Corrects the schemas of this crate's types in a document.
///
/// A form that refuses unknown fields today may accept more of them in a later version, so
/// the document does not rule them out. The descriptions of the limits give their defaults.
pub fn correct(document: &mut OpenApi) {
    for name in STRICT_FORMS {
        if let Some(schema) = schema_mut(document, name) {
            allow_unknown_properties(schema);
        }
    }
    if let Some(limits) = schema_mut(document, "PlanLimits") {
        remove_defaults(limits);
    }
}
