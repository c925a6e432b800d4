//! Adjuster firms.

use super::Teams;
use super::travel::{TravelTime, travel_s};
use crate::ports::PortCode;
use crate::rules::Flag;
use crate::time::{Eur, Instant};
use chrono::{Datelike, NaiveDate, Weekday};
use serde::{Deserialize, Serialize};

/// A firm: its ports, customers, working hours and prices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Firm {
    /// Id in this file.
    pub id: String,
    /// Name for people.
    #[serde(default)]
    pub name: Option<String>,
    /// The ports it serves.
    pub ports: Vec<ServedPort>,
    /// Licences that it holds.
    #[serde(default)]
    pub licences: Vec<String>,
    /// Flags that accept its adjusters; empty for all.
    #[serde(default)]
    pub flags: Vec<Flag>,
    /// Teams on a working day: their number, or each by name.
    #[serde(default = "default_teams")]
    pub teams: Teams,
    /// The most jobs per team and day.
    #[serde(default = "default_jobs")]
    pub jobs_a_team_day: u32,
    /// Teams that are booked elsewhere, and cannot be planned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub taken: Vec<Taken>,
    /// Hours between its ports where it knows better than the distance.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub travel_times: Vec<TravelTime>,
    /// Working days of the week.
    #[serde(default = "default_working_days")]
    pub working_days: Vec<Weekday>,
    /// Days on which it is closed.
    #[serde(default)]
    pub closed: Vec<NaiveDate>,
    /// Hour at which its day begins, in the port's time.
    #[serde(default = "default_first_hour")]
    pub first_hour: f64,
    /// Hour at which its day ends.
    #[serde(default = "default_last_hour")]
    pub last_hour: f64,
    /// Fee for a job.
    pub fee_eur: Eur,
    /// Fee for each further compass on the same job.
    #[serde(default)]
    pub extra_compass_eur: Eur,
    /// Hours of notice before the job begins.
    #[serde(default)]
    pub lead_time_h: f64,
}

/// Teams that are booked elsewhere on a day.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Taken {
    /// The day, in the port's time.
    pub day: NaiveDate,
    /// Number of teams.
    #[serde(default = "default_jobs")]
    pub teams: u32,
    /// The team, where teams have names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<String>,
    /// Hours of that day; the whole day, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hours: Option<TakenHours>,
}

/// Hours that are booked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakenHours {
    /// Beginning.
    pub from: Instant,
    /// End.
    pub to: Instant,
    /// The port, for one of the day's jobs; where the team happens to be and no job, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<PortCode>,
}

impl Taken {
    /// Returns so many teams, whichever, for a whole day.
    pub fn whole_day(day: NaiveDate, teams: u32) -> Taken {
        Taken {
            day,
            teams,
            team: None,
            hours: None,
        }
    }
}

/// A port that a firm serves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ServedPort {
    /// UN/LOCODE of the port.
    #[cfg_attr(feature = "openapi", schema(value_type = String, example = "NLRTM"))]
    pub port: PortCode,
    /// Cost of sending a team there for a day, euros.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(value_type = f64, minimum = 0, maximum = 1_000_000))]
    pub travel_eur: Eur,
}

impl Firm {
    /// Returns the seconds between all of its ports, in their order.
    pub(crate) fn travel_s(&self) -> Vec<Vec<i64>> {
        let ports: Vec<PortCode> = self.ports.iter().map(|served| served.port).collect();
        travel_s(&ports, &self.travel_times)
    }

    /// Returns true on a working day.
    pub fn works(&self, day: NaiveDate) -> bool {
        self.working_days.contains(&day.weekday()) && !self.closed.contains(&day)
    }

    /// Returns the number of teams that are available on a day, for the whole of it or for
    /// some hours.
    pub fn teams_on(&self, day: NaiveDate) -> u32 {
        let whole = self
            .taken
            .iter()
            .filter(|taken| taken.day == day && taken.hours.is_none());
        whole.fold(self.teams.count(), |left, taken| {
            left.saturating_sub(taken.teams)
        })
    }

    /// Returns true if a flag accepts its adjusters; an unknown flag may not.
    pub fn is_accepted_by(&self, flag: Option<Flag>) -> bool {
        self.flags.is_empty() || flag.is_some_and(|flag| self.flags.contains(&flag))
    }

    /// Returns the cost of a team's day in a port, if the firm serves it.
    pub fn travel(&self, port: PortCode) -> Option<Eur> {
        let served = self.ports.iter().find(|served| served.port == port)?;
        Some(served.travel_eur)
    }

    /// Returns the name for people.
    pub fn display_name(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.id)
    }
}

fn default_teams() -> Teams {
    Teams::Alike(1)
}

fn default_jobs() -> u32 {
    1
}

fn default_working_days() -> Vec<Weekday> {
    vec![
        Weekday::Mon,
        Weekday::Tue,
        Weekday::Wed,
        Weekday::Thu,
        Weekday::Fri,
    ]
}

fn default_first_hour() -> f64 {
    8.0
}

fn default_last_hour() -> f64 {
    18.0
}
