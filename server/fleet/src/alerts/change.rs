//! Changes of alerts, before and after they are published.

use super::alert::Alert;
use binnacle_platform::ids::{AlertId, DeliveryId};
use binnacle_platform::outbox::Kind;
use binnacle_platform::severity::Severity;

/// A change of an alert, not yet published.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingChange {
    /// The alert.
    pub alert: AlertId,
    /// Kind of change; none where only the text changed.
    pub kind: Option<Kind>,
    /// The severity before, where it changed.
    pub was: Option<Severity>,
}

/// A change of an alert, with the alert as it is now.
#[derive(Clone, Debug)]
pub(super) struct AlertChange {
    /// The event's id.
    pub id: DeliveryId,
    /// Kind of change.
    pub kind: Kind,
    /// The alert.
    pub alert: Alert,
    /// The severity before, where it changed.
    pub was: Option<Severity>,
}

impl PendingChange {
    /// Makes a change of a kind that leaves the severity as it was.
    pub(super) fn from_kind(alert: AlertId, kind: Kind) -> PendingChange {
        PendingChange {
            alert,
            kind: Some(kind),
            was: None,
        }
    }
}
