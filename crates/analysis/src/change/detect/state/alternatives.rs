//! Alternatives to what has been accepted, and transients too weak to be accepted.

use super::leads::Leads;
use crate::change::event::EventKind;
use crate::change::filter::Filter;

/// Another reading of a step.
pub(crate) struct CompetingHypothesis {
    pub(crate) kind: EventKind,
    /// The step's place in the list of events.
    pub(crate) event: usize,
    /// What bx and by drift by beyond their usual.
    pub(crate) drift: f64,
    pub(crate) first: usize,
    pub(crate) between: (usize, usize),
    pub(crate) filter: Filter,
    /// The filter before it.
    pub(crate) before: Filter,
}

/// That the last step may be none.
pub(crate) struct NoStepHypotheses {
    /// The step's place in the list of events.
    pub(crate) event: usize,
    /// The row that told.
    pub(crate) detected_row: usize,
    /// Where the stretch of learning began before it was told.
    pub(crate) learn_from: usize,
    /// Of a ship to whom nothing happened, and by whom something passed.
    pub(crate) without: Vec<Filter>,
}

/// One that has not been told.
pub(crate) struct WeakTransient {
    pub(crate) first: usize,
    /// The row at which it led most.
    pub(crate) last: usize,
    pub(crate) leads: Leads,
}
