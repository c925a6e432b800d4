//! Notices: messages to an operator's or a firm's people, whoever delivers them.

use crate::db::DomainEvent;
use crate::ids::{AlertId, OrderId, UserId, VesselId};
use crate::session::Role;
use crate::tenants::Tenant;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Subject of a notification.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = NotificationKind)]
pub enum Kind {
    /// A compass is to be adjusted soon, very soon, or should have been.
    DueSoon,
    /// A due date was brought forward.
    NeedRaised,
    /// Your firm is asked to do an order, or to do one at another time.
    Offered,
    /// The other side of an order accepts, declines, or proposes other terms.
    Answered,
    /// There was no answer in time.
    AnswerLate,
    /// Someone of the other side wrote about an order.
    Message,
    /// The port call of an order has moved, or is withdrawn.
    CallMoved,
    /// The adjuster is on board.
    OnBoard,
    /// The adjuster has finished and signed.
    Completed,
    /// Headings at sea agree with the prediction.
    Verified,
    /// A heading at sea does not.
    VerificationFailed,
    /// An order is not to be done, or another firm has it.
    Withdrawn,
    /// An alert of severity warning or worse is raised, becomes critical, sinks to a notice,
    /// or is over.
    /// Critical ones wait for nothing.
    Alert,
}

/// Message to the people whom its kind concerns.
#[derive(Clone, Debug)]
pub struct Notice {
    /// Subject of the notice.
    pub kind: Kind,
    /// True if the notice must go out at once.
    pub urgent: bool,
    /// In a line.
    pub subject: String,
    /// In a letter: a fact on each line, then sentences.
    pub text: String,
    /// The dashboard's page to look at.
    pub path: String,
    /// The vessel.
    pub vessel: VesselId,
    /// The work order, if it is of one.
    pub order: Option<OrderId>,
    /// The alert, if it is of one.
    pub alert: Option<AlertId>,
}

/// Notices for a tenant's people, to be delivered to each as the person has chosen.
pub struct NoticesPublished {
    /// The tenant whose users are notified.
    pub tenant: Tenant,
    /// The notices.
    pub notices: Vec<Notice>,
    /// The user who caused the notices and receives none.
    pub by: Option<UserId>,
    /// Time of the notices.
    pub at: Time,
}

impl DomainEvent for NoticesPublished {}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 13] = [
        Kind::DueSoon,
        Kind::NeedRaised,
        Kind::Offered,
        Kind::Answered,
        Kind::AnswerLate,
        Kind::Message,
        Kind::CallMoved,
        Kind::OnBoard,
        Kind::Completed,
        Kind::Verified,
        Kind::VerificationFailed,
        Kind::Withdrawn,
        Kind::Alert,
    ];

    /// Checks whether users with this role can receive notices of this kind.
    pub fn concerns(self, role: Role) -> bool {
        match role {
            Role::Admin | Role::Viewer => !matches!(self, Kind::Offered | Kind::Withdrawn),
            Role::Adjuster => !matches!(
                self,
                Kind::DueSoon | Kind::NeedRaised | Kind::OnBoard | Kind::Completed | Kind::Alert
            ),
            Role::PlatformAdmin => false,
        }
    }
}
