//! Alternatives to accepted events, and transients too weak to be accepted.

use super::leads::Leads;
use crate::change::event::{EventKind, RowSpan};
use crate::change::filter::Filter;

/// A competing explanation of a step.
pub(crate) struct CompetingHypothesis {
    pub(crate) kind: EventKind,
    /// Place of the step in the list of events.
    pub(crate) event: usize,
    /// Variance of the drift of bx and by beyond the usual.
    pub(crate) drift: f64,
    pub(crate) first: usize,
    pub(crate) between: RowSpan,
    pub(crate) filter: Filter,
    /// Filter before the change.
    pub(crate) before: Filter,
}

/// Hypotheses without the last step.
pub(crate) struct NoStepHypotheses {
    /// Place of the step in the list of events.
    pub(crate) event: usize,
    /// Row at which the step was detected.
    pub(crate) detected_row: usize,
    /// First row of the noise learning before the step was detected.
    pub(crate) learn_from: usize,
    /// Filters without any change, and with a transient.
    pub(crate) without: Vec<Filter>,
}

/// A transient that has not been reported.
pub(crate) struct WeakTransient {
    pub(crate) first: usize,
    /// Row of the largest lead.
    pub(crate) last: usize,
    pub(crate) leads: Leads,
}
