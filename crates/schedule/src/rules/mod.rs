//! The rules for adjusting compasses: data, each with its source.
//!
//! Invariants of a [`Rule`]: its numbers are positive and in a credible range,
//! its flags are two capital letters, and a transit's rule names the canal.
//! [`built_in_rules()`] returns the rules of `data/rules.json`, which tests read
//! completely.

mod built_in;
mod display;

pub use built_in::built_in_rules;

use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// One requirement, with its scope and source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rule {
    /// Id that stays when the text changes.
    pub id: String,
    /// Scope of the rule.
    pub applies: Applies,
    /// Requirement.
    pub requires: Requirement,
    /// First day on which it applies; none where the source gives none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_from: Option<NaiveDate>,
    /// Source.
    pub citation: Citation,
}

/// Scope of a rule: every given condition must hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Applies {
    /// Flags of the ships; empty for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flags: Vec<Flag>,
    /// Trades of the ships; empty for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trades: Vec<Trade>,
    /// Least gross tonnage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_gross_tonnage: Option<u32>,
    /// State of the record of observed deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation_record: Option<DeviationRecord>,
    /// Canal that the ships transit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub canal: Option<Canal>,
}

/// Requirement of a rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Requirement {
    /// An adjustment within this interval.
    Interval {
        /// Months.
        months: Months,
    },
    /// An adjustment after each of these events.
    AfterEvent {
        /// The events.
        events: Vec<EventKind>,
    },
    /// An adjustment when the deviation on any heading exceeds this limit.
    Deviation {
        /// Degrees, either way.
        adjust_above_deg: Limit,
    },
    /// At a transit: a table no older than this, and deviation below a limit.
    Transit {
        /// Months.
        table_within_months: Months,
        /// Degrees, either way; a deviation of exactly this is too much.
        below_deg: Limit,
    },
}

/// Source of a rule, and how it was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Citation {
    /// Issuer and name.
    pub document: String,
    /// Section in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<String>,
    /// First-hand or second-hand reading.
    pub read: Provenance,
}

/// The project's reading of a rule's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Provenance {
    /// The document itself was read, from its issuer.
    FirstHand,
    /// A copy elsewhere was read, or a document that quotes it.
    SecondHand,
}

/// A flag state by ISO 3166: two capital letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Flag([u8; 2]);

/// A ship's trade.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the words say it")]
pub enum Trade {
    Bulk,
    Container,
    Tanker,
    GeneralCargo,
    RoRo,
    Passenger,
    Fishing,
    Offshore,
    Other,
}

/// State of the compass deviation book.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = DeviationRecordKept))]
#[serde(rename_all = "snake_case")]
pub enum DeviationRecord {
    /// Kept as required.
    Kept,
    /// Not kept, or with gaps.
    NotKept,
}

/// A canal with a compass rule of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Canal {
    /// Panama.
    Panama,
}

/// An event of a ship or compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The compass was installed or replaced.
    Installation,
    /// The ship was docked.
    DryDocking,
    /// Steel near the compass or elsewhere was cut, welded or built in.
    StructuralChange,
    /// Electrical equipment near the compass was added, moved or removed.
    ElectricalChange,
}

/// A number of months, from one month to ten years.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct Months(u32);

/// A deviation above zero and up to 90°.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Limit(f64);

/// The reason why a value cannot be part of a rule.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RuleError {
    /// A flag that is not two letters.
    #[error("{0:?} is not a flag of two capital letters, as PA")]
    Flag(String),
    /// Months out of range.
    #[error("{0} months are not within 1 to 120")]
    Months(u32),
    /// A limit out of range.
    #[error("{0}° is not above 0 and up to 90")]
    Limit(f64),
}

impl Flag {
    /// Returns the two letters.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
    pub fn letters(&self) -> &str {
        std::str::from_utf8(&self.0).expect("capital letters are ASCII")
    }
}

impl TryFrom<String> for Flag {
    type Error = RuleError;
    fn try_from(text: String) -> Result<Flag, RuleError> {
        match text.as_bytes() {
            &[first @ b'A'..=b'Z', second @ b'A'..=b'Z'] => Ok(Flag([first, second])),
            _ => Err(RuleError::Flag(text)),
        }
    }
}

impl From<Flag> for String {
    fn from(flag: Flag) -> String {
        flag.letters().to_owned()
    }
}

impl Months {
    /// Returns the number of months.
    pub fn get(self) -> u32 {
        self.0
    }

    /// Returns the same day that many months later, or the last day of a
    /// shorter month.
    pub fn after(self, day: NaiveDate) -> NaiveDate {
        day.checked_add_months(chrono::Months::new(self.0))
            .unwrap_or(NaiveDate::MAX)
    }
}

impl TryFrom<u32> for Months {
    type Error = RuleError;
    fn try_from(months: u32) -> Result<Months, RuleError> {
        let valid = (1..=120).contains(&months);
        valid
            .then_some(Months(months))
            .ok_or(RuleError::Months(months))
    }
}

impl From<Months> for u32 {
    fn from(months: Months) -> u32 {
        months.0
    }
}

impl Limit {
    /// Degrees.
    pub fn degrees(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Limit {
    type Error = RuleError;
    fn try_from(degrees: f64) -> Result<Limit, RuleError> {
        let valid = degrees > 0.0 && degrees <= 90.0;
        valid
            .then_some(Limit(degrees))
            .ok_or(RuleError::Limit(degrees))
    }
}

impl From<Limit> for f64 {
    fn from(limit: Limit) -> f64 {
        limit.0
    }
}
