//! Webhooks, as requested and as shown.

use super::format::Format;
use super::kinds::MessageKinds;
use crate::error::{Error, Result};
use crate::http::is_control;
use crate::ids::WebhookId;
use crate::outbound::{Reach, check_url};
use crate::outbox::Kind;
use crate::tenants::Tenant;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Kinds of messages for a webhook, as JSON in its row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Kinds(Vec<String>);

impl Kinds {
    /// Checks whether messages of a kind are sent.
    pub(super) fn includes(&self, kind: Kind) -> bool {
        self.0.iter().any(|name| name == kind.name())
    }
}

impl TryFrom<String> for Kinds {
    type Error = serde_json::Error;

    fn try_from(text: String) -> std::result::Result<Kinds, serde_json::Error> {
        serde_json::from_str(&text).map(Kinds)
    }
}

/// Webhook to be created or changed.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NewWebhook {
    /// URL for the POST requests.
    #[schema(max_length = 500, example = "https://example.com/hooks/binnacle")]
    pub(super) url: String,
    /// Kinds of messages to send.
    #[schema(value_type = Vec<Kind>)]
    pub(super) kinds: Vec<String>,
    /// True if messages are sent; true by default.
    #[serde(default = "enabled")]
    pub(super) enabled: bool,
    /// Form of the messages; that for programs by default.
    #[serde(default)]
    pub(super) format: Format,
}

fn enabled() -> bool {
    true
}

/// Webhook, without its secret.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub(super) struct Webhook {
    /// The webhook's id.
    pub(super) id: WebhookId,
    /// URL for the POST requests.
    #[schema(example = "https://example.com/hooks/binnacle")]
    pub(super) url: String,
    /// Kinds of messages sent.
    #[sqlx(try_from = "String")]
    #[schema(value_type = Vec<Kind>)]
    pub(super) kinds: Kinds,
    /// True if messages are sent; undelivered messages wait meanwhile.
    pub(super) enabled: bool,
    /// Form of the messages.
    pub(super) format: Format,
    /// Creation time.
    pub(super) created_at: Time,
    /// Number of pending deliveries.
    pub(super) pending: i64,
    /// Number of deliveries that were given up.
    pub(super) dead: i64,
}

/// Newly created webhook.
#[derive(Serialize, ToSchema)]
pub(super) struct MadeWebhook {
    #[serde(flatten)]
    pub(super) about: Webhook,
    /// Signing secret of its messages; never shown again.
    #[schema(example = "bns_mZ3q8k…")]
    pub(super) secret: String,
}

/// Page of webhooks.
#[derive(Serialize, ToSchema)]
pub(super) struct WebhookList {
    /// Webhooks in the order in which they were created.
    pub(super) items: Vec<Webhook>,
    /// Value of `after` for the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

impl NewWebhook {
    /// Returns the declared kinds that the webhook subscribes to.
    ///
    /// # Errors
    /// Fails when a name is not that of a kind.
    pub(super) fn find_kinds(&self, declared: &MessageKinds) -> Result<MessageKinds> {
        let invalid = |detail| Error::Invalid {
            field: "body",
            detail,
        };
        declared.find(&self.kinds).map_err(invalid)
    }

    /// Returns the webhook with its kinds in order, if messages can be sent to it.
    ///
    /// # Errors
    /// Fails when messages cannot be sent to it, or it subscribes to none.
    pub(super) fn checked(
        mut self,
        kinds: &MessageKinds,
        tenant: Tenant,
        reach: Reach,
    ) -> Result<NewWebhook> {
        let invalid = |field, detail| Err(Error::Invalid { field, detail });
        // Blanks at the ends come from copying. A blank inside might be skipped by a URL parser,
        // and the request would go elsewhere than to the address shown.
        self.url = self.url.trim().to_owned();
        if self.url.chars().any(|c| c.is_whitespace() || is_control(c)) {
            return invalid("url", "has blanks or control characters".to_owned());
        }
        if let Err(problem) = check_url(&self.url, reach) {
            return invalid("url", problem.to_string());
        }
        if tenant.firm().is_some()
            && let Err(problem) = kinds.check_for_firm()
        {
            return invalid("kinds", problem);
        }
        self.kinds = kinds.names().map(str::to_owned).collect();
        if self.kinds.is_empty() {
            return invalid("kinds", "is empty".to_owned());
        }
        Ok(self)
    }
}
