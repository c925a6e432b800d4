//! A firm's teams: a number of them, or each by name.

use crate::ports::PortCode;
use chrono::Weekday;
use serde::{Deserialize, Serialize};

/// The teams of a firm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "neither a number of teams nor a list of teams with names"
)]
pub enum Teams {
    /// A number of teams that are alike.
    Alike(u32),
    /// Each by name.
    Named(Vec<Team>),
}

/// A team with hours, days, licences or ports of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = FirmTeam))]
#[serde(deny_unknown_fields)]
pub struct Team {
    /// Name, unlike those of the firm's other teams.
    #[cfg_attr(feature = "openapi", schema(min_length = 1, max_length = 100))]
    pub name: String,
    /// Hour at which its day begins, in the port's time; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 24))]
    pub first_hour: Option<f64>,
    /// Hour at which its day ends; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 24))]
    pub last_hour: Option<f64>,
    /// Working days of the week, as `Mon`; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Vec<String>>))]
    pub working_days: Option<Vec<Weekday>>,
    /// Licences that its adjuster holds; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub licences: Option<Vec<String>>,
    /// Those of the firm's ports where it works, UN/LOCODE; all, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Vec<String>>))]
    pub ports: Option<Vec<PortCode>>,
}

impl Teams {
    /// Returns the number of teams.
    pub fn count(&self) -> u32 {
        match self {
            Teams::Alike(count) => *count,
            Teams::Named(teams) => u32::try_from(teams.len()).unwrap_or(u32::MAX),
        }
    }

    /// Returns the teams that have names.
    pub fn named(&self) -> &[Team] {
        match self {
            Teams::Alike(_) => &[],
            Teams::Named(teams) => teams,
        }
    }
}

impl From<u32> for Teams {
    fn from(count: u32) -> Teams {
        Teams::Alike(count)
    }
}
