//! Messages, and deliveries as the API shows them.

use super::kind::Kind;
use crate::ids::DeliveryId;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::{IntoParams, ToSchema};
use uuid::Uuid;

/// Channel that carries messages to a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, sqlx::Type)]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Channel {
    /// HTTP request to a program.
    Webhook,
    /// Mail to a person.
    Mail,
}

/// Message to be delivered.
#[derive(Clone, Debug)]
pub struct Message {
    /// Id of the event.
    pub id: DeliveryId,
    /// Subject of the message.
    pub kind: Kind,
    /// Id of what the message is about, if its messages form a sequence of their own.
    pub about: Option<Uuid>,
    /// Body, JSON.
    pub body: String,
}

/// State of a delivery.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum DeliveryState {
    /// Waiting for its turn or its next attempt.
    Pending,
    /// Accepted by the receiver.
    Delivered,
    /// Refused permanently, or given up after a day of attempts.
    Dead,
}

/// Message and its delivery.
#[derive(Debug, Serialize, ToSchema)]
pub struct Delivery {
    /// Id of the event, which the body of a webhook contains too.
    pub id: DeliveryId,
    /// Subject of the message.
    #[schema(value_type = Kind)]
    pub kind: String,
    /// State of the delivery.
    pub state: DeliveryState,
    /// Creation time of the message.
    pub created_at: Time,
    /// Number of attempts since it was last queued.
    pub attempts: i64,
    /// Time of the next attempt, while the delivery is pending.
    #[schema(required)]
    pub next_attempt_at: Option<Time>,
    /// HTTP status or SMTP reply code of the last response.
    #[schema(required, example = 503)]
    pub last_status: Option<i64>,
    /// Error of the last failed attempt.
    #[schema(required)]
    pub last_error: Option<String>,
    /// Time of the delivery.
    #[schema(required)]
    pub delivered_at: Option<Time>,
    /// Body sent to a webhook, or a mail's `subject` and `text`.
    #[schema(value_type = Object)]
    pub body: Box<RawValue>,
}

/// Page of deliveries.
#[derive(Serialize, ToSchema)]
pub struct DeliveryList {
    /// Deliveries, newest first.
    pub items: Vec<Delivery>,
    /// Value of `after` for the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Filter for deliveries.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Filter {
    /// State of the deliveries to list; `dead` are the dead letters.
    pub state: Option<DeliveryState>,
}
