//! A firm's teams: a number of them, or each by name.

use crate::ports::PortCode;
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

/// A team with hours, licences or ports of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Team {
    /// Name, unlike those of the firm's other teams.
    pub name: String,
    /// Hour at which its day begins; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_hour: Option<f64>,
    /// Hour at which its day ends; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_hour: Option<f64>,
    /// Licences that its adjuster holds; the firm's, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub licences: Option<Vec<String>>,
    /// Those of the firm's ports where it works; all, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
