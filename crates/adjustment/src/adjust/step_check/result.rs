//! Result of a step's check.

use crate::adjust::diagnosis::turn_sd_deg;
use crate::adjust::planning::Outcome;
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::deviation::NORMAL_95;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What tells an effect no better, 95 %, is said to prove little.
const PROVES_LITTLE: f64 = 0.3;

/// What a step came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum StepCheck {
    /// It did what was expected: the next one may follow.
    Confirmed {
        /// By how much it turned less than, or beyond, what was expected, degrees.
        off_deg: f64,
        /// What that tells of the corrector, which may be little.
        proven: ProvenEffect,
    },
    /// On this heading the compass does not show it, and showed nothing.
    NotSeen {
        /// What it would have turned by, degrees.
        expected_deg: f64,
    },
    /// The magnets are in with the wrong end: turn them.
    WrongEnd {
        /// What the compass turned by, degrees.
        turned_deg: f64,
        /// How the correctors stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// The corrector is of another strength than was taken: the plan is a new one.
    OtherStrength {
        /// Its strength as a share of what was taken.
        share: f64,
        /// Standard error of that.
        share_sd: f64,
        /// The hole near by in which one as strong as was taken would show the same.
        other_hole: Option<u16>,
        /// The binnacle as it is now believed to be.
        binnacle: Box<Binnacle>,
        /// How the correctors stand.
        setting: Setting,
        /// A plan from there.
        outcome: Box<Outcome>,
    },
    /// No strength that it can have explains it: read again, see whether the ship moved, look for
    /// magnetism of its own in the iron.
    Unexplained {
        /// By how much it is off, degrees.
        off_deg: f64,
        /// Whether the card stands as it stood: the step was perhaps not done, or the
        /// card sticks.
        unmoved: bool,
    },
}

/// What two readings of the card tell of what a corrector does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProvenEffect {
    /// Its effect as a share of what was taken.
    pub share: f64,
    /// How well the two readings tell that, 95 %, as a share of what was taken.
    #[serde(rename = "to")]
    pub precision: f64,
}

/// What all steps together have done to the compass, which is read no worse for it than
/// after one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TotalTurn {
    /// By how much it turned since the berth was read, degrees.
    pub turned_deg: f64,
    /// By how much it should have, degrees.
    pub expected_deg: f64,
    /// The difference, degrees.
    pub off_deg: f64,
    /// Right steps differ by more once in a hundred, degrees.
    pub tolerance_deg: f64,
}

impl ProvenEffect {
    pub(crate) fn new(turned_deg: f64, expected_deg: f64, h_nt: f64) -> ProvenEffect {
        ProvenEffect {
            share: turned_deg / expected_deg,
            precision: NORMAL_95 * turn_sd_deg(h_nt) / expected_deg.abs(),
        }
    }
}

impl fmt::Display for ProvenEffect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.share;
        let to = 100.0 * self.precision;
        if self.precision > PROVES_LITTLE {
            return write!(
                f,
                "{share:.0} per cent of what was expected; on this heading the card tells that \
                 only to within {to:.0} per cent, which proves little"
            );
        }
        write!(
            f,
            "{share:.0} per cent of what was expected, to within {to:.0} per cent"
        )
    }
}

impl TotalTurn {
    /// Whether errors explain it.
    pub fn agrees(&self) -> bool {
        self.off_deg.abs() <= self.tolerance_deg
    }
}

impl fmt::Display for TotalTurn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "in all the compass turned by {:.1} degrees since the berth was read, where {:.1} \
             were expected (to {:.1})",
            self.turned_deg, self.expected_deg, self.tolerance_deg
        )
    }
}
