//! The choices that the bound leaves open.

use super::bound::Bound;
use super::problem::Problem;

/// No further round where the gap is at most this fraction (1/x) of the cost:
/// half a per cent.
const SMALL_GAP: i64 = 200;
/// Above this number of open choices, neighbourhoods find next to nothing.
const MANY_OPEN: usize = 5_000;
/// With that many, no round where the gap is at most this fraction (1/x) of the
/// cost: one per cent.
const SMALL_GAP_OF_MANY: i64 = 100;

/// The choices that a better assignment may contain.
pub(super) struct Open {
    /// Open choices, including those of the current assignment.
    pub(super) choices: Vec<bool>,
    /// Needs that may be left unmet.
    pub(super) unmet: Vec<bool>,
}

impl Open {
    /// Returns true if the gap is too small for a round over the neighbourhoods. A
    /// small problem always gets one round, which may prove it optimal.
    pub(super) fn is_enough(&self, round: usize, gap: i64, cost: i64) -> bool {
        let many = self.choices.iter().filter(|open| **open).count() > MANY_OPEN;
        if many {
            gap * SMALL_GAP_OF_MANY <= cost
        } else {
            round > 0 && gap * SMALL_GAP <= cost
        }
    }

    pub(super) fn from_bound(
        problem: &Problem,
        bound: &Bound,
        found: &[Option<usize>],
        cost: i64,
    ) -> Open {
        let gap = cost - bound.cost;
        let choices = problem.choices.iter().zip(&bound.reduced).enumerate();
        Open {
            choices: choices
                .map(|(index, (choice, reduced))| {
                    *reduced < gap || found[choice.need] == Some(index)
                })
                .collect(),
            unmet: bound.reduced_unmet.iter().map(|it| *it < gap).collect(),
        }
    }
}
