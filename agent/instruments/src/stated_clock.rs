//! Age of observations by the time at which their source says that they were measured.
//!
//! Invariants:
//!
//! - No clock outside the agent is believed: of each source that states times, the offset to the
//!   computer's monotonic clock is learnt. Until it is, the age of its values is unknown, and they
//!   are not used. A cached value that a server repeats on connect is thereby never new.
//! - An offset is learnt from a server that states its present time when it greets, or from times
//!   that have advanced in step with their arrival.
//! - The least delay counts as none. A later value is older by its delay.
//! - A value without a stated time was measured when it arrived.

use binnacle_compass::time::Timestamp;
use binnacle_observation::Source;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;

/// Difference up to which two offsets are one: whole seconds are all that a TAG block need state.
const STEP_MICROS: i64 = 1_000_000;
/// Delay of a value behind a server's greeting up to which its source has the server's clock.
const GREETING_MICROS: i64 = 2_000_000;
/// Time for which stated times must advance in step with their arrival before they are believed.
const CONFIRM_MICROS: i64 = 2_000_000;
/// Time for which they must, where they lag behind what was learnt. A network's backlog looks the
/// same as a clock that was put back; it seldom lasts as long without changing.
const CONFIRM_LAG_MICROS: i64 = 600_000_000;
/// Drift of one quartz against another, as a share of the time: ten times a usual one.
const QUARTZ_DRIFT: f64 = 2e-4;
/// Limit on sources whose clocks are remembered: senders of datagrams may be many.
const MAX_CLOCKS: usize = 1_000;

/// Clocks of the sources.
#[derive(Debug, Default)]
pub struct StatedClocks {
    /// Moment that monotonic times are counted from.
    start: Option<Instant>,
    clocks: HashMap<Source, StatedClock>,
    /// Offsets by which servers greeted, by input.
    greetings: HashMap<Arc<str>, i64>,
}

impl StatedClocks {
    /// Records the present time of a server, as it greets.
    pub fn note_greeting(&mut self, input: &Arc<str>, stated: Timestamp, heard: Instant) {
        let offset = self.micros(heard) - stated.micros();
        self.greetings.insert(Arc::clone(input), offset);
    }

    /// Returns the age of a value on arrival; `None` while that is unknown.
    pub fn age(
        &mut self,
        source: &Source,
        stated: Option<Timestamp>,
        heard: Instant,
    ) -> Option<Duration> {
        let Some(stated) = stated else {
            return Some(Duration::ZERO);
        };
        let heard = self.micros(heard);
        let stated = stated.micros();
        if !self.clocks.contains_key(source) {
            if self.clocks.len() >= MAX_CLOCKS {
                return None;
            }
            self.clocks.insert(source.clone(), StatedClock::default());
        }
        let greeting = self.greetings.get(&source.input).copied();
        let clock = self.clocks.get_mut(source)?;
        let age = clock.observe(heard, stated, greeting)?;
        Some(Duration::from_micros(age.max(0).unsigned_abs()))
    }

    fn micros(&mut self, heard: Instant) -> i64 {
        let start = *self.start.get_or_insert(heard);
        let passed = heard.saturating_duration_since(start);
        i64::try_from(passed.as_micros()).unwrap_or(i64::MAX / 4)
    }
}

/// Clock of one source: arrival less stated time, microseconds.
#[derive(Debug, Default)]
struct StatedClock {
    learnt: Option<Learnt>,
    candidate: Option<Candidate>,
}

#[derive(Clone, Copy, Debug)]
struct Learnt {
    offset: i64,
    heard: i64,
}

/// Another offset, and since when it has held.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    offset: i64,
    heard: i64,
    stated: i64,
}

impl StatedClock {
    /// Applies a value. Returns its age in microseconds, once that is known.
    fn observe(&mut self, heard: i64, stated: i64, greeting: Option<i64>) -> Option<i64> {
        let offset = heard.saturating_sub(stated);
        let expected = self.expected(heard).or(greeting.filter(|greeting| {
            let delay = offset.saturating_sub(*greeting);
            (-GREETING_MICROS..=GREETING_MICROS).contains(&delay)
        }));
        let Some(expected) = expected else {
            return self.confirm(heard, stated, CONFIRM_MICROS).then_some(0);
        };
        let delay = offset.saturating_sub(expected);
        if (-STEP_MICROS..=STEP_MICROS).contains(&delay) || self.learnt.is_none() {
            self.candidate = None;
            self.learn(offset.min(expected), heard);
            return Some(delay);
        }
        let is_ahead = delay < 0;
        let needed = if is_ahead {
            CONFIRM_MICROS
        } else {
            CONFIRM_LAG_MICROS
        };
        if self.confirm(heard, stated, needed) {
            return Some(0);
        }
        (!is_ahead).then_some(delay)
    }

    /// Returns the offset that was learnt, as far as it may have drifted.
    fn expected(&self, heard: i64) -> Option<i64> {
        let learnt = self.learnt?;
        let passed = heard.saturating_sub(learnt.heard);
        Some(learnt.offset + (passed as f64 * QUARTZ_DRIFT) as i64)
    }

    fn learn(&mut self, offset: i64, heard: i64) {
        self.learnt = Some(Learnt { offset, heard });
    }

