//! Adjuster firms.

use crate::ports::PortCode;
use crate::rules::Flag;
use crate::time::Eur;
use chrono::{Datelike, NaiveDate, Weekday};
use serde::{Deserialize, Serialize};

/// A firm: where it works, for whom, when, and for how much.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Firm {
    /// Its name in this file.
    pub id: String,
    /// Its name.
    #[serde(default)]
    pub name: Option<String>,
    /// The ports it serves.
    pub ports: Vec<ServedPort>,
    /// Licences that it holds.
    #[serde(default)]
    pub licences: Vec<String>,
    /// Flags that accept its adjusters; all, where it is empty.
    #[serde(default)]
    pub flags: Vec<Flag>,
    /// Teams on a working day.
    #[serde(default = "one")]
    pub teams: u32,
    /// Jobs that a team does on one day in one port.
    #[serde(default = "one")]
    pub jobs_a_team_day: u32,
    /// Teams that work elsewhere, and are not there to plan with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub taken: Vec<Taken>,
    /// Days of the week on which it works.
    #[serde(default = "working_week")]
    pub working_days: Vec<Weekday>,
    /// Days on which it does not work.
    #[serde(default)]
    pub closed: Vec<NaiveDate>,
    /// The hour at which its day begins, in the port's time.
    #[serde(default = "eight")]
    pub first_hour: f64,
    /// The hour at which its day ends.
    #[serde(default = "eighteen")]
    pub last_hour: f64,
    /// The fee for a job.
    pub fee_eur: Eur,
    /// For each compass after the first on the same job.
    #[serde(default)]
    pub extra_compass_eur: Eur,
    /// Hours from being asked to the beginning of the job.
    #[serde(default)]
    pub lead_time_h: f64,
}

/// Teams that work elsewhere on a day.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Taken {
    /// The day, in the port's time.
    pub day: NaiveDate,
    /// How many.
    pub teams: u32,
}

/// A port that a firm serves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServedPort {
    /// The port.
    pub port: PortCode,
    /// What it costs to send a team there for a day.
    #[serde(default)]
    pub travel_eur: Eur,
}

impl Firm {
    /// Whether it works on a day.
    pub fn works(&self, day: NaiveDate) -> bool {
        self.working_days.contains(&day.weekday()) && !self.closed.contains(&day)
    }

    /// How many of its teams there are to plan with on a day.
    pub fn teams_on(&self, day: NaiveDate) -> u32 {
        let taken = self.taken.iter().filter(|taken| taken.day == day);
        taken.fold(self.teams, |left, taken| left.saturating_sub(taken.teams))
    }

    /// Whether a flag accepts its adjusters; one that is not known may not.
    pub fn is_accepted_by(&self, flag: Option<Flag>) -> bool {
        self.flags.is_empty() || flag.is_some_and(|flag| self.flags.contains(&flag))
    }

    /// What a team's day in a port costs, if the firm serves it.
    pub fn travel(&self, port: PortCode) -> Option<Eur> {
        let served = self.ports.iter().find(|served| served.port == port)?;
        Some(served.travel_eur)
    }

    /// Its name for people.
    pub fn called(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.id)
    }
}

fn one() -> u32 {
    1
}

fn working_week() -> Vec<Weekday> {
    vec![
        Weekday::Mon,
        Weekday::Tue,
        Weekday::Wed,
        Weekday::Thu,
        Weekday::Fri,
    ]
}

fn eight() -> f64 {
    8.0
}

fn eighteen() -> f64 {
    18.0
}
