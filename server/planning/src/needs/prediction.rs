//! Predicted deviation at a place and on a day.

use binnacle_schedule::needs::Side;
use chrono::NaiveDate;
use serde::Serialize;
use utoipa::ToSchema;

/// The greatest deviation at a place and on a day.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = DeviationAhead)]
pub struct Ahead {
    /// On which day.
    pub on: NaiveDate,
    /// Place: `here`, a port's name, or a canal's.
    #[schema(example = "Rotterdam")]
    pub place: String,
    /// The largest deviation on any heading, either way, degrees.
    pub worst_deviation_deg: f64,
    /// Direction of the deviation.
    pub side: Side,
}
