//! Readings of the GNSS clock and the computer's clock, saved before a restart. A receiver's first
//! time stamp is checked against them.
//!
//! Invariant: a stamp is uncertain only for a reason. A computer whose clock agreed with GNSS, and
//! has not gone back since, knows the date. A computer that lost its time with its power knows that
//! it is later than the checkpoint. Where the two clocks differed, as with simulated instruments,
//! nothing is known.

use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Difference up to which the two clocks agree.
const AGREEMENT_S: f64 = 3_600.0;
/// Difference up to which a date is right, whatever the hour.
const DAY_S: f64 = 86_400.0;
/// Longest lay-up of a vessel with its computer off.
const YEAR_S: f64 = 366.0 * DAY_S;

/// Both clocks at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClockCheckpoint {
    /// GNSS time.
    pub ship: Timestamp,
    /// Computer's time.
    pub computer: Timestamp,
}

impl ClockCheckpoint {
    /// Returns the approximate true time if a first stamp cannot be right.
    pub fn contradict(self, stamp: Timestamp, computer: Timestamp) -> Option<Timestamp> {
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

    /// A checkpoint at 0.
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
        // The computer was right before, or never was.
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
