//! Messages, and deliveries as they are shown.

use crate::ids::{DeliveryId, OrderId};
use crate::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::{IntoParams, ToSchema};

/// Channel that carries messages to a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, sqlx::Type)]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Channel {
    /// HTTP, to a program.
    Webhook,
    /// SMTP, to a person.
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
    /// A firm is asked to do an order.
    #[serde(rename = "order.offered")]
    #[sqlx(rename = "order.offered")]
    OrderOffered,
    /// A firm or an operator said yes or no, or proposed other terms.
    #[serde(rename = "order.answered")]
    #[sqlx(rename = "order.answered")]
    OrderAnswered,
    /// There was no answer in time.
    #[serde(rename = "order.lapsed")]
    #[sqlx(rename = "order.lapsed")]
    OrderLapsed,
    /// An offer is taken back: another firm has the order, or it is cancelled.
    #[serde(rename = "order.withdrawn")]
    #[sqlx(rename = "order.withdrawn")]
    OrderWithdrawn,
    /// Someone wrote a message about an order.
    #[serde(rename = "order.message")]
    #[sqlx(rename = "order.message")]
    OrderMessage,
    /// The operator asks the firm that has an order for another time.
    #[serde(rename = "order.retime_proposed")]
    #[sqlx(rename = "order.retime_proposed")]
    OrderRetimeProposed,
    /// The port call of an order has moved, or is withdrawn.
    #[serde(rename = "order.call_moved")]
    #[sqlx(rename = "order.call_moved")]
    OrderCallMoved,
    /// Something was done at the berth, or added.
    #[serde(rename = "order.updated")]
    #[sqlx(rename = "order.updated")]
    OrderUpdated,
    /// The adjuster has finished and signed.
    #[serde(rename = "order.completed")]
    #[sqlx(rename = "order.completed")]
    OrderCompleted,
    /// Headings at sea agree with the prediction.
    #[serde(rename = "order.verified")]
    #[sqlx(rename = "order.verified")]
    OrderVerified,
    /// A heading at sea does not.
    #[serde(rename = "order.failed")]
    #[sqlx(rename = "order.failed")]
    OrderFailed,
    /// The order is done with.
    #[serde(rename = "order.closed")]
    #[sqlx(rename = "order.closed")]
    OrderClosed,
    /// It is not to be done, or no further.
    #[serde(rename = "order.cancelled")]
    #[sqlx(rename = "order.cancelled")]
    OrderCancelled,
    /// Notification mail to a person: one notification, or several together.
    #[serde(rename = "notification")]
    #[sqlx(rename = "notification")]
    Notification,
    /// A monthly report by mail.
    #[serde(rename = "report")]
    #[sqlx(rename = "report")]
    Report,
    /// Someone asked for a test.
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

/// A message to be delivered.
#[derive(Clone, Debug)]
pub struct Message {
    /// The event's id.
    pub id: DeliveryId,
    /// Subject of the message.
    pub kind: Kind,
    /// The work order that it is of, if it is of one.
    pub order: Option<OrderId>,
    /// JSON.
    pub body: String,
}

/// State of a delivery.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum DeliveryState {
    /// It waits for its turn or its next try.
    Pending,
    /// The receiver took it.
    Delivered,
    /// It was refused for good, or tried for a day in vain.
    Dead,
}

/// A message and what became of it.
#[derive(Debug, Serialize, ToSchema)]
pub struct Delivery {
    /// The event's id, which a webhook's body names too.
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
    /// The last answer's HTTP status or SMTP reply code.
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

/// A page of deliveries.
#[derive(Serialize, ToSchema)]
pub struct DeliveryList {
    /// The newest first.
    pub items: Vec<Delivery>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Filter for deliveries.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Filter {
    /// Only those that stand so; `dead` are the dead letters.
    pub state: Option<DeliveryState>,
}
