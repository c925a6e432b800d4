//! Alerts that ought to be open, before they are compared with stored ones.

use super::alert::{Evidence, KnownAlert};
use super::cause::Cause;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

/// An alert that ought to be open.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DesiredAlert {
    /// Its cause.
    pub cause: Cause,
    /// Its severity.
    pub severity: Severity,
    /// Beginning of its cause, as far as that is known.
    pub since: Time,
    /// Dates that mark a stored alert of this cause as one about the same event.
    pub window: EventWindow,
    /// The facts, in a sentence.
    pub summary: String,
    /// Advice to the crew and the office.
    pub advice: &'static str,
    /// The evidence, a sentence each.
    pub evidence: Evidence,
}

/// The dates that an event may have been given before, when less was known of it.
///
/// The default is any date, for a lasting state rather than an event.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct EventWindow {
    /// Not before this.
    pub from: Option<Time>,
    /// Not after this.
    pub to: Option<Time>,
}

impl DesiredAlert {
    /// Tells whether a stored alert has the same contents.
    pub(super) fn is_stored_as(&self, known: &KnownAlert) -> bool {
        self.severity == known.severity
            && self.summary == known.summary
            && self.advice == known.advice
            && self.evidence == known.evidence
    }
}

impl EventWindow {
    /// Returns the window of this date and no other.
    pub(super) fn exactly(at: Time) -> EventWindow {
        EventWindow {
            from: Some(at),
            to: Some(at),
        }
    }

    /// Tells whether an alert of that date was about this event.
    pub(super) fn includes(&self, date: Time) -> bool {
        self.from.is_none_or(|from| from <= date) && self.to.is_none_or(|to| date <= to)
    }
}
