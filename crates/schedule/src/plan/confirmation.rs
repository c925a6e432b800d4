//! The states of a firm's confirmation.

use super::quote::Quote;
use crate::calls::PortCall;
use chrono::NaiveDate;

/// The state of a firm's confirmation.
pub(super) enum Confirmation<'a> {
    /// Not confirmed.
    None,
    /// It holds.
    Holds(Held<'a>),
    /// The job may move, for this cause; a job that is only late may move only
    /// to a day in time.
    Released { cause: String, only_late: bool },
}

/// A confirmed job, with each crew that may do it.
pub(super) struct Held<'a> {
    pub(super) call: &'a PortCall,
    pub(super) day: NaiveDate,
    pub(super) ways: Vec<(usize, Quote)>,
}
