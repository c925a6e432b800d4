//! Known facts of ships and compasses, and the terms for due dates.

use crate::rules::{Canal, DeviationRecord, EventKind, Flag, Limit, Trade};
use crate::time::Instant;
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// Known facts of a ship that rules ask about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ship {
    /// Flag; when unknown, every flag's rules apply.
    #[serde(default)]
    pub flag: Option<Flag>,
    /// Gross tonnage; when unknown, rules for large ships apply.
    #[serde(default)]
    pub gross_tonnage: Option<u32>,
    /// Trade; when unknown, rules for particular trades apply.
    #[serde(default)]
    pub trade: Option<Trade>,
    /// State of the deviation book; unknown counts as not kept.
    #[serde(default)]
    pub deviation_record: Option<DeviationRecord>,
    /// Planned transits.
    #[serde(default)]
    pub transits: Vec<Transit>,
}

/// A planned transit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CanalTransit))]
#[serde(deny_unknown_fields)]
pub struct Transit {
    /// The canal: `panama`.
    #[cfg_attr(feature = "openapi", schema(value_type = String, example = "panama"))]
    pub canal: Canal,
    /// Day of the transit.
    pub on: NaiveDate,
}

/// Known facts of one compass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compass {
    /// Day of the last adjustment; none where none is on record.
    #[serde(default)]
    pub adjusted_on: Option<NaiveDate>,
    /// Instant of the last adjustment, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjusted_at: Option<Instant>,
    /// Events of ship and compass; those before the last adjustment are
    /// settled.
    #[serde(default)]
    pub events: Vec<Event>,
    /// Worst deviation on any heading, as the model predicts it, day by day.
    /// For a past day, the deviation has been at least this since.
    #[serde(default)]
    pub predicted: Vec<Predicted>,
    /// The operator's limit of deviation on any heading, degrees; none if not
    /// set.
    #[serde(default)]
    pub deviation_limit_deg: Option<Limit>,
    /// A detected change of the ship's magnetism.
    #[serde(default)]
    pub change: Option<Change>,
    /// A verification at sea that the last adjustment failed.
    #[serde(default)]
    pub failed_verification: Option<FailedVerification>,
    /// True while the last adjustment awaits its verification at sea.
    #[serde(default)]
    pub awaits_verification: bool,
}

/// An event.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Kind of event.
    pub kind: EventKind,
    /// Its day, or the day on which it is to end.
    pub on: NaiveDate,
    /// Its instant, if known: it separates events before and after an
    /// adjustment on the same day.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<Instant>,
}

/// A prediction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Predicted {
    /// Day of the prediction.
    pub on: NaiveDate,
    /// Place of the prediction, as it follows "at"; none if not given.
    #[serde(default)]
    pub place: Option<String>,
    /// The largest deviation on any heading, either way.
    pub worst_deviation_deg: f64,
    /// Side of that deviation; none if not given.
    #[serde(default)]
    pub side: Option<Side>,
}

/// Side to which a compass deviates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = DeviationSide))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Compass north lies east of magnetic north.
    East,
    /// Compass north lies west of magnetic north.
    West,
}

impl Side {
    /// Returns the side of a deviation in degrees, positive to the east.
    pub fn from_deviation(deviation_deg: f64) -> Side {
        if deviation_deg < 0.0 {
            Side::West
        } else {
            Side::East
        }
    }
}

/// A change of magnetism.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Day of the change.
    pub on: NaiveDate,
    /// Change of the deviation on the worst heading.
    pub size_deg: f64,
}

/// A failed verification.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FailedVerification {
    /// Day of the verification.
    pub on: NaiveDate,
    /// Error of the card on the worst heading, by headings at sea.
    pub worst_error_deg: f64,
}

/// The product's own terms, where a rule says "must" without a date.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Terms {
    /// Days from an event, a change or a failed verification to the due date.
    pub after_event_days: u32,
    /// Days from the day on which deviation exceeds its limit.
    pub over_limit_days: u32,
    /// Days to the due date below which a need is urgent.
    pub urgent_days: u32,
    /// Days to the due date below which a need is due soon.
    pub soon_days: u32,
    /// The smallest change that counts, hundredths of a degree.
    pub change_centideg: u32,
}

impl Default for Terms {
    fn default() -> Terms {
        Terms {
            after_event_days: 30,
            over_limit_days: 14,
            urgent_days: 14,
            soon_days: 60,
            change_centideg: 200,
        }
    }
}
