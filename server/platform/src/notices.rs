//! Notices: messages to the users of an operator or a firm, independent of their delivery.

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
    /// A compass needs adjustment soon or very soon, or is overdue.
    DueSoon,
    /// A due date was brought forward.
    NeedRaised,
    /// Your firm is offered a work order, or another time for one.
    Offered,
    /// The other party of a work order accepts, declines, or proposes other terms.
    Answered,
    /// A work order was not answered in time.
    AnswerLate,
    /// The other party wrote a message about a work order.
    Message,
    /// The port call of a work order was moved or withdrawn.
    CallMoved,
    /// The adjuster is on board.
    OnBoard,
    /// The adjuster has completed and signed the work order.
    Completed,
    /// Deviations at sea agree with the prediction.
    Verified,
    /// A deviation at sea disagrees with the prediction.
    VerificationFailed,
    /// A work order is cancelled, or another firm has it.
    Withdrawn,
    /// An alert of severity warning or worse is raised, becomes critical, sinks to a notice, or
    /// is over. Critical alerts are sent at once.
    Alert,
}

/// Message to the users whom its kind concerns.
#[derive(Clone, Debug)]
pub struct Notice {
    /// Subject of the notice.
    pub kind: Kind,
    /// True if the notice must go out at once.
    pub urgent: bool,
    /// Subject line.
    pub subject: String,
    /// Text of a letter: one fact per line, then sentences.
    pub text: String,
    /// Page of the dashboard to link to.
    pub path: String,
    /// Vessel concerned.
    pub vessel: VesselId,
    /// Work order concerned, if any.
    pub order: Option<OrderId>,
    /// Alert concerned, if any.
    pub alert: Option<AlertId>,
}

/// Notices for a tenant's users, delivered to each as the user has chosen.
pub struct NoticesPublished {
    /// Tenant whose users are notified.
    pub tenant: Tenant,
    /// Notices to deliver.
    pub notices: Vec<Notice>,
    /// User who caused the notices and receives none.
    pub by: Option<UserId>,
    /// Time of the notices.
    pub at: Time,
}

impl DomainEvent for NoticesPublished {}

impl Kind {
    /// All kinds.
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
