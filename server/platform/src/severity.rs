//! Severity of what is announced.

use serde::{Deserialize, Serialize};
use std::fmt;
use utoipa::ToSchema;

/// Severity of an alert.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Severity {
    /// Information only.
    Notice,
    /// Action is needed.
    Warning,
    /// The compass must not be relied on.
    Critical,
}

impl Severity {
    /// Returns this severity and all worse ones. The last one is repeated to fill the parameters
    /// of a query.
    pub fn and_worse(self) -> [Severity; 3] {
        match self {
            Severity::Notice => [Severity::Notice, Severity::Warning, Severity::Critical],
            Severity::Warning => [Severity::Warning, Severity::Critical, Severity::Critical],
            Severity::Critical => [Severity::Critical; 3],
        }
    }
}
impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Severity::Notice => "notice",
            Severity::Warning => "warning",
            Severity::Critical => "critical",
        })
    }
}
