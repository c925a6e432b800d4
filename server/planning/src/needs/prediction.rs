//! Deviation predicted at a place for a day.

use binnacle_schedule::needs::Side;
use chrono::NaiveDate;
use serde::Serialize;
use utoipa::ToSchema;

/// Greatest deviation predicted at a place for a day.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = DeviationAhead)]
pub struct PredictedDeviation {
    /// The day.
    pub on: NaiveDate,
    /// The place: `here`, a port's name, or a canal's.
    #[schema(example = "Rotterdam")]
    pub place: String,
    /// Largest size of the deviation on any heading, degrees.
    pub worst_deviation_deg: f64,
    /// Direction of the deviation.
    pub side: Side,
}
