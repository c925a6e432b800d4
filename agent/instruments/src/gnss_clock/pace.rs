//! Pace of a receiver's time beside the computer's monotonic clock.
//!
//! Invariants:
//!
//! - The monotonic clock judges a time that has run in step with it for a minute. The time of
//!   accelerated instruments has not.
//! - A stamp that is early has jumped. One that is late may have been delayed on its way, unless it
//!   is earlier than the one before.

use super::{MAX_STEP_S, RECEIVER_TOLERANCE_S};
use binnacle_compass::time::Timestamp;
use tokio::time::Instant;

/// Drift of the computer's quartz, as a share of the time: ten times the 20 parts in a million of a
/// usual one.
const QUARTZ_DRIFT: f64 = 2e-4;
/// Time in step after which the monotonic clock judges.
const PROVEN_S: f64 = 60.0;

/// A stamp and its receive time.
#[derive(Clone, Copy, Debug)]
struct Pair {
    stamp: Timestamp,
    heard: Instant,
}

/// Receiver's time since it has run in step.
#[derive(Debug, Default)]
pub(super) struct Pace {
    /// Pair that later ones are compared with.
    from: Option<Pair>,
    since: Option<Instant>,
    /// Receive time of the latest stamp in step.
    latest: Option<Instant>,
}

impl Pace {
    /// Returns the seconds for which the time has run in step.
    pub(super) fn lasted_s(&self) -> f64 {
        let span = self.latest.zip(self.since);
        span.map_or(0.0, |(latest, since)| seconds(since, latest))
    }

    /// Returns whether the monotonic clock can judge.
    pub(super) fn is_proven(&self) -> bool {
        self.lasted_s() >= PROVEN_S
    }

    /// Returns whether a stamp is in step.
    pub(super) fn is_in_step(&self, stamp: Timestamp, heard: Instant) -> bool {
        self.from.is_some_and(|from| {
            let (ahead_s, bound_s) = from.compare(stamp, heard);
            ahead_s.abs() <= bound_s
        })
    }

    /// Returns whether a stamp has jumped, `step_s` after the one before.
    pub(super) fn is_jump(&self, stamp: Timestamp, heard: Instant, step_s: f64) -> bool {
        let Some(from) = self.from.filter(|_| self.is_proven()) else {
            return false;
        };
        let (ahead_s, bound_s) = from.compare(stamp, heard);
        let went_back = step_s < -RECEIVER_TOLERANCE_S;
        ahead_s > bound_s || (went_back && ahead_s < -bound_s)
    }

    /// Applies a stamp that is accepted.
    pub(super) fn accept(&mut self, stamp: Timestamp, heard: Instant) {
        if !self.is_in_step(stamp, heard) {
            let late_s = self.latest.map_or(0.0, |latest| seconds(latest, heard));
            // A delay ends, or is none.
            if !self.is_proven() || late_s > MAX_STEP_S {
                *self = Pace {
                    from: Some(Pair { stamp, heard }),
                    since: Some(heard),
                    latest: Some(heard),
                };
            }
            return;
        }
        self.latest = Some(heard);
        if self
            .from
            .is_none_or(|from| seconds(from.heard, heard) >= MAX_STEP_S)
        {
            self.from = Some(Pair { stamp, heard });
        }
    }
}

impl Pair {
    /// Returns the seconds by which a stamp is ahead of the monotonic clock, and how many it may be.
    fn compare(self, stamp: Timestamp, heard: Instant) -> (f64, f64) {
        let passed_s = seconds(self.heard, heard);
        let ahead_s = stamp.seconds_since(self.stamp) - passed_s;
        (ahead_s, RECEIVER_TOLERANCE_S + QUARTZ_DRIFT * passed_s)
    }
}

fn seconds(from: Instant, to: Instant) -> f64 {
    to.saturating_duration_since(from).as_secs_f64()
}
