//! Best setting found for each number of moves.

use crate::binnacle::Setting;
use serde::{Deserialize, Serialize};

/// Better by less is not looked for, degrees.
pub(crate) const SLACK_DEG: f64 = 0.005;

/// No setting takes more moves.
const MOST_MOVES: usize = 32;

/// How well the search knows that nothing is better.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Optimality {
    /// Whether every setting of the catalogue was gone through or excluded: none is better
    /// by more than a gap that no card shows.
    pub proven: bool,
    /// No setting's worst residual, weighted over the waters, is better than the best
    /// plan's by more than this, degrees.
    pub gap_deg: f64,
    /// Boxes of settings that were looked at.
    pub nodes: u64,
    /// Most trays or holes of fore-and-aft and athwartship magnets in use at once.
    pub trays_in_use: [u8; 2],
}

/// The best for a number of moves.
#[derive(Clone, Debug)]
pub(crate) struct BestSetting {
    pub(crate) setting: Setting,
    pub(crate) moves: u32,
    pub(crate) worst_deg: f64,
}

/// For every number of moves the best found with no more of them.
pub(crate) struct ParetoFront {
    best: Vec<Option<BestSetting>>,
    pub(crate) optimality: Optimality,
    /// The least bound of what was not looked at.
    pub(crate) left_out_deg: f64,
}

impl ParetoFront {
    pub(crate) fn new() -> ParetoFront {
        ParetoFront {
            best: vec![None; MOST_MOVES],
            optimality: Optimality {
                proven: true,
                gap_deg: SLACK_DEG,
                nodes: 0,
                trays_in_use: [0; 2],
            },
            left_out_deg: f64::INFINITY,
        }
    }

    /// What is to be beaten with so many moves.
    pub(crate) fn at(&self, moves: u32) -> f64 {
        let known = self.best[..=(moves as usize).min(MOST_MOVES - 1)]
            .iter()
            .flatten();
        known
            .map(|found| found.worst_deg)
            .fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn offer(&mut self, moves: u32, worst_deg: f64, setting: impl FnOnce() -> Setting) {
        if worst_deg < self.at(moves) && (moves as usize) < MOST_MOVES {
            self.best[moves as usize] = Some(BestSetting {
                setting: setting(),
                moves,
                worst_deg,
            });
        }
    }

    /// Each better than all with fewer moves, fewest moves first.
    pub(crate) fn undominated(&self) -> Vec<&BestSetting> {
        let mut found: Vec<&BestSetting> = Vec::new();
        for next in self.best.iter().flatten() {
            if found
                .last()
                .is_none_or(|last| next.worst_deg < last.worst_deg)
            {
                found.push(next);
            }
        }
        found
    }
}
