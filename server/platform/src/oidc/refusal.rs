//! Reasons for which a sign-in through the provider fails.

use crate::error::Error;
use crate::identity_provider::Unreachable;
use tracing::error;

/// Reason shown on the sign-in page.
#[derive(Debug)]
pub(super) enum Refusal {
    /// The person did not want to, or the provider does not let them.
    Cancelled,
    /// It was begun in another browser or too long ago, or came back before.
    Over,
    /// The provider cannot be reached.
    Unreachable,
    /// The provider's claims failed verification.
    Untrusted,
    /// The provider does not vouch for an e-mail.
    Unverified,
    /// Nobody here has the e-mail, or may sign in.
    Unknown,
    /// Another person of the provider's is who has the e-mail here.
    Taken,
    /// Too many attempts from this address.
    Throttled,
    /// A fault of ours; it was logged.
    Failed,
}

impl Refusal {
    /// The word for it in the sign-in page's address.
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
