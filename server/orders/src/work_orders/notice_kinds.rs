//! Kinds of notices about work orders.

use binnacle_platform::notices::{DeclaredKind, DefaultMail, Readers};

/// Your firm is offered a work order, or another time for one.
pub const OFFERED: DeclaredKind = letter("offered", Readers::Firms);
/// The other party of a work order accepts, declines, or proposes other terms.
pub const ANSWERED: DeclaredKind = letter("answered", Readers::OperatorsAndFirms);
/// A work order was not answered in time.
pub const ANSWER_LATE: DeclaredKind = letter("answer_late", Readers::OperatorsAndFirms);
/// The other party wrote a message about a work order.
pub const MESSAGE: DeclaredKind = letter("message", Readers::OperatorsAndFirms);
/// The port call of a work order was moved or withdrawn.
pub const CALL_MOVED: DeclaredKind = letter("call_moved", Readers::OperatorsAndFirms);
/// The adjuster is on board.
pub const ON_BOARD: DeclaredKind = letter("on_board", Readers::Operators);
/// The adjuster has completed and signed the work order.
pub const COMPLETED: DeclaredKind =
    DeclaredKind::new("completed", Readers::Operators, DefaultMail::Digest);
/// Deviations at sea agree with the prediction.
pub const VERIFIED: DeclaredKind = letter("verified", Readers::OperatorsAndFirms);
/// A deviation at sea disagrees with the prediction.
pub const VERIFICATION_FAILED: DeclaredKind =
    letter("verification_failed", Readers::OperatorsAndFirms);
/// A work order is cancelled, or another firm has it.
pub const WITHDRAWN: DeclaredKind = letter("withdrawn", Readers::Firms);

/// All kinds, in the order in which the API lists them.
pub const ALL: [DeclaredKind; 10] = [
    OFFERED,
    ANSWERED,
    ANSWER_LATE,
    MESSAGE,
    CALL_MOVED,
    ON_BOARD,
    COMPLETED,
    VERIFIED,
    VERIFICATION_FAILED,
    WITHDRAWN,
];

/// Declares a kind of which each notice has a letter of its own.
const fn letter(name: &'static str, readers: Readers) -> DeclaredKind {
    DeclaredKind::new(name, readers, DefaultMail::Letter)
}
