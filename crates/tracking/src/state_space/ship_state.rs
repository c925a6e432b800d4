//! The ship's magnetism and the compass's alignment at a time, as a model.

use super::filter::Filter;
use super::retained::Retained;
use super::row::Row;
use super::states::{
    ALIGNMENT, BERTH, BX, BY, HEEL, HEEL_NT_PER_RAD, LIST, LIST_NT, RETENTION, STATES,
};
use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_compass::model::{Covariance, Parameters};
use binnacle_compass::ship::PARAMETERS;
use serde::{Deserialize, Serialize};

/// Number of values: the seven parameters, and the constant.
const VALUES: usize = PARAMETERS + 1;
/// Turn of the compass by which a slope is taken, degrees.
const STEP_DEG: f64 = 0.01;

/// Seven parameters over λ and the compass's alignment, in the units of [`Covariance`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ShipState {
    pub(crate) mean: [f64; VALUES],
    pub(crate) covariance: Covariance,
}

impl ShipState {
    /// Takes the ship from a filter, in the circumstances of a row: what the hull retains, and
    /// its list.
    pub(crate) fn from_filter(filter: &Filter, row: &Row) -> ShipState {
        let retained = Retained::new(row, &filter.mean);
        let map = map(row, &retained);
        let apply = |vector: &[f64; STATES]| -> [f64; VALUES] {
            std::array::from_fn(|i| map[i].iter().zip(vector).map(|(m, x)| m * x).sum())
        };
        let mut mean = apply(&filter.mean);
        // What the berth left is a product of two states: both slopes count it.
        mean[BX] -= retained.by_berth * filter.mean[BERTH];
        mean[BY] -= retained.by_berth * filter.mean[BERTH + 1];
        let rows = map.map(|row| filter.spread(&row));
        let covariance = rows.map(|row| apply(&row));
        ShipState { mean, covariance }
    }

    /// Returns the mixture of weighted states.
    pub(crate) fn mixed(states: &[ShipState], weights: &[f64]) -> ShipState {
        let total: f64 = weights.iter().sum();
        let mut mean = [0.0; VALUES];
        for (state, weight) in states.iter().zip(weights) {
            for (sum, x) in mean.iter_mut().zip(state.mean) {
                *sum += x * weight / total;
            }
        }
        let mut covariance = [[0.0; VALUES]; VALUES];
        for (state, weight) in states.iter().zip(weights) {
            let off: [f64; VALUES] = std::array::from_fn(|i| state.mean[i] - mean[i]);
            for i in 0..VALUES {
                for j in 0..VALUES {
                    covariance[i][j] += (state.covariance[i][j] + off[i] * off[j]) * weight / total;
                }
            }
        }
        ShipState { mean, covariance }
    }

    /// Returns the same ship in the compass's axes: a compass whose zero lies off sees the
    /// ship's iron turned (docs/science.md, eq. 17).
    pub(crate) fn in_compass_axes(&self) -> ShipState {
        let turned = |values: &[f64; VALUES]| -> [f64; VALUES] {
            let parameters = Parameters::from_array(std::array::from_fn(|j| values[j]));
            let rad = -values[PARAMETERS].to_radians();
            let parameters = parameters.with_compass_turned(rad).to_array();
            std::array::from_fn(|j| {
                if j < PARAMETERS {
                    parameters[j]
                } else {
                    values[PARAMETERS]
                }
            })
        };
        let mean = turned(&self.mean);
        let mut slopes = [[0.0; VALUES]; VALUES];
        for j in 0..VALUES {
            let step = if j < PARAMETERS {
                POPULATION_SD[j]
            } else {
                STEP_DEG
            };
            let mut moved = self.mean;
            moved[j] += step;
            let moved = turned(&moved);
            for i in 0..VALUES {
                slopes[i][j] = (moved[i] - mean[i]) / step;
            }
        }
        ShipState {
            mean,
            covariance: sandwich(&slopes, &self.covariance),
        }
    }

    pub(crate) fn parameters(&self) -> Parameters {
        Parameters::from_array(std::array::from_fn(|j| self.mean[j]))
    }
}

fn sandwich(slopes: &Covariance, covariance: &Covariance) -> Covariance {
    let half: Covariance = std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..VALUES).map(|k| slopes[i][k] * covariance[k][j]).sum())
    });
    let whole: Covariance = std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..VALUES).map(|k| half[i][k] * slopes[j][k]).sum())
    });
    std::array::from_fn(|i| std::array::from_fn(|j| f64::midpoint(whole[i][j], whole[j][i])))
}

/// Returns the slopes of the values by the filter's states.
fn map(row: &Row, retained: &Retained) -> [[f64; STATES]; VALUES] {
    let mut map = [[0.0; STATES]; VALUES];
    for j in 0..PARAMETERS {
        map[j][j] = POPULATION_SD[j];
    }
    for (memory, by_share) in retained.by_share.iter().enumerate() {
        map[BX][RETENTION + memory] = by_share[0];
        map[BY][RETENTION + memory] = by_share[1];
    }
    map[BX][BERTH] = retained.by_berth;
    map[BY][BERTH + 1] = retained.by_berth;
    map[BY][LIST] = LIST_NT;
    map[BY][HEEL] = HEEL_NT_PER_RAD * row.roll_rad.unwrap_or(0.0);
    map[PARAMETERS][ALIGNMENT] = 1.0;
    map
}
