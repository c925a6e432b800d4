//! What a schedule is made from, as JSON.
//!
//! What always holds: a [`Checked`] input is not too large and hangs together: names are unique and what they
//! refer to is there, calls of a ship do not overlap and are not over, every firm has
//! days on which it works. What is wrong is said with its JSON path.

mod check;
mod firm;
mod read;
mod sound;
mod weights;

pub use check::must_fit;
pub use firm::{Firm, ServedPort, Taken};
pub use read::{InputError, read};
pub use sound::{FirmError, firm_is_sound};
pub use weights::{JOB_H, Weights};

use crate::calls::PortCall;
use crate::needs::{Compass, Ship, Terms, Transit, Urgency};
use crate::rules::{DeviationRecord, Flag, Trade};
use crate::time::Instant;
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// Everything that a schedule is made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// The instant as of which to plan.
    pub now: Instant,
    /// Days ahead to plan for; a compass that is due later is left out.
    #[serde(default = "horizon")]
    pub horizon_days: u32,
    /// The ships.
    pub vessels: Vec<Vessel>,
    /// Compasses of which it is known when they are due.
    #[serde(default)]
    pub needs: Vec<Need>,
    /// Compasses of which it is to be found out.
    #[serde(default)]
    pub compasses: Vec<CompassFacts>,
    /// The ships' calls.
    pub port_calls: Vec<PortCall>,
    /// The firms.
    pub firms: Vec<Firm>,
    /// The jobs of the plan before this one, and how far they got.
    #[serde(default)]
    pub former: Vec<FormerJob>,
    /// Firms that said no.
    #[serde(default)]
    pub declined: Vec<Declined>,
    /// What counts how much.
    #[serde(default)]
    pub weights: Weights,
    /// The terms by which compasses are due.
    #[serde(default)]
    pub terms: Terms,
}

fn horizon() -> u32 {
    180
}

/// A ship; what rules ask about as [`Ship`] has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vessel {
    /// Her name in this file.
    pub id: String,
    /// Her name.
    #[serde(default)]
    pub name: Option<String>,
    /// A licence that her operator asks of an adjuster.
    #[serde(default)]
    pub licence: Option<String>,
    /// Her flag; every flag's rules bind her when it is not known.
    #[serde(default)]
    pub flag: Option<Flag>,
    /// Her gross tonnage.
    #[serde(default)]
    pub gross_tonnage: Option<u32>,
    /// Her trade.
    #[serde(default)]
    pub trade: Option<Trade>,
    /// Whether the deviation book is kept.
    #[serde(default)]
    pub deviation_record: Option<DeviationRecord>,
    /// Transits that are planned.
    #[serde(default)]
    pub transits: Vec<Transit>,
}

impl Vessel {
    /// Her name for people.
    pub fn called(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.id)
    }

    /// Her flag for people.
    pub(crate) fn flag_in_words(&self) -> String {
        match self.flag {
            Some(flag) => format!("flag {}", flag.letters()),
            None => "a flag that is not known".to_owned(),
        }
    }

    /// What rules ask about.
    pub fn ship(&self) -> Ship {
        Ship {
            flag: self.flag,
            gross_tonnage: self.gross_tonnage,
            trade: self.trade,
            deviation_record: self.deviation_record,
            transits: self.transits.clone(),
        }
    }
}

/// A compass that is due.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Need {
    /// Its name in this file: a compass has one need at a time.
    pub id: String,
    /// The ship.
    pub vessel: String,
    /// The last day on which it may be adjusted.
    pub due: NaiveDate,
    /// How much it presses; by the due date, where it is not said.
    #[serde(default)]
    pub urgency: Option<Urgency>,
    /// Why it is due.
    #[serde(default)]
    pub reason: Option<String>,
}

/// A compass, and what is known of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompassFacts {
    /// Its name in this file, unlike that of any need.
    pub id: String,
    /// The ship.
    pub vessel: String,
    /// What rules ask about.
    pub facts: Compass,
}

/// A job of the plan before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormerJob {
    /// The needs that it meets.
    pub needs: Vec<String>,
    /// At which call.
    pub call: String,
    /// By which firm.
    pub firm: String,
    /// On which day.
    pub day: NaiveDate,
    /// How far it got.
    pub state: JobState,
}

/// How far a job got.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Planned, and nobody was asked.
    Proposed,
    /// The firm was asked.
    Offered,
    /// The firm accepted.
    Confirmed,
}

/// A firm's no.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Declined {
    /// To this need.
    pub need: String,
    /// By this firm.
    pub firm: String,
    /// On this day; on any, where none is said.
    #[serde(default)]
    pub day: Option<NaiveDate>,
    /// At this call; at any, where none is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub call: Option<String>,
}

/// An input that hangs together.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked(Input);

impl Checked {
    /// The input.
    pub fn get(&self) -> &Input {
        &self.0
    }
}
