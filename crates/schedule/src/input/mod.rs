//! The input of a schedule, as JSON.
//!
//! Invariants of a [`Checked`] input: it is not too large, and it is
//! consistent. Names are unique, references resolve, a ship's calls do not
//! overlap and are not over, and every firm has working days. Faults are
//! reported with their JSON path.

mod check;
mod error;
mod firm;
mod firm_check;
mod read;
mod team;
mod travel;
mod weights;

pub use check::check_size;
pub use error::InputError;
pub use firm::{Firm, ServedPort, Taken, TakenHours};
pub use firm_check::{FirmError, check_firm};
pub use read::read;
pub use team::{Team, Teams};
pub(crate) use travel::BERTH_H;
pub use travel::{TravelTime, usual_hours};
pub use weights::{JOB_H, Weights};

use crate::calls::PortCall;
use crate::needs::{Compass, Ship, Terms, Transit, Urgency};
use crate::rules::{DeviationRecord, Flag, Trade};
use crate::time::Instant;
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};

/// The whole input of a schedule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Instant of the plan.
    pub now: Instant,
    /// Days ahead to plan for; a compass that is due later is left out.
    #[serde(default = "horizon")]
    pub horizon_days: u32,
    /// The ships.
    pub vessels: Vec<Vessel>,
    /// Compasses with known due dates.
    #[serde(default)]
    pub needs: Vec<Need>,
    /// Compasses whose due dates follow from the rules.
    #[serde(default)]
    pub compasses: Vec<CompassFacts>,
    /// The ships' calls.
    pub port_calls: Vec<PortCall>,
    /// The firms.
    pub firms: Vec<Firm>,
    /// Jobs of the previous plan, with their progress.
    #[serde(default)]
    pub former: Vec<FormerJob>,
    /// Refusals by firms.
    #[serde(default)]
    pub declined: Vec<Declined>,
    /// Cost weights of the schedule.
    #[serde(default)]
    pub weights: Weights,
    /// Terms that set due dates where rules give none.
    #[serde(default)]
    pub terms: Terms,
}

fn horizon() -> u32 {
    180
}

/// A ship; [`Ship`] explains the facts that rules ask about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vessel {
    /// Id in this file.
    pub id: String,
    /// Name for people.
    #[serde(default)]
    pub name: Option<String>,
    /// Licence that the operator requires of an adjuster.
    #[serde(default)]
    pub licence: Option<String>,
    /// Flag; when unknown, every flag's rules apply.
    #[serde(default)]
    pub flag: Option<Flag>,
    /// Gross tonnage.
    #[serde(default)]
    pub gross_tonnage: Option<u32>,
    /// Trade.
    #[serde(default)]
    pub trade: Option<Trade>,
    /// State of the deviation book.
    #[serde(default)]
    pub deviation_record: Option<DeviationRecord>,
    /// Planned transits.
    #[serde(default)]
    pub transits: Vec<Transit>,
}

impl Vessel {
    /// Returns the name for people.
    pub fn display_name(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.id)
    }

    /// Returns the flag as text.
    pub(crate) fn describe_flag(&self) -> String {
        match self.flag {
            Some(flag) => format!("flag {}", flag.letters()),
            None => "a flag that is not known".to_owned(),
        }
    }

    /// Returns the facts that rules ask about.
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
    /// Id in this file: a compass has one need at a time.
    pub id: String,
    /// The ship.
    pub vessel: String,
    /// The last day on which it may be adjusted.
    pub due: NaiveDate,
    /// Urgency; follows from the due date, if absent.
    #[serde(default)]
    pub urgency: Option<Urgency>,
    /// Reason why it is due.
    #[serde(default)]
    pub reason: Option<String>,
}

/// A compass and the known facts about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompassFacts {
    /// Id in this file, different from that of any need.
    pub id: String,
    /// The ship.
    pub vessel: String,
    /// The facts that rules ask about.
    pub facts: Compass,
}

/// A job of the previous plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormerJob {
    /// The needs that it meets.
    pub needs: Vec<String>,
    /// The call.
    pub call: String,
    /// The firm.
    pub firm: String,
    /// The day.
    pub day: NaiveDate,
    /// The hour at which it was to begin; any hour of the day, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Instant>,
    /// The hour at which it was to end; `job_h` after the beginning, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<Instant>,
    /// The team, where the firm's teams have names; any, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<String>,
    /// Progress of the job.
    pub state: JobState,
}

/// Progress of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlannedJobState))]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Planned; no firm has been asked.
    Proposed,
    /// Offered to the firm.
    Offered,
    /// Accepted by the firm.
    Confirmed,
}

/// A refusal by a firm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Declined {
    /// The need.
    pub need: String,
    /// The firm.
    pub firm: String,
    /// The day; any day, if absent.
    #[serde(default)]
    pub day: Option<NaiveDate>,
    /// The call; any call, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub call: Option<String>,
}

/// A consistent input.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked(Input);

impl Checked {
    /// Returns the input.
    pub fn get(&self) -> &Input {
        &self.0
    }
}
