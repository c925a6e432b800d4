//! Reasons why a sign-in through the provider fails.

use crate::error::Error;
use crate::identity_provider::Unreachable;
use tracing::error;

/// Reason shown on the sign-in page.
#[derive(Debug)]
pub(super) enum Refusal {
    /// The person cancelled, or the provider refused.
    Cancelled,
    /// The sign-in was begun in another browser or too long ago, or was already completed.
    Over,
    /// The provider cannot be reached.
    Unreachable,
    /// The provider's claims failed verification.
    Untrusted,
    /// The provider has not verified an e-mail address.
    Unverified,
    /// No active user has the e-mail address.
    Unknown,
    /// The user with this e-mail address is bound to another person of the provider.
    Taken,
    /// Too many attempts from this address.
    Throttled,
    /// Internal failure, which was logged.
    Failed,
}

impl Refusal {
    /// Returns the word for the reason in the sign-in page's address.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Refusal::Cancelled => "cancelled",
            Refusal::Over => "over",
            Refusal::Unreachable => "unreachable",
            Refusal::Untrusted => "untrusted",
            Refusal::Unverified => "unverified",
            Refusal::Unknown => "unknown",
            Refusal::Taken => "taken",
            Refusal::Throttled => "throttled",
            Refusal::Failed => "failed",
        }
    }

    /// Checks whether the refusal counts as a failed attempt.
    pub(super) fn counts(&self) -> bool {
        use Refusal::{Taken, Unknown, Untrusted, Unverified};
        matches!(self, Untrusted | Unverified | Unknown | Taken)
    }
}

impl From<Error> for Refusal {
    fn from(cause: Error) -> Refusal {
        if let Error::Throttled { .. } = cause {
            return Refusal::Throttled;
        }
        error!(error = ?cause, "a sign-in by the provider failed");
        Refusal::Failed
    }
}

impl From<Unreachable> for Refusal {
    fn from(_: Unreachable) -> Refusal {
        Refusal::Unreachable
    }
}

impl From<sqlx::Error> for Refusal {
    fn from(cause: sqlx::Error) -> Refusal {
        Error::from(cause).into()
    }
}