    /// Returns whether an offset other than the learnt one has held for long enough.
    fn confirm(&mut self, heard: i64, stated: i64, needed: i64) -> bool {
        let offset = heard.saturating_sub(stated);
        let held = self
            .candidate
            .filter(|candidate| candidate.offset.abs_diff(offset) <= STEP_MICROS.unsigned_abs());
        let Some(held) = held else {
            self.candidate = Some(Candidate {
                offset,
                heard,
                stated,
            });
            return false;
        };
        let passed = heard.saturating_sub(held.heard);
        let advanced = stated.saturating_sub(held.stated);
        // Times that stand still seem in step for a moment.
        if passed < needed || advanced.saturating_mul(2) < passed {
            return false;
        }
        self.candidate = None;
        self.learn(offset.min(held.offset), heard);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A source of a server, and its values by seconds.
    struct Server {
        clocks: StatedClocks,
        start: Instant,
    }

    impl Server {
        fn new() -> Server {
            Server {
                clocks: StatedClocks::default(),
                start: Instant::now(),
            }
        }

        fn at(stated_s: f64) -> Timestamp {
            Timestamp::from_micros(1_700_000_000_000_000 + (stated_s * 1e6) as i64).unwrap()
        }

        fn heard(&self, heard_s: f64) -> Instant {
            self.start + Duration::from_secs_f64(heard_s)
        }

        fn greet(&mut self, stated_s: f64, heard_s: f64) {
            let heard = self.heard(heard_s);
            self.clocks
                .note_greeting(&"sk".into(), Server::at(stated_s), heard);
        }

        /// Returns the age in seconds.
        fn age_s(&mut self, stated_s: f64, heard_s: f64) -> Option<f64> {
            let source = Source::of_sentence("sk".into(), *b"SK", *b"HDG");
            let heard = self.heard(heard_s);
            let age = self.clocks.age(&source, Some(Server::at(stated_s)), heard);
            age.map(|age| (age.as_secs_f64() * 10.0).round() / 10.0)
        }
    }

    #[test]
    fn without_a_stated_time_a_value_is_as_old_as_its_arrival() {
        let mut clocks = StatedClocks::default();
        let source = Source::of_sentence("line".into(), *b"HC", *b"HDG");
        let age = clocks.age(&source, None, Instant::now());
        assert_eq!(age, Some(Duration::ZERO));
    }

    #[test]
    fn a_cached_value_is_old_by_the_servers_greeting() {
        // The server's clock is wrong by years, which does not matter.
        let mut server = Server::new();
        server.greet(0.0, 0.0);
        assert_eq!(server.age_s(-3600.0, 0.01), None);
        assert_eq!(server.age_s(0.5, 0.6), Some(0.1));
        assert_eq!(server.age_s(0.5, 7.5), Some(7.0));
    }

    #[test]
    fn without_a_greeting_times_are_believed_when_they_advance_in_step() {
        let mut server = Server::new();
        assert_eq!(server.age_s(-3600.0, 0.0), None);
        assert_eq!(server.age_s(0.0, 0.1), None);
        assert_eq!(server.age_s(1.0, 1.1), None);
        assert_eq!(server.age_s(2.0, 2.1), Some(0.0));
        assert_eq!(server.age_s(2.5, 5.1), Some(2.5));
    }

    #[test]
    fn times_that_stand_still_or_run_fast_are_never_believed() {
        let mut still = Server::new();
        let mut fast = Server::new();
        for tenth in 0..3_000 {
            let heard_s = f64::from(tenth) / 10.0;
            assert_eq!(still.age_s(0.0, heard_s), None);
            assert_eq!(fast.age_s(60.0 * heard_s, heard_s), None);
        }
    }

    #[test]
    fn a_source_that_dies_behind_its_server_grows_old() {
        let mut server = Server::new();
        server.greet(0.0, 0.0);
        for second in 0..10 {
            let at = f64::from(second);
            assert_eq!(server.age_s(at, at), Some(0.0));
        }
        for second in 1..2_000 {
            let dead_s = f64::from(second);
            let age_s = server.age_s(9.0, 9.0 + dead_s).unwrap();
            assert!(age_s > 0.9 * dead_s, "{age_s} after {dead_s}");
        }
    }

    #[test]
    fn a_clock_put_forward_costs_two_seconds_and_one_put_back_ten_minutes() {
        let mut server = Server::new();
        for second in 0..5 {
            server.age_s(f64::from(second), f64::from(second));
        }
        let ages: Vec<_> = (5..9)
            .map(|second| server.age_s(86_400.0 + f64::from(second), f64::from(second)))
            .collect();
        assert_eq!(ages, [None, None, Some(0.0), Some(0.0)]);
        let believed = (9..1_000).find(|second| {
            let at = f64::from(*second);
            server.age_s(at, at).is_some_and(|age_s| age_s < 1.0)
        });
        assert_eq!(believed, Some(609));
    }

    #[test]
    fn a_quartz_that_drifts_is_followed() {
        let mut server = Server::new();
        server.greet(0.0, 0.0);
        for minute in 0..10_000 {
            let at = 60.0 * f64::from(minute);
            let age_s = server.age_s(at * (1.0 - 5e-5), at);
            assert!(age_s.is_some_and(|age_s| age_s < 0.1), "{age_s:?}");
        }
    }

    #[test]
    fn whole_seconds_are_times_too() {
        let mut sender = Server::new();
        let ages: Vec<_> = (0..100)
            .map(|tenth| {
                let at = f64::from(tenth) / 10.0;
                sender.age_s(at.floor(), at)
            })
            .collect();
        assert_eq!(ages[19], None);
        assert!(ages[21..].iter().all(|age| age.is_some_and(|s| s < 1.1)));
    }
}
