//! What the ship's clock and the computer's said when it was last noted: after a restart a
//! receiver's first time stamp is held against it.
//!
//! What always holds: a stamp is in doubt only where there is a reason. A computer whose
//! clock was the ship's, and has not gone back since, knows the date. One that has lost
//! its time with its power knows that it is later than it was. Where the two differed, as
//! with instruments that are simulated, nothing is known.

use binnacle_magnetics::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Two clocks that are the same.
const AGREEMENT_S: f64 = 3_600.0;
/// A date this near is right, whatever the hour.
const DAY_S: f64 = 86_400.0;
/// No ship is laid up for longer, with her computer off.
const YEAR_S: f64 = 366.0 * DAY_S;

/// Both clocks at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClockCheckpoint {
    /// The ship's.
    pub(crate) ship: Timestamp,
    /// The computer's.
    pub(crate) computer: Timestamp,
}

impl ClockCheckpoint {
    /// The time that it must be about, if a first stamp cannot be right.
    pub(crate) fn contradict(self, stamp: Timestamp, computer: Timestamp) -> Option<Timestamp> {
        if computer.seconds_since(self.ship) < -AGREEMENT_S {
            let later_s = stamp.seconds_since(self.ship);
            let is_possible = (-DAY_S..=YEAR_S).contains(&later_s);
            return (!is_possible).then_some(self.ship);
        }
        let agreed = self.ship.seconds_since(self.computer).abs() <= AGREEMENT_S;
        let is_near = stamp.seconds_since(computer).abs() <= DAY_S;
        (agreed && !is_near).then_some(computer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(days: f64) -> Timestamp {
        let start = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        start.plus_seconds(days * DAY_S)
    }

    /// Noted at 0 by both.
    const fn noted(ship: Timestamp, computer: Timestamp) -> ClockCheckpoint {
        ClockCheckpoint { ship, computer }
    }

    #[test]
    fn a_computer_that_was_right_knows_the_date() {
        let both = noted(at(0.0), at(0.01));
        for laid_up in [0.1, 20.0, 900.0] {
            let now = at(laid_up);
            for right in [-0.9, 0.0, 0.9] {
                assert_eq!(both.contradict(at(laid_up + right), now), None);
            }
            for wrong in [-17_000.0, -7_168.0, -7.0, 7.0, 7_305.0] {
                let known = both.contradict(at(laid_up + wrong), now);
                assert_eq!(known, Some(now), "{wrong}");
            }
        }
    }

    #[test]
    fn a_computer_that_lost_its_time_knows_that_it_is_later_than_it_was() {
        // It was right before, or has never been.
        for computer in [at(0.0), at(-9_000.0)] {
            let both = noted(at(0.0), computer);
            let now = at(-9_000.0);
            for right in [-0.9, 0.0, 7.0, 300.0] {
                assert_eq!(both.contradict(at(right), now), None);
            }
            for wrong in [-17_000.0, -7.0, 7_305.0] {
                let known = both.contradict(at(wrong), now);
                assert_eq!(known, Some(at(0.0)), "{wrong}");
            }
        }
    }

    #[test]
    fn of_a_voyage_of_long_ago_nothing_is_known() {
        let both = noted(at(-400.0), at(0.0));
        for stamp in [-400.0, -410.0, -10.0, 500.0] {
            assert_eq!(both.contradict(at(stamp), at(0.1)), None);
        }
    }
}
