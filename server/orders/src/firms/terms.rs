//! Terms of a firm for an operator: places, times, vessels and fees.
//!
//! Invariants: terms are the operator's own record of the firm, hidden from other operators. Terms
//! without days or ports are stored, and reported as unusable.

use super::store;
use binnacle_platform::db::{DomainEvent, Tx};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::text;
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{self, ServedPort};
use binnacle_schedule::rules::Flag;
use binnacle_schedule::time::Eur;
use chrono::{NaiveDate, Weekday};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Longest list in terms.
const MAX_LIST_LEN: usize = 1000;

/// Change of a firm's terms for an operator.
pub struct TermsChanged {
    /// Operator of the terms.
    pub operator: OperatorId,
    /// Time of the change.
    pub at: Time,
}

impl DomainEvent for TermsChanged {}

/// Terms of a firm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = FirmTerms, example = json!({
    "ports": [{ "port": "NLRTM", "travel_eur": 150 }, { "port": "BEANR", "travel_eur": 400 }],
    "fee_eur": 1800, "extra_compass_eur": 400, "teams": 1, "jobs_a_team_day": 2,
    "working_days": ["Mon", "Tue", "Wed", "Thu", "Fri"], "closed": ["2026-12-25"],
    "first_hour": 8, "last_hour": 18, "lead_time_h": 72, "licences": ["NL-114"],
    "flags": ["PA", "MH", "NL"]
}))]
pub struct Terms {
    /// Ports served, UN/LOCODE, with the travel cost of a team's day there.
    #[serde(default)]
    pub ports: Vec<ServedPort>,
    /// Fee for a job, euros.
    #[schema(value_type = f64, minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Eur,
    /// Fee for each further compass on the same job, euros.
    #[serde(default)]
    #[schema(value_type = f64, minimum = 0, maximum = 1_000_000)]
    pub extra_compass_eur: Eur,
    /// Teams for you on a working day, if the firm does not state its own; 1 by default.
    #[serde(default = "default_count")]
    #[schema(maximum = 1000)]
    pub teams: u32,
    /// Most jobs of a team on one day; 1 by default.
    #[serde(default = "default_count")]
    #[schema(minimum = 1, maximum = 20)]
    pub jobs_a_team_day: u32,
    /// Working days of the week, as `Mon`; Monday to Friday by default.
    #[serde(default = "default_working_days")]
    #[schema(value_type = Vec<String>)]
    pub working_days: Vec<Weekday>,
    /// Days without work.
    #[serde(default)]
    pub closed: Vec<NaiveDate>,
    /// Hour at which its day begins, in the port's time; 8 by default.
    #[serde(default = "default_first_hour")]
    #[schema(minimum = 0, maximum = 24)]
    pub first_hour: f64,
    /// Hour at which its day ends; 18 by default.
    #[serde(default = "default_last_hour")]
    #[schema(minimum = 0, maximum = 24)]
    pub last_hour: f64,
    /// Notice before a job, hours.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 8760)]
    pub lead_time_h: f64,
    /// Licences held.
    #[serde(default)]
    pub licences: Vec<String>,
    /// Flags that accept its adjusters, ISO 3166; all, if empty.
    #[serde(default)]
    #[schema(value_type = Vec<String>)]
    pub flags: Vec<Flag>,
}

fn default_count() -> u32 {
    1
}

fn default_working_days() -> Vec<Weekday> {
    use Weekday::{Fri, Mon, Thu, Tue, Wed};
    vec![Mon, Tue, Wed, Thu, Fri]
}

fn default_first_hour() -> f64 {
    8.0
}

fn default_last_hour() -> f64 {
    18.0
}

/// Returns the terms of a firm for an operator, if any.
pub async fn find_terms(tx: &mut Tx, operator: OperatorId, firm: FirmId) -> Result<Option<Terms>> {
    let stored = store::list_terms(tx, firm).await?;
    let stored = stored.into_iter().find(|(whose, _)| *whose == operator);
    let terms = stored.map(|(_, text)| serde_json::from_str(&text));
    Ok(terms.transpose()?)
}

impl Terms {
    /// Validates the terms.
    pub(super) fn checked(mut self) -> Result<Terms> {
        let lengths = [
            ("ports", self.ports.len()),
            ("closed", self.closed.len()),
            ("licences", self.licences.len()),
            ("flags", self.flags.len()),
        ];
        if let Some((field, length)) = lengths
            .into_iter()
            .find(|(_, length)| *length > MAX_LIST_LEN)
        {
            return Err(Error::Invalid {
                field,
                detail: format!("has {length} entries, more than {MAX_LIST_LEN}"),
            });
        }
        for licence in &mut self.licences {
            *licence = text("licences", licence)?;
        }
        match input::check_firm(&self.firm("", None)) {
            // Unusable terms are reported, not refused.
            Ok(()) | Err(input::FirmError { idle: true, .. }) => Ok(self),
            Err(error) => Err(Error::Invalid {
                field: error.field,
                detail: error.detail,
            }),
        }
    }

    /// Terms with the usual hours and no fee.
    pub(super) fn usual(ports: Vec<ServedPort>) -> Terms {
        Terms {
            ports,
            fee_eur: Eur::default(),
            extra_compass_eur: Eur::default(),
            teams: default_count(),
            jobs_a_team_day: default_count(),
            working_days: default_working_days(),
            closed: Vec::new(),
            first_hour: default_first_hour(),
            last_hour: default_last_hour(),
            lead_time_h: 0.0,
            licences: Vec::new(),
            flags: Vec::new(),
        }
    }

    /// Firm as the schedule's input, without its own statement.
    pub(super) fn firm(&self, id: &str, name: Option<&str>) -> input::Firm {
        input::Firm {
            id: id.to_owned(),
            name: name.map(str::to_owned),
            ports: self.ports.clone(),
            licences: self.licences.clone(),
            flags: self.flags.clone(),
            teams: self.teams.into(),
            travel_times: Vec::new(),
            taken: Vec::new(),
            jobs_a_team_day: self.jobs_a_team_day,
            working_days: self.working_days.clone(),
            closed: self.closed.clone(),
            first_hour: self.first_hour,
            last_hour: self.last_hour,
            fee_eur: self.fee_eur,
            extra_compass_eur: self.extra_compass_eur,
            lead_time_h: self.lead_time_h,
        }
    }
}
