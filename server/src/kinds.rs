//! Registry of the kinds of messages, put together from those of each capability.

use binnacle_fleet::alerts;
use binnacle_orders::work_orders;
use binnacle_planning::{notifications, reports};
use binnacle_platform::outbox::Kind;
use binnacle_platform::webhooks::{Audience, DeclaredKind, MessageKinds};

/// Returns all kinds of messages of the server, in the order of the OpenAPI document.
pub fn message_kinds() -> MessageKinds {
    alerts::message_kinds::ALL
        .into_iter()
        .chain(work_orders::message_kinds::ALL)
        .chain([notifications::MESSAGE_KIND, reports::MESSAGE_KIND])
        .chain([DeclaredKind::new(Kind::TEST, Audience::Nobody)])
        .collect()
}
