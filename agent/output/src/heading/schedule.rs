//! Times at which a heading is sent.
//!
//! It is sent when a reading of the compass arrives, from that reading, if its interval has nearly
//! passed. A timer sends it where no reading comes in time: the compass is slower than the output,
//! or silent. A heading that has just been withheld is sent at once, whatever the interval.

use super::Heading;
use crate::config::SHORTEST_INTERVAL_SHARE;
use std::time::Duration;
use tokio::time::Instant;

/// Share of the interval by which a reading may come early and the timer waits for a late one.
const SLACK_SHARE: f64 = 0.4;
/// Upper bound of that time.
const MAX_SLACK: Duration = Duration::from_millis(250);
/// Intervals up to which the compass's own interval sets the time.
const FOLLOWED_INTERVALS: f64 = 1.25;

/// Cause for which a heading may be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// A new reading of the compass.
    Reading,
    /// The timer of the schedule.
    Timer,
}

/// Interval, and when it has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schedule {
    interval: Duration,
    due: Option<Instant>,
    was_withheld: bool,
}

impl Schedule {
    /// Creates a schedule that is due.
    pub(crate) fn new(interval_s: f64) -> Schedule {
        Schedule {
            interval: Duration::from_secs_f64(interval_s),
            due: None,
            was_withheld: false,
        }
    }

    /// Makes it due.
    pub(crate) fn reset(&mut self) {
        self.due = None;
    }

    fn slack(&self) -> Duration {
        self.interval.mul_f64(SLACK_SHARE).min(MAX_SLACK)
    }

    /// Returns the time at which the timer sends, after the first time, given the compass's own
    /// interval.
    pub(crate) fn timer(&self, compass_interval: Duration) -> Option<Instant> {
        let due = self.due?;
        let is_followed = !compass_interval.is_zero()
            && compass_interval <= self.interval.mul_f64(FOLLOWED_INTERVALS);
        Some(if is_followed {
            due + self.slack()
        } else {
            due + self.interval.mul_f64(1.0 - SHORTEST_INTERVAL_SHARE)
        })
    }

    /// Returns whether the heading is sent now, and sets the next time if it is.
    pub(crate) fn take_due(
        &mut self,
        heading: &Heading,
        trigger: Trigger,
        compass_interval: Duration,
        now: Instant,
    ) -> bool {
        let is_withheld = heading.true_heading.is_none();
        let at_once = is_withheld && !self.was_withheld;
        self.was_withheld = is_withheld;
        let is_due = at_once
            || match trigger {
                Trigger::Reading => self.due.is_none_or(|due| now + self.slack() >= due),
                Trigger::Timer => self
                    .timer(compass_interval)
                    .is_none_or(|timer| now >= timer),
            };
        if is_due {
            self.set_next(now);
        }
        is_due
    }

    /// Sets the next time. Readings that come early do not make the mean rate higher.
    fn set_next(&mut self, now: Instant) {
        let from = self.due.map_or(now, |due| due.max(now));
        // At once is out of turn: the next time must not move away with each.
        let from = from.min(now + self.slack());
        self.due = Some(from + self.interval.mul_f64(SHORTEST_INTERVAL_SHARE));
    }
}
