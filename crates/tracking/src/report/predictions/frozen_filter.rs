//! Filter that predicts the rows of a watch from what was known before, and reads none of them.
//!
//! With weights w, loads l and states x of the rows, the error of the weighted mean is
//! Σ w l·x over the weights, and noise. The sum's covariance with the states goes along from row
//! to row, so that the variance of the mean is exact, whatever memories the errors have.

use crate::constants::NEGLIGIBLE;
use crate::hypotheses::hypothesis::Hypothesis;
use crate::state_space::arrays::vector;
use crate::state_space::filter::{Filter, Innovation};
use crate::state_space::levels::Levels;
use crate::state_space::row::Row;
use crate::state_space::scalar::{Silent, deviation};
use crate::state_space::states::{ALIGNMENT, STATES, dot};
use crate::state_space::transition::{Pair, Transition};
use binnacle_compass::ship::PARAMETERS;
use serde::{Deserialize, Serialize};

/// Slopes of a deviation by the ship's parameters, over the population, and the alignment, a
/// degree.
pub(crate) type ShipLoad = [f64; PARAMETERS + 1];

/// Prediction of the mean of a watch's rows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FrozenFilter {
    filter: Filter,
    /// Covariance of the states with the weighted sum of the predictions.
    #[serde(with = "vector")]
    with_sum: [f64; STATES],
    /// Variance of that sum.
    variance: f64,
    /// Weighted sums of readings less predictions, of their own noise, and of the weights.
    error: f64,
    white: f64,
    weight: f64,
    /// Weighted sum of the loads of the ship's states.
    load: ShipLoad,
}

impl FrozenFilter {
    /// Takes what all hypotheses expect, as one filter; none without a hypothesis.
    pub(crate) fn new(bank: &[Hypothesis]) -> Option<FrozenFilter> {
        let best = bank.iter().map(Hypothesis::log_weight).reduce(f64::max)?;
        let mut mixed: Option<(Filter, f64)> = None;
        for hypothesis in bank {
            let weight = (hypothesis.log_weight() - best).exp();
            if weight < (-NEGLIGIBLE).exp() {
                continue;
            }
            mixed = Some(match mixed {
                None => (hypothesis.filter.clone(), weight),
                Some((filter, total)) => {
                    let total = total + weight;
                    (filter.mixed_with(&hypothesis.filter, weight / total), total)
                }
            });
        }
        Some(FrozenFilter {
            filter: mixed?.0,
            with_sum: [0.0; STATES],
            variance: 0.0,
            error: 0.0,
            white: 0.0,
            weight: 0.0,
            load: [0.0; PARAMETERS + 1],
        })
    }

    /// Rounds the filter to what is kept of it.
    pub(crate) fn round(&mut self) {
        self.filter.round();
        self.with_sum = self.with_sum.map(|x| f64::from(x as f32));
    }

    /// Adds the next row, of a weight that is small where its reading is wild.
    pub(crate) fn add(&mut self, row: &Row, levels: &Levels, weight: f64) {
        let transition = Transition::to(row, levels);
        self.filter.advance(&transition);
        carry(&mut self.with_sum, &transition);
        let scalar = deviation(row, &self.filter.mean, levels, Silent::default());
        let spread = self.filter.spread(&scalar.load);
        self.variance += weight * weight * dot(&scalar.load, &spread)
            + 2.0 * weight * dot(&scalar.load, &self.with_sum);
        for (sum, x) in self.with_sum.iter_mut().zip(&spread) {
            *sum += weight * x;
        }
        self.error += weight * scalar.innovation;
        self.white += weight * weight * scalar.variance;
        self.weight += weight;
        let ship = scalar.load[..PARAMETERS].iter();
        for (sum, x) in self
            .load
            .iter_mut()
            .zip(ship.chain([&scalar.load[ALIGNMENT]]))
        {
            *sum += weight * x;
        }
    }

    /// Returns the mean slopes of the rows by the ship; not a number without a row.
    pub(crate) fn ship_load(&self) -> ShipLoad {
        self.load.map(|sum| sum / self.weight)
    }

    /// Returns the mean of the rows less its prediction; none without a row.
    pub(crate) fn mean(&self) -> Option<Innovation> {
        let square = self.weight * self.weight;
        (self.weight > 0.0).then(|| Innovation {
            value: self.error / self.weight,
            variance: (self.variance + self.white) / square,
        })
    }
}

/// Moves a covariance with the states on in time.
fn carry(vector: &mut [f64; STATES], transition: &Transition) {
    for (x, keep) in vector.iter_mut().zip(&transition.keep) {
        *x *= keep;
    }
    for Pair { state, matrix, .. } in transition.pairs() {
        let [value, rate] = [vector[*state], vector[state + 1]];
        for (x, [by_value, by_rate]) in vector[*state..].iter_mut().zip(matrix) {
            *x = by_value * value + by_rate * rate;
        }
    }
}
