//! Field that the hull retains: a share of the induced field of the hours before.

use super::row::Row;
use super::states::{BERTH, RETENTION, STATES};

/// Field retained at a row with its slopes, in ship axes: fore and aft, and athwartships.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Retained {
    pub(crate) field_nt: [f64; 2],
    /// Slopes by the shares of both memories, nT a per cent.
    pub(crate) by_share: [[f64; 2]; 2],
    /// Slope of each axis by that axis of the berth's direction, nT.
    pub(crate) by_berth: f64,
}

impl Retained {
    /// Returns what is retained at a row by a mean of the states.
    pub(crate) fn new(row: &Row, mean: &[f64; STATES]) -> Retained {
        let mut retained = Retained {
            field_nt: [0.0; 2],
            by_share: [[0.0; 2]; 2],
            by_berth: 0.0,
        };
        for memory in 0..2 {
            let share = mean[RETENTION + memory] / 100.0;
            let of_berth = row.berth_nt[memory];
            for axis in 0..2 {
                let lagged = row.lagged_nt[memory][axis] + of_berth * mean[BERTH + axis];
                retained.by_share[memory][axis] = lagged / 100.0;
                retained.field_nt[axis] += share * lagged;
            }
            retained.by_berth += share * of_berth;
        }
        retained
    }
}
