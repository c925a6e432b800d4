//! Messages, and deliveries as the API shows them.

use crate::ids::{DeliveryId, OrderId};
use crate::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::{IntoParams, ToSchema};

/// Channel that carries messages to a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, sqlx::Type)]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Channel {
    /// HTTP request to a program.
    Webhook,
    /// Mail to a person.
    Mail,
}

/// Subject of a message.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[sqlx(type_name = "text")]
#[schema(as = MessageKind)]
pub enum Kind {
    /// An alert is new, or was acknowledged and got worse.
    #[serde(rename = "alert.raised")]
    #[sqlx(rename = "alert.raised")]
    AlertRaised,
    /// The severity of an alert changed.
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
    /// A work order is offered to a firm.
    #[serde(rename = "order.offered")]
    #[sqlx(rename = "order.offered")]
    OrderOffered,
    /// A firm or an operator accepted, declined, or proposed other terms.
    #[serde(rename = "order.answered")]
    #[sqlx(rename = "order.answered")]
    OrderAnswered,
    /// An offer was not answered in time.
    #[serde(rename = "order.lapsed")]
    #[sqlx(rename = "order.lapsed")]
    OrderLapsed,
    /// An offer is withdrawn: another firm has the order, or it is cancelled.
    #[serde(rename = "order.withdrawn")]
    #[sqlx(rename = "order.withdrawn")]
    OrderWithdrawn,
    /// Someone wrote a message about an order.
    #[serde(rename = "order.message")]
    #[sqlx(rename = "order.message")]
    OrderMessage,
    /// The operator proposes another time to the firm that has an order.
    #[serde(rename = "order.retime_proposed")]
    #[sqlx(rename = "order.retime_proposed")]
    OrderRetimeProposed,
    /// The port call of an order was moved or withdrawn.
    #[serde(rename = "order.call_moved")]
    #[sqlx(rename = "order.call_moved")]
    OrderCallMoved,
    /// The berth session of an order has progressed, or documents were added.
    #[serde(rename = "order.updated")]
    #[sqlx(rename = "order.updated")]
    OrderUpdated,
    /// The adjuster has completed and signed the order.
    #[serde(rename = "order.completed")]
    #[sqlx(rename = "order.completed")]
    OrderCompleted,
    /// Deviations at sea agree with the prediction.
    #[serde(rename = "order.verified")]
    #[sqlx(rename = "order.verified")]
    OrderVerified,
    /// A deviation at sea disagrees with the prediction.
    #[serde(rename = "order.failed")]
    #[sqlx(rename = "order.failed")]
    OrderFailed,
    /// The order is closed.
    #[serde(rename = "order.closed")]
    #[sqlx(rename = "order.closed")]
    OrderClosed,
    /// The order is cancelled.
    #[serde(rename = "order.cancelled")]
    #[sqlx(rename = "order.cancelled")]
    OrderCancelled,
    /// Notification mail to a user: one notification, or a digest of several.
    #[serde(rename = "notification")]
    #[sqlx(rename = "notification")]
    Notification,
    /// Monthly report by mail.
    #[serde(rename = "report")]
    #[sqlx(rename = "report")]
    Report,
    /// A user requested a test.
    #[serde(rename = "test")]
    #[sqlx(rename = "test")]
    Test,
}

impl Kind {
    /// Checks whether the message concerns a work order: firms receive no other kind.
    pub fn is_of_order(self) -> bool {
        !matches!(
            self,
            Kind::AlertRaised
                | Kind::AlertUpdated
                | Kind::AlertAcknowledged
                | Kind::AlertCleared
                | Kind::Notification
                | Kind::Report
                | Kind::Test
        )
    }
}

/// Message to be delivered.
#[derive(Clone, Debug)]
pub struct Message {
    /// Id of the event.
    pub id: DeliveryId,
    /// Subject of the message.
    pub kind: Kind,
    /// Work order concerned, if any.
    pub order: Option<OrderId>,
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
    pub kind: Kind,
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
