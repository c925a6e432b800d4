//! Result of a step's check.

use crate::adjust::diagnosis::turn_sd_deg;
use crate::adjust::planning::Outcome;
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::deviation::NORMAL_95;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Relative precision above which an effect counts as hardly proven, 95 %.
const PROVES_LITTLE: f64 = 0.3;

/// Result of a step's check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum StepCheck {
    /// The step had the expected effect: the next one may follow.
    Confirmed {
        /// Observed less expected turn, degrees.
        off_deg: f64,
        /// Evidence for the corrector's effect, which may be weak.
        proven: ProvenEffect,
    },
    /// The compass does not show the step on this heading, and showed nothing.
    NotSeen {
        /// Expected turn, degrees.
        expected_deg: f64,
    },
    /// The magnets have the wrong end: they must be reversed.
    WrongEnd {
        /// Observed turn, degrees.
        turned_deg: f64,
        /// Actual setting.
        setting: Setting,
        /// Plan from there.
        outcome: Box<Outcome>,
    },
    /// The magnets stood with the other end before the step than recorded: the plan was made
    /// for another ship.
    FoundOtherwise {
        /// Observed turn, degrees.
        turned_deg: f64,
        /// Binnacle with the setting as it was at the reading.
        binnacle: Box<Binnacle>,
        /// Actual setting.
        setting: Setting,
        /// Plan from there.
        outcome: Box<Outcome>,
    },
    /// The corrector has another strength than assumed: there is a new plan.
    OtherStrength {
        /// Strength as a share of the assumed one.
        share: f64,
        /// Standard error of the share.
        share_sd: f64,
        /// Nearby hole in which the assumed strength would have the same effect.
        other_hole: Option<u16>,
        /// True if magnets that stood with the other end than recorded would have the same effect.
        or_found_otherwise: bool,
        /// Binnacle with the found strength.
        binnacle: Box<Binnacle>,
        /// Actual setting.
        setting: Setting,
        /// Plan from there.
        outcome: Box<Outcome>,
    },
    /// No plausible strength explains the turn: read again, check whether the vessel moved,
    /// look for retentive magnetism in the iron.
    Unexplained {
        /// Observed less expected turn, degrees.
        off_deg: f64,
        /// Unmoved card: the step was perhaps not done, or the card sticks.
        unmoved: bool,
    },
}

/// Evidence for a corrector's effect from two readings of the card.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProvenEffect {
    /// Effect as a share of the assumed one.
    pub share: f64,
    /// Precision of the share from the two readings, 95 %.
    #[serde(rename = "to")]
    pub precision: f64,
}

/// Total turn by all steps, read as precisely as a single one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TotalTurn {
    /// Observed turn since the berth was read, degrees.
    pub turned_deg: f64,
    /// Expected turn, degrees.
    pub expected_deg: f64,
    /// Difference, degrees.
    pub off_deg: f64,
    /// Tolerance, degrees: exceeded by correct steps once in a hundred.
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
                "{share:.0} per cent of the expected turn; on this heading the card shows that \
                 only to within {to:.0} per cent, which proves little"
            );
        }
        write!(
            f,
            "{share:.0} per cent of the expected turn, to within {to:.0} per cent"
        )
    }
}

impl TotalTurn {
    /// Returns true when the errors explain the difference.
    pub fn agrees(&self) -> bool {
        self.off_deg.abs() <= self.tolerance_deg
    }
}

impl fmt::Display for TotalTurn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "in all, the compass turned by {:.1} degrees since the berth was read, while {:.1} \
             were expected (within {:.1})",
            self.turned_deg, self.expected_deg, self.tolerance_deg
        )
    }
}
