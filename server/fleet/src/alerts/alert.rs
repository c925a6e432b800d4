//! Alerts as they are stored and shown.

use super::cause::Cause;
use super::clearing::OVER;
use binnacle_platform::ids::{AlertId, CompassId, UserId, VesselId};
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// State of an alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = AlertState)]
pub enum State {
    /// Nobody has acknowledged it.
    Raised,
    /// Someone has acknowledged it; its cause lasts.
    Acknowledged,
    /// It is over, or someone cleared it.
    Cleared,
}

/// Evidence, a sentence each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Evidence(pub Vec<String>);

impl TryFrom<String> for Evidence {
    type Error = serde_json::Error;

    fn try_from(text: String) -> std::result::Result<Evidence, serde_json::Error> {
        serde_json::from_str(&text).map(Evidence)
    }
}

/// An alert.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub struct Alert {
    /// The alert's id.
    pub id: AlertId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// The vessel's name.
    #[schema(example = "Nao Victoria")]
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// The compass's name.
    #[schema(example = "Standard compass")]
    pub compass_name: String,
    /// Its cause.
    pub cause: Cause,
    /// Its severity.
    pub severity: Severity,
    /// Its state.
    pub state: State,
    /// Beginning of its cause, as far as that is known.
    pub since: Time,
    /// The facts, in a sentence.
    #[schema(example = "Deviation is 7.4° E on compass heading 095°, over the limit of 5°.")]
    pub summary: String,
    /// Advice to the crew and the office.
    pub advice: String,
    /// The evidence, a sentence each.
    #[sqlx(try_from = "String")]
    #[schema(value_type = Vec<String>)]
    pub evidence: Evidence,
    /// Time at which it was raised.
    pub raised_at: Time,
    /// Time of its last change.
    pub updated_at: Time,
    /// Time at which someone acknowledged it.
    #[schema(required)]
    pub acknowledged_at: Option<Time>,
    /// Name of that person.
    #[schema(required)]
    pub acknowledged_by: Option<String>,
    /// Note of that person.
    #[schema(required)]
    pub acknowledgement_note: Option<String>,
    /// User who is to see to it.
    #[schema(required)]
    pub assigned_to: Option<UserId>,
    /// Name of that user.
    #[schema(required)]
    pub assigned_name: Option<String>,
    /// Time until which it is snoozed.
    #[schema(required)]
    pub snoozed_until: Option<Time>,
    /// Time at which it was cleared.
    #[schema(required)]
    pub cleared_at: Option<Time>,
    /// Name of the person who cleared it; none when it cleared itself.
    #[schema(required)]
    pub cleared_by: Option<String>,
    /// Reason for clearing it.
    #[schema(required)]
    pub clearing_reason: Option<String>,
}

/// A stored alert whose cause held when it was last evaluated; cleared if a person did that.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct KnownAlert {
    pub id: AlertId,
    pub cause: Cause,
    pub severity: Severity,
    pub state: State,
    pub summary: String,
    pub advice: String,
    #[sqlx(try_from = "String")]
    pub evidence: Evidence,
    pub since: Time,
    pub cleared_at: Option<Time>,
}

impl Alert {
    /// Tells whether it is closed because its cause is over, or because a person cleared it.
    pub fn is_over(&self) -> bool {
        self.cleared_by.is_some() || self.clearing_reason.as_deref() == Some(OVER)
    }
}
