//! Kalman filter over all states.

use super::arrays::{matrix, vector};
use super::scalar::Scalar;
use super::states::{STATES, dot};
use super::transition::{Gain, Pair, Transition};
use binnacle_analysis::estimate::{heavy_tailed_loss, weight};
use serde::{Deserialize, Serialize};

/// Factor of the variances when a covariance is rounded: each of the other states may take half a
/// step of single precision (Gershgorin).
const ROUNDED: f64 = 1.0 + STATES as f64 * f32::EPSILON as f64;

/// Mean and covariance of the states, and the log likelihood of what was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Filter {
    #[serde(with = "vector")]
    pub(crate) mean: [f64; STATES],
    /// Boxed, because filters change places.
    #[serde(with = "matrix")]
    pub(crate) covariance: Box<[[f64; STATES]; STATES]>,
    pub(crate) log_likelihood: f64,
}

/// Outcome of one reading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Innovation {
    /// Reading less its prediction.
    pub(crate) value: f64,
    /// Variance of the prediction, the reading's noise in it.
    pub(crate) variance: f64,
}

impl Innovation {
    /// Returns the loss of a reading with tails as heavy as instruments have.
    pub(crate) fn loss(self) -> f64 {
        heavy_tailed_loss(self.z_squared())
    }

    /// Returns the square in standard deviations.
    pub(crate) fn z_squared(self) -> f64 {
        self.value * self.value / self.variance
    }
}

impl Filter {
    /// Makes a filter of independent states from means and standard deviations.
    pub(crate) fn new(mean: &[f64; STATES], sd: &[f64; STATES]) -> Filter {
        let mut covariance = Box::new([[0.0; STATES]; STATES]);
        for (i, sd) in sd.iter().enumerate() {
            covariance[i][i] = sd * sd;
        }
        Filter {
            mean: *mean,
            covariance,
            log_likelihood: 0.0,
        }
    }

    /// Rounds mean and covariance to what is kept of them: single precision, by half of the
    /// matrix. The variances are raised by more than the rounding of all else can take.
    pub(crate) fn round(&mut self) {
        let single = |x: f64| f64::from(x as f32);
        self.mean = self.mean.map(single);
        for i in 0..STATES {
            self.covariance[i][i] = single(self.covariance[i][i] * ROUNDED);
            for j in 0..i {
                self.covariance[j][i] = single(self.covariance[j][i]);
                self.covariance[i][j] = self.covariance[j][i];
            }
        }
    }

    /// Moves on in time.
    pub(crate) fn advance(&mut self, t: &Transition) {
        for (x, keep) in self.mean.iter_mut().zip(&t.keep) {
            *x *= keep;
        }
        for (row, keep) in self.covariance.iter_mut().zip(&t.keep) {
            for (x, other) in row.iter_mut().zip(&t.keep) {
                *x *= keep * other;
            }
        }
        for pair in t.pairs() {
            self.turn(pair);
        }
        for gain in t.gains.iter().flatten() {
            self.gain(gain);
        }
        for (i, variance) in t.added.iter().enumerate() {
            self.covariance[i][i] += variance;
        }
    }

    /// Lets a state gain a share of another.
    fn gain(&mut self, gain: &Gain) {
        let Gain { of, by, share } = *gain;
        self.mean[by] += share * self.mean[of];
        for row in self.covariance.iter_mut() {
            row[by] += share * row[of];
        }
        for j in 0..STATES {
            self.covariance[by][j] += share * self.covariance[of][j];
        }
    }

    /// Moves a state and its rate by their own transition.
    fn turn(&mut self, pair: &Pair) {
        let [[a, b], [c, d]] = pair.matrix;
        let turned = |value: f64, rate: f64| (a * value + b * rate, c * value + d * rate);
        let [s, r] = [pair.state, pair.state + 1];
        (self.mean[s], self.mean[r]) = turned(self.mean[s], self.mean[r]);
        for row in self.covariance.iter_mut() {
            (row[s], row[r]) = turned(row[s], row[r]);
        }
        for j in 0..STATES {
            let (value, rate) = turned(self.covariance[s][j], self.covariance[r][j]);
            self.covariance[s][j] = value;
            self.covariance[r][j] = rate;
        }
        let [[ss, sr], [_, rr]] = pair.added;
        self.covariance[s][s] += ss;
        self.covariance[s][r] += sr;
        self.covariance[r][s] += sr;
        self.covariance[r][r] += rr;
    }

