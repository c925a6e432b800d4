//! Ways of delivery of a notification.

use binnacle_platform::notices::{DeclaredKind, DefaultMail};
use binnacle_platform::session::Role;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Way of delivery of a notification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = NotificationWay)]
pub(super) enum Channel {
    /// On the list, and by mail, held until quiet hours end.
    Mail,
    /// On the list, and with the next digest.
    Digest,
    /// On the list only.
    List,
    /// Not at all.
    Off,
}

impl Channel {
    /// Returns the default way of a kind. A viewer gets no mail by default.
    pub(super) fn default_for(kind: DeclaredKind, role: Role) -> Channel {
        match (role, kind.mail) {
            (Role::Viewer, _) | (_, DefaultMail::Recipients) => Channel::List,
            (_, DefaultMail::Digest) => Channel::Digest,
            (_, DefaultMail::Letter) => Channel::Mail,
        }
    }
}
