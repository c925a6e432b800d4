//! Clock of one recording: the time of its present line, for merging it with others.
//!
//! One wrong time stamp moves it by an hour at most. A larger step, and every step back, counts
//! when the next stamp confirms it.

use binnacle_compass::time::Timestamp;

/// Longest step that counts at once.
const MAX_STEP_S: f64 = 3_600.0;
/// Step back that counts as none: receivers differ by as much.
const TOLERANCE_S: f64 = 2.0;
/// Time after a step within which the next stamp confirms it.
const CONFIRM_S: f64 = 600.0;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FileClock {
    now: Option<Timestamp>,
    candidate: Option<Timestamp>,
}

impl FileClock {
    /// Returns the time, once there is one.
    pub(super) fn now(&self) -> Option<Timestamp> {
        self.now
    }

    /// Applies the next stamp of the recording.
    pub(super) fn observe(&mut self, stamp: Timestamp) {
        let Some(now) = self.now else {
            self.now = Some(stamp);
            return;
        };
        let step_s = stamp.seconds_since(now);
        if (0.0..=MAX_STEP_S).contains(&step_s) {
            (self.now, self.candidate) = (Some(stamp), None);
            return;
        }
        if (-TOLERANCE_S..0.0).contains(&step_s) {
            return;
        }
        let before = self.candidate.replace(stamp);
        let is_confirmed = before.is_some_and(|before| {
            (-TOLERANCE_S..=CONFIRM_S).contains(&stamp.seconds_since(before))
        });
        if is_confirmed {
            (self.now, self.candidate) = (Some(stamp), None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(seconds: &[i64]) -> Vec<i64> {
        let mut clock = FileClock::default();
        let run = seconds.iter().map(|second| {
            clock.observe(Timestamp::from_micros(second * 1_000_000).unwrap());
            clock.now().unwrap().micros() / 1_000_000
        });
        run.collect()
    }

    #[test]
    fn a_single_wrong_stamp_does_not_move_it() {
        let run = run(&[100, 101, 9_000_000, 102, 3, 103]);
        assert_eq!(run, [100, 101, 101, 102, 102, 103]);
    }

    #[test]
    fn a_pause_of_the_logger_is_followed_from_its_second_stamp() {
        assert_eq!(run(&[100, 90_000, 90_001]), [100, 100, 90_001]);
        assert_eq!(run(&[90_000, 100, 101, 102]), [90_000, 90_000, 101, 102]);
    }

    #[test]
    fn two_receivers_that_differ_do_not_disturb_it() {
        assert_eq!(run(&[100, 99, 101, 100]), [100, 100, 101, 101]);
    }
}