    /// Returns the product of the covariance with a load.
    pub(crate) fn spread(&self, load: &[f64; STATES]) -> [f64; STATES] {
        let mut product = [0.0; STATES];
        for (row, x) in self.covariance.iter().zip(load) {
            if *x == 0.0 {
                continue;
            }
            for (sum, c) in product.iter_mut().zip(row) {
                *sum += c * x;
            }
        }
        product
    }

    /// Returns what a scalar is off, without reading it.
    pub(crate) fn innovation(&self, scalar: &Scalar) -> Innovation {
        Innovation {
            value: scalar.innovation,
            variance: scalar.variance + dot(&scalar.load, &self.spread(&scalar.load)),
        }
    }

    /// Reads a scalar. Its loss is left to the caller, who knows what else the row said.
    pub(crate) fn update(&mut self, scalar: &Scalar) -> Innovation {
        let gain = self.spread(&scalar.load);
        let value = scalar.innovation;
        let variance = scalar.variance + dot(&scalar.load, &gain);
        let innovation = Innovation { value, variance };
        let z_squared = innovation.z_squared();
        self.log_likelihood -= 0.5 * variance.ln();
        let per_raised = weight(z_squared) / variance;
        let considered = scalar
            .considered
            .map(|first| Marginal::from_filter(self, &[first, first + 1]));
        for (mean, gain) in self.mean.iter_mut().zip(&gain) {
            *mean += gain * (per_raised * value);
        }
        for (row, x) in self.covariance.iter_mut().zip(&gain) {
            let step = x * per_raised;
            for (c, gain) in row.iter_mut().zip(&gain) {
                *c -= step * gain;
            }
        }
        if let Some(considered) = considered {
            self.set(&considered);
        }
        innovation
    }

    /// Returns the filter whose mean and covariance are those of a mixture of both, `share`
    /// being the other's.
    pub(crate) fn mixed_with(&self, other: &Filter, share: f64) -> Filter {
        let mut mixed = self.clone();
        let off: [f64; STATES] = std::array::from_fn(|i| other.mean[i] - self.mean[i]);
        for i in 0..STATES {
            mixed.mean[i] += share * off[i];
            for j in 0..STATES {
                mixed.covariance[i][j] += share * (other.covariance[i][j] - self.covariance[i][j])
                    + share * (1.0 - share) * off[i] * off[j];
            }
        }
        mixed
    }

    /// Replaces states by independent ones with the given marginal.
    pub(crate) fn restore(&mut self, marginal: &Marginal) {
        for i in &marginal.states {
            for j in 0..STATES {
                self.covariance[*i][j] = 0.0;
                self.covariance[j][*i] = 0.0;
            }
        }
        self.set(marginal);
    }

    /// Sets mean and covariance of states, and leaves what they have in common with others.
    fn set(&mut self, marginal: &Marginal) {
        for (a, i) in marginal.states.iter().enumerate() {
            self.mean[*i] = marginal.mean[a];
            for (b, j) in marginal.states.iter().enumerate() {
                self.covariance[*i][*j] = marginal.covariance[a][b];
            }
        }
    }
}

/// Mean and covariance of some states.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Marginal {
    pub(crate) states: Vec<usize>,
    pub(crate) mean: Vec<f64>,
    pub(crate) covariance: Vec<Vec<f64>>,
}

impl Marginal {
    /// Takes the marginal of some states from a filter.
    pub(crate) fn from_filter(filter: &Filter, states: &[usize]) -> Marginal {
        let row = |i: usize| states.iter().map(|j| filter.covariance[i][*j]).collect();
        Marginal {
            states: states.to_vec(),
            mean: states.iter().map(|i| filter.mean[*i]).collect(),
            covariance: states.iter().map(|i| row(*i)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn the_rounded_covariance_of_states_that_are_nearly_one_is_still_positive() {
        let mut filter = Filter::new(&[0.1; STATES], &[1e-5; STATES]);
        for row in filter.covariance.iter_mut() {
            for x in row {
                *x += 0.3;
            }
        }
        filter.round();
        let rounded = DMatrix::from_fn(STATES, STATES, |i, j| filter.covariance[i][j]);
        assert_eq!(rounded, rounded.transpose());
        assert!(rounded.cholesky().is_some());
        let kept = postcard::to_allocvec(&filter).unwrap();
        assert_eq!(postcard::from_bytes::<Filter>(&kept).unwrap(), filter);
    }
}
