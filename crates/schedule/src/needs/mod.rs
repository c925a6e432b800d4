//! The next due date of a compass, with its urgency and causes.
//!
//! Invariants: a due date is the earliest of its causes. Each cause has its
//! reason as text and, where it is a rule, the rule's id. The same facts on the
//! same day give the same need.

mod causes;
mod due;
mod facts;

pub use causes::{Cause, CauseKind};
pub use due::{Due, Urgency, due};
pub use facts::{
    Change, Compass, Event, FailedVerification, Predicted, Ship, Side, Terms, Transit,
};
