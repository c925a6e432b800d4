//! What people are told of, and in which ways.

use crate::session::Role;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a notification is about.
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
    /// Headings at sea agree with what was foretold.
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

/// How a person is told of something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = NotificationWay)]
pub(super) enum Way {
    /// On the list, and by mail, after quiet hours if it comes during them.
    Mail,
    /// On the list, and with the next digest.
    Digest,
    /// On the list only.
    List,
    /// Not at all.
    Off,
}

impl Kind {
    /// All of them.
    pub(super) const ALL: [Kind; 13] = [
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

    /// Whether someone of that role is ever told of it.
    pub(super) fn concerns(self, role: Role) -> bool {
        match role {
            Role::Admin | Role::Viewer => !matches!(self, Kind::Offered | Kind::Withdrawn),
            Role::Adjuster => !matches!(
                self,
                Kind::DueSoon | Kind::NeedRaised | Kind::OnBoard | Kind::Completed | Kind::Alert
            ),
            Role::PlatformAdmin => false,
        }
    }

    /// How someone is told who has not said. Alerts have the operator's mailing list; and
    /// who only looks on is not written to unasked.
    pub(super) fn usual_way(self, role: Role) -> Way {
        match (role, self) {
            (Role::Viewer, _) | (_, Kind::Alert) => Way::List,
            (_, Kind::DueSoon | Kind::Completed) => Way::Digest,
            _ => Way::Mail,
        }
    }
}
