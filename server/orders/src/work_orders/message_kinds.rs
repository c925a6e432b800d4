//! Kinds of messages about work orders.

use binnacle_platform::outbox::Kind;
use binnacle_platform::webhooks::{Audience, DeclaredKind};

/// A work order is offered to a firm.
pub const OFFERED: Kind = Kind::new("order.offered");
/// A firm or an operator accepted, declined, or proposed other terms.
pub const ANSWERED: Kind = Kind::new("order.answered");
/// An offer was not answered in time.
pub const LAPSED: Kind = Kind::new("order.lapsed");
/// An offer is withdrawn: another firm has the order, or it is cancelled.
pub const WITHDRAWN: Kind = Kind::new("order.withdrawn");
/// Someone wrote a message about an order.
pub const MESSAGE: Kind = Kind::new("order.message");
/// The operator proposes another time to the firm that has an order.
pub const RETIME_PROPOSED: Kind = Kind::new("order.retime_proposed");
/// The port call of an order was moved or withdrawn.
pub const CALL_MOVED: Kind = Kind::new("order.call_moved");
/// The berth session of an order has progressed, or documents were added.
pub const UPDATED: Kind = Kind::new("order.updated");
/// The adjuster has completed and signed the order.
pub const COMPLETED: Kind = Kind::new("order.completed");
/// Deviations at sea agree with the prediction.
pub const VERIFIED: Kind = Kind::new("order.verified");
/// A deviation at sea disagrees with the prediction.
pub const FAILED: Kind = Kind::new("order.failed");
/// The order is closed.
pub const CLOSED: Kind = Kind::new("order.closed");
/// The order is cancelled.
pub const CANCELLED: Kind = Kind::new("order.cancelled");

/// Subject of all these kinds.
pub const SUBJECT: &str = "work orders";

/// All kinds, in the order in which the API lists them.
pub const ALL: [DeclaredKind; 13] = [
    DeclaredKind::new(
        OFFERED,
        Audience::OperatorsAndFirms,
        "A work order is offered to a firm.",
    ),
    DeclaredKind::new(
        ANSWERED,
        Audience::OperatorsAndFirms,
        "A firm or an operator accepted, declined, or proposed other terms.",
    ),
    DeclaredKind::new(
        LAPSED,
        Audience::OperatorsAndFirms,
        "An offer was not answered in time.",
    ),
    DeclaredKind::new(
        WITHDRAWN,
        Audience::OperatorsAndFirms,
        "An offer is withdrawn: another firm has the order, or it is cancelled.",
    ),
    DeclaredKind::new(
        MESSAGE,
        Audience::OperatorsAndFirms,
        "Someone wrote a message about an order.",
    ),
    DeclaredKind::new(
        RETIME_PROPOSED,
        Audience::OperatorsAndFirms,
        "The operator proposes another time to the firm that has an order.",
    ),
    DeclaredKind::new(
        CALL_MOVED,
        Audience::OperatorsAndFirms,
        "The port call of an order was moved or withdrawn.",
    ),
    DeclaredKind::new(
        UPDATED,
        Audience::OperatorsAndFirms,
        "The berth session of an order has progressed, or documents were added.",
    ),
    DeclaredKind::new(
        COMPLETED,
        Audience::OperatorsAndFirms,
        "The adjuster has completed and signed the order.",
    ),
    DeclaredKind::new(
        VERIFIED,
        Audience::OperatorsAndFirms,
        "Deviations at sea agree with the prediction.",
    ),
    DeclaredKind::new(
        FAILED,
        Audience::OperatorsAndFirms,
        "A deviation at sea disagrees with the prediction.",
    ),
    DeclaredKind::new(CLOSED, Audience::OperatorsAndFirms, "The order is closed."),
    DeclaredKind::new(
        CANCELLED,
        Audience::OperatorsAndFirms,
        "The order is cancelled.",
    ),
];
