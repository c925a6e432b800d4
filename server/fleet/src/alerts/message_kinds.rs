//! Kinds of messages about alerts.

use binnacle_platform::outbox::Kind;
use binnacle_platform::webhooks::{Audience, DeclaredKind};

/// An alert is new, or was acknowledged and got worse.
pub const RAISED: Kind = Kind::new("alert.raised");
/// The severity of an alert changed.
pub const UPDATED: Kind = Kind::new("alert.updated");
/// Someone acknowledged an alert.
pub const ACKNOWLEDGED: Kind = Kind::new("alert.acknowledged");
/// An alert is over.
pub const CLEARED: Kind = Kind::new("alert.cleared");

/// Kinds of a program that follows alerts from their beginning to their end.
pub const EXAMPLE: [Kind; 2] = [RAISED, CLEARED];

/// All kinds, in the order in which the API lists them.
pub const ALL: [DeclaredKind; 4] = [
    DeclaredKind::new(
        RAISED,
        Audience::Operators,
        "An alert is new, or was acknowledged and got worse.",
    ),
    DeclaredKind::new(
        UPDATED,
        Audience::Operators,
        "The severity of an alert changed.",
    ),
    DeclaredKind::new(
        ACKNOWLEDGED,
        Audience::Operators,
        "Someone acknowledged an alert.",
    ),
    DeclaredKind::new(CLEARED, Audience::Operators, "An alert is over."),
];
