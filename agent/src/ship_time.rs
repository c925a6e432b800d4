//! The ship's clock: what her GNSS receivers say, and nothing else.
//!
//! It never runs backwards without saying so, and one wrong time stamp does not
//! move it: a jump counts when a second stamp bears it out. Recorded and
//! accelerated data work because no other clock is asked.

use binnacle_magnetics::time::Timestamp;

/// Two receivers, or two sentences, may differ by so much.
const SLACK_S: f64 = 2.0;
/// A step forward beyond this is not mere silence.
const LONGEST_STEP_S: f64 = 600.0;
/// A jump is borne out by a stamp that follows within this.
const CONFIRM_S: f64 = 60.0;
/// 1980-01-06, when GPS time begins, and 2100-01-01.
const PLAUSIBLE_MICROS: std::ops::Range<i64> = 315_964_800_000_000..4_102_444_800_000_000;

/// What a time stamp did to the clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// Nothing.
    Held,
    /// Time went on.
    Advanced(Timestamp),
    /// Time is another altogether: what was open is void.
    Jumped(Timestamp),
}

/// One clock from ranked sources of time.
#[derive(Debug)]
pub(crate) struct ShipClock {
    now: Option<Timestamp>,
    suspect: Option<Timestamp>,
    stale_s: f64,
    active: usize,
    /// For each rank: what it first said since the active source was heard.
    waiting: Vec<Option<Timestamp>>,
}

impl ShipClock {
    /// A clock that has not been set, with sources of rank 0 to `ranks - 1`.
    pub(crate) fn new(ranks: usize, stale_s: f64) -> ShipClock {
        ShipClock {
            now: None,
            suspect: None,
            stale_s,
            active: ranks.saturating_sub(1),
            waiting: vec![None; ranks],
        }
    }

    /// The ship's time, once it is known.
    pub(crate) fn now(&self) -> Option<Timestamp> {
        self.now
    }

    /// Takes a time stamp from the source of a rank, 0 being the best.
    pub(crate) fn observe(&mut self, rank: usize, stamp: Timestamp) -> Step {
        if !PLAUSIBLE_MICROS.contains(&stamp.micros()) || rank >= self.waiting.len() {
            return Step::Held;
        }
        if !self.may_set(rank, stamp) {
            return Step::Held;
        }
        self.set(stamp)
    }

    /// The active source and better ones may; a worse one when the active one
    /// has been silent for long, by the worse one's own time.
    fn may_set(&mut self, rank: usize, stamp: Timestamp) -> bool {
        if rank > self.active && self.now.is_some() {
            let since = *self.waiting[rank].get_or_insert(stamp);
            if stamp.seconds_since(since).abs() < self.stale_s {
                return false;
            }
        }
        self.active = rank;
        self.waiting.fill(None);
        true
    }

    fn set(&mut self, stamp: Timestamp) -> Step {
        let Some(now) = self.now else {
            self.now = Some(stamp);
            return Step::Advanced(stamp);
        };
        let step_s = stamp.seconds_since(now);
        if (0.0..=LONGEST_STEP_S).contains(&step_s) {
            self.suspect = None;
            if step_s == 0.0 {
                return Step::Held;
            }
            self.now = Some(stamp);
            return Step::Advanced(stamp);
        }
        if (-SLACK_S..0.0).contains(&step_s) {
            return Step::Held;
        }
        let confirmed = self
            .suspect
            .replace(stamp)
            .is_some_and(|suspect| (0.0..=CONFIRM_S).contains(&stamp.seconds_since(suspect)));
        if !confirmed {
            return Step::Held;
        }
        self.suspect = None;
        self.now = Some(stamp);
        Step::Jumped(stamp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_micros((1_700_000_000 + seconds) * 1_000_000).unwrap()
    }

    #[test]
    fn one_wrong_stamp_moves_nothing() {
        let mut clock = ShipClock::new(1, 15.0);
        assert_eq!(clock.observe(0, at(0)), Step::Advanced(at(0)));
        assert_eq!(clock.observe(0, at(86_400 * 3000)), Step::Held);
        assert_eq!(clock.observe(0, at(-7200)), Step::Held);
        assert_eq!(clock.observe(0, at(1)), Step::Advanced(at(1)));
    }

    #[test]
    fn a_jump_that_is_borne_out_is_a_jump() {
        for jump in [-7200, -30, 601, 86_400] {
            let mut clock = ShipClock::new(1, 15.0);
            clock.observe(0, at(0));
            assert_eq!(clock.observe(0, at(jump)), Step::Held);
            assert_eq!(clock.observe(0, at(jump + 1)), Step::Jumped(at(jump + 1)));
            assert_eq!(clock.observe(0, at(jump + 2)), Step::Advanced(at(jump + 2)));
        }
    }

    #[test]
    fn a_second_receiver_a_little_behind_is_no_jump() {
        let mut clock = ShipClock::new(1, 15.0);
        clock.observe(0, at(10));
        for _ in 0..5 {
            assert_eq!(clock.observe(0, at(9)), Step::Held);
        }
        assert_eq!(clock.now(), Some(at(10)));
    }

    #[test]
    fn a_worse_source_takes_over_after_silence_and_hands_back_at_once() {
        let mut clock = ShipClock::new(2, 15.0);
        clock.observe(0, at(0));
        assert_eq!(clock.observe(1, at(5000)), Step::Held);
        clock.observe(0, at(1));
        for second in 2..17 {
            assert_eq!(clock.observe(1, at(second)), Step::Held);
        }
        assert_eq!(clock.observe(1, at(17)), Step::Advanced(at(17)));
        assert_eq!(clock.observe(0, at(18)), Step::Advanced(at(18)));
        assert_eq!(clock.observe(1, at(19)), Step::Held);
    }

    #[test]
    fn a_date_before_gps_is_not_believed() {
        let mut clock = ShipClock::new(1, 15.0);
        let year_1850 = Timestamp::parse("1850-06-01T00:00:00Z").unwrap();
        for _ in 0..3 {
            assert_eq!(clock.observe(0, year_1850), Step::Held);
        }
        assert_eq!(clock.now(), None);
    }
}
