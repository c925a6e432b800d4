//! Changes of alerts, before and after they are published.

use super::alert::Alert;
use super::message_kinds;
use binnacle_platform::ids::{AlertId, DeliveryId};
use binnacle_platform::outbox::Kind;
use binnacle_platform::severity::Severity;

/// Kind of change of an alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ChangeKind {
    /// The alert is new, or was acknowledged and got worse.
    Raised,
    /// The severity changed.
    Updated,
    /// Someone acknowledged the alert.
    Acknowledged,
    /// The alert is over.
    Cleared,
}

impl ChangeKind {
    /// Returns the kind of the messages about the change.
    pub(super) fn message_kind(self) -> Kind {
        match self {
            ChangeKind::Raised => message_kinds::RAISED,
            ChangeKind::Updated => message_kinds::UPDATED,
            ChangeKind::Acknowledged => message_kinds::ACKNOWLEDGED,
            ChangeKind::Cleared => message_kinds::CLEARED,
        }
    }
}

/// A change of an alert, not yet published.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingChange {
    /// The alert.
    pub alert: AlertId,
    /// Kind of change; none where only the text changed.
    pub kind: Option<ChangeKind>,
    /// The severity before, where it changed.
    pub was: Option<Severity>,
}

/// A change of an alert, with the alert as it is now.
#[derive(Clone, Debug)]
pub(super) struct AlertChange {
    /// The event's id.
    pub id: DeliveryId,
    /// Kind of change.
    pub kind: ChangeKind,
    /// The alert.
    pub alert: Alert,
    /// The severity before, where it changed.
    pub was: Option<Severity>,
}

impl PendingChange {
    /// Makes a change of a kind that leaves the severity as it was.
    pub(super) fn from_kind(alert: AlertId, kind: ChangeKind) -> PendingChange {
        PendingChange {
            alert,
            kind: Some(kind),
            was: None,
        }
    }
}
