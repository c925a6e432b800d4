//! The rules that say when a compass must be adjusted: data, each with its source.
//!
//! What always holds: a [`Rule`] is one that can be applied: its numbers are positive
//! and within reason, its flags are two capital letters, and a transit's rule names the
//! canal. [`shipped()`] are those of `data/rules.json`, which tests read whole.

mod shipped;
mod words;

pub use shipped::shipped;

use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// One requirement, whom it binds, and where it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rule {
    /// A name that stays when the words change.
    pub id: String,
    /// Whom it binds.
    pub applies: Applies,
    /// What it asks for.
    pub requires: Requirement,
    /// The first day on which it holds; none where the source gives none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_from: Option<NaiveDate>,
    /// Where it is written.
    pub citation: Citation,
}

/// Whom a rule binds: every condition that is given must hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Applies {
    /// Ships of these flags; of all, where it is empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flags: Vec<Flag>,
    /// Ships of these trades; of all, where it is empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trades: Vec<Trade>,
    /// Ships of so much gross tonnage or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_gross_tonnage: Option<u32>,
    /// Ships whose record of observed deviations is, or is not, kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation_record: Option<DeviationRecord>,
    /// Ships that transit this canal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub canal: Option<Canal>,
}

/// What a rule asks for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Requirement {
    /// An adjustment no longer ago than this.
    Interval {
        /// Months.
        months: Months,
    },
    /// An adjustment after each of these.
    AfterEvent {
        /// The events.
        events: Vec<EventKind>,
    },
    /// An adjustment when the deviation on any heading is larger than this.
    Deviation {
        /// Degrees, either way.
        adjust_above_deg: Limit,
    },
    /// At a transit: a table no older than this, and deviation below a limit.
    Transit {
        /// Months.
        table_within_months: Months,
        /// Degrees, either way; this much is already too much.
        below_deg: Limit,
    },
}

/// Where a rule is written, and whether it was read there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Citation {
    /// Issuer and name.
    pub document: String,
    /// Where in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<String>,
    /// How the project knows it.
    pub read: Read,
}

/// How the project knows a rule's words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Read {
    /// The document itself was read, from its issuer.
    FirstHand,
    /// A copy elsewhere was read, or a document that tells of it.
    SecondHand,
}

/// A state, as ISO 3166 writes it: two capital letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Flag([u8; 2]);

/// What a ship carries for her living.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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

/// Whether the compass deviation book is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviationRecord {
    /// As it should be.
    Kept,
    /// Not, or with gaps.
    NotKept,
}

/// A canal with a compass rule of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Canal {
    /// Panama.
    Panama,
}

/// What may befall a ship or her compass.
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

/// One month to ten years.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct Months(u32);

/// A deviation above zero and up to 90°.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Limit(f64);

/// Why something is not what a rule is made of.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RuleError {
    /// A flag that is not two letters.
    #[error("{0:?} is not a flag of two capital letters, as PA")]
    Flag(String),
    /// Months out of reason.
    #[error("{0} months are not within 1 to 120")]
    Months(u32),
    /// A limit out of reason.
    #[error("{0}° is not above 0 and up to 90")]
    Limit(f64),
}

impl Flag {
    /// The two letters.
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
    /// How many.
    pub fn get(self) -> u32 {
        self.0
    }

    /// The same day so many months later, or the last day of a shorter month.
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
