//! Webhooks and deliveries as they are sent and shown.

use super::send::{Reach, check_url};
use crate::error::{Error, Result};
use crate::ids::{DeliveryId, WebhookId};
use crate::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::{IntoParams, ToSchema};

/// What a webhook may be told of.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[sqlx(type_name = "text")]
#[schema(as = WebhookEventKind)]
pub enum Kind {
    /// An alert is new, or was acknowledged and got worse.
    #[serde(rename = "alert.raised")]
    #[sqlx(rename = "alert.raised")]
    AlertRaised,
    /// An alert is worse or less bad than it was.
    #[serde(rename = "alert.updated")]
    #[sqlx(rename = "alert.updated")]
    AlertUpdated,
    /// Someone acknowledged an alert.
    #[serde(rename = "alert.acknowledged")]
    #[sqlx(rename = "alert.acknowledged")]
    AlertAcknowledged,
    /// An alert is over.
    #[serde(rename = "alert.cleared")]
    #[sqlx(rename = "alert.cleared")]
    AlertCleared,
    /// Someone asked for a test; every webhook is told of it.
    #[serde(rename = "test")]
    #[sqlx(rename = "test")]
    Test,
}

/// What a webhook is told of, as JSON in its row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Kinds(pub(super) Vec<Kind>);

impl TryFrom<String> for Kinds {
    type Error = serde_json::Error;

    fn try_from(text: String) -> std::result::Result<Kinds, serde_json::Error> {
        serde_json::from_str(&text).map(Kinds)
    }
}

/// A webhook to be made, or as it is to be.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NewWebhook {
    /// Where to POST to.
    #[schema(max_length = 500, example = "https://example.com/hooks/binnacle")]
    pub(super) url: String,
    /// What to tell of.
    #[schema(example = json!(["alert.raised", "alert.cleared"]))]
    pub(super) kinds: Vec<Kind>,
    /// Whether anything is sent; true if not said.
    #[serde(default = "enabled")]
    pub(super) enabled: bool,
}

fn enabled() -> bool {
    true
}

/// A webhook, without its secret.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub(super) struct Webhook {
    /// The webhook's id.
    pub(super) id: WebhookId,
    /// Where it POSTs to.
    #[schema(example = "https://example.com/hooks/binnacle")]
    pub(super) url: String,
    /// What it is told of.
    #[sqlx(try_from = "String")]
    #[schema(value_type = Vec<Kind>)]
    pub(super) kinds: Kinds,
    /// Whether anything is sent; what was not delivered waits meanwhile.
    pub(super) enabled: bool,
    /// When it was made.
    pub(super) created_at: Time,
    /// Deliveries that wait.
    pub(super) pending: i64,
    /// Deliveries that were given up.
    pub(super) dead: i64,
}

/// A webhook just made.
#[derive(Serialize, ToSchema)]
pub(super) struct MadeWebhook {
    #[serde(flatten)]
    pub(super) about: Webhook,
    /// What its messages are signed with; never shown again.
    #[schema(example = "bns_mZ3q8k…")]
    pub(super) secret: String,
}

/// A page of webhooks.
#[derive(Serialize, ToSchema)]
pub(super) struct WebhookList {
    /// In the order in which they were made.
    pub(super) items: Vec<Webhook>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// How a delivery stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub(super) enum DeliveryState {
    /// It waits for its turn or its next try.
    Pending,
    /// The receiver answered with a status of 200 to 299.
    Delivered,
    /// It was tried for a day in vain.
    Dead,
}

/// A message and what became of it.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Delivery {
    /// The event's id, which stands in the body too.
    pub(super) id: DeliveryId,
    /// What it tells of.
    pub(super) kind: Kind,
    /// How it stands.
    pub(super) state: DeliveryState,
    /// When it was written.
    pub(super) created_at: Time,
    /// How often it was tried since it was last to be sent.
    pub(super) attempts: i64,
    /// When it is tried next, while it waits.
    #[schema(required)]
    pub(super) next_attempt_at: Option<Time>,
    /// The last answer's HTTP status.
    #[schema(required, example = 503)]
    pub(super) last_status: Option<i64>,
    /// Why the last try failed.
    #[schema(required)]
    pub(super) last_error: Option<String>,
    /// When it was delivered.
    #[schema(required)]
    pub(super) delivered_at: Option<Time>,
    /// What is sent.
    #[schema(value_type = Object)]
    pub(super) body: Box<RawValue>,
}

/// A page of deliveries.
#[derive(Serialize, ToSchema)]
pub(super) struct DeliveryList {
    /// The newest first.
    pub(super) items: Vec<Delivery>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// Which deliveries.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Only those that stand so; `dead` are the dead letters.
    pub(super) state: Option<DeliveryState>,
}

impl NewWebhook {
    /// The same, in order, if it can be sent to.
    ///
    /// # Errors
    /// When it cannot, or would never be.
    pub(super) fn checked(mut self, reach: Reach) -> Result<NewWebhook> {
        let invalid = |field, detail| Err(Error::Invalid { field, detail });
        if let Err(problem) = check_url(&self.url, reach) {
            return invalid("url", problem.to_string());
        }
        self.kinds.sort_unstable();
        self.kinds.dedup();
        self.kinds.retain(|kind| *kind != Kind::Test);
        if self.kinds.is_empty() {
            return invalid("kinds", "is empty".to_owned());
        }
        Ok(self)
    }
}
