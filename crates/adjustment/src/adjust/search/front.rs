//! Best setting found for each number of moves.

use crate::binnacle::Setting;
use serde::{Deserialize, Serialize};

/// Least improvement that the search looks for, degrees.
pub(crate) const SLACK_DEG: f64 = 0.005;

/// Greatest number of moves of a setting.
const MOST_MOVES: usize = 32;

/// Optimality of the search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlanOptimality))]
pub struct Optimality {
    /// Proven: every setting was tried or excluded, and none is better by more than a gap
    /// that no card shows.
    pub proven: bool,
    /// Greatest possible improvement over the best plan's worst residual with its band,
    /// weighted over the waters, degrees.
    pub gap_deg: f64,
    /// Number of boxes of settings in the search.
    pub nodes: u64,
    /// Greatest number of trays or holes of fore-and-aft and athwartship magnets in use at
    /// once.
    pub trays_in_use: [u8; 2],
}

/// Best setting for a number of moves.
#[derive(Clone, Debug)]
pub(crate) struct BestSetting {
    pub(crate) setting: Setting,
    pub(crate) moves: u32,
    /// Worst residual with the band of the soft iron, weighted over the waters, degrees.
    pub(crate) reach_deg: f64,
}

/// Best setting for each number of moves.
pub(crate) struct ParetoFront {
    best: Vec<Option<BestSetting>>,
    pub(crate) optimality: Optimality,
    /// Least bound of the untried settings.
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

    /// Returns the best residual with its band, with at most this number of moves.
    pub(crate) fn at(&self, moves: u32) -> f64 {
        let known = self.best[..=(moves as usize).min(MOST_MOVES - 1)]
            .iter()
            .flatten();
        known
            .map(|found| found.reach_deg)
            .fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn offer(&mut self, moves: u32, reach_deg: f64, setting: impl FnOnce() -> Setting) {
        if reach_deg < self.at(moves) && (moves as usize) < MOST_MOVES {
            self.best[moves as usize] = Some(BestSetting {
                setting: setting(),
                moves,
                reach_deg,
            });
        }
    }

    /// Lists the settings that are each better than all with fewer moves, fewest moves
    /// first.
    pub(crate) fn undominated(&self) -> Vec<&BestSetting> {
        let mut found: Vec<&BestSetting> = Vec::new();
        for next in self.best.iter().flatten() {
            if found
                .last()
                .is_none_or(|last| next.reach_deg < last.reach_deg)
            {
                found.push(next);
            }
        }
        found
    }
}
