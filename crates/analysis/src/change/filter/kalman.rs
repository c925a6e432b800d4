//! Kalman filter over the vessel, its instruments' lasting errors and their transient ones.
//!
//! Filters that have read the same measurements can be compared by their log likelihoods.

use super::covariance::{PANEL_COLUMNS, SymmetricMatrix, dot};
use super::measurement::{Measurement, Scalar};
use super::noise::{NoiseVariances, TransientNoise};
use super::states::{
    CONSTANT_STATE, DRIFTING, LASTING, OFFSET, OFFSET_UNKNOWN, RATE, SATELLITE, SLOW, SPEED,
    STATES, SWING, VARIATION,
};
use crate::estimate::{POPULATION_SD, Prior, UNKNOWNS, Unknowns, robust_loss, weight};
use binnacle_compass::ship::PARAMETERS;

#[derive(Clone, Debug)]
pub(crate) struct Filter {
    pub(crate) mean: [f64; STATES],
    pub(crate) covariance: SymmetricMatrix,
    pub(crate) log_likelihood: f64,
}

impl Filter {
    /// Makes a filter before the first measurement.
    pub(crate) fn new(prior: &Prior, noise: &NoiseVariances) -> Filter {
        let mut scale = [1.0; PARAMETERS + 1];
        scale[..PARAMETERS].copy_from_slice(&POPULATION_SD);
        let mut mean = [0.0; STATES];
        let mut covariance = SymmetricMatrix::zeros();
        for i in 0..=PARAMETERS {
            mean[i] = prior.mean[i] / scale[i];
            for j in 0..=i {
                covariance.set(i, j, prior.covariance[i][j] / (scale[i] * scale[j]));
            }
        }
        for s in [SPEED, OFFSET] {
            covariance.set(s, s, 1.0);
        }
        for (s, variance) in noise.stationary.iter().enumerate() {
            covariance.set(LASTING + s, LASTING + s, *variance);
        }
        Filter {
            mean,
            covariance,
            log_likelihood: 0.0,
        }
    }

    /// Returns the lasting states as the estimator's unknowns.
    pub(crate) fn unknowns(&self) -> Unknowns {
        let mut unknowns = [0.0; UNKNOWNS];
        unknowns[..=SPEED].copy_from_slice(&self.mean[..=SPEED]);
        unknowns[OFFSET_UNKNOWN] = self.mean[OFFSET];
        unknowns
    }

    /// Returns true if the constant is the same as another filter's, within both
    /// uncertainties.
    pub(crate) fn agrees_in_constant(&self, other: &Filter) -> bool {
        let k = CONSTANT_STATE;
        let apart = (self.mean[k] - other.mean[k]).abs();
        let variance = self.covariance.at(k, k) + other.covariance.at(k, k);
        apart < 2.58 * variance.max(0.0).sqrt()
    }

    /// Returns the larger innovation of deviation and references' difference, degrees.
    pub(crate) fn innovation_deg(&self, m: &Measurement) -> f64 {
        let off = |scalar: &Scalar| {
            let expected: f64 = scalar.load.iter().zip(&self.mean).map(|(l, x)| l * x).sum();
            (scalar.value - expected).abs()
        };
        off(&m.deviation).max(m.difference.as_ref().map_or(0.0, off))
    }

    /// Returns the distance between both filters' bx and by, population units.
    pub(crate) fn permanent_distance(&self, other: &Filter) -> f64 {
        let [x, y] = DRIFTING.map(|s| self.mean[s] - other.mean[s]);
        x.hypot(y)
    }

    /// Returns the innovation of the deviation as an error of the variation where H is 24
    /// µT.
    pub(crate) fn variation_innovation_deg(&self, m: &Measurement) -> f64 {
        let Scalar { value, load, .. } = &m.deviation;
        ((value - dot(load, &self.mean)) / load[VARIATION]).abs()
    }

    /// Returns the innovation of the deviation in standard deviations, squared.
    pub(crate) fn z_squared(&self, m: &Measurement) -> f64 {
        let Scalar {
            value,
            load,
            variance,
        } = &m.deviation;
        let innovation = value - dot(load, &self.mean);
        innovation * innovation / (variance + dot(load, &self.covariance.multiply(load)))
    }

    /// Reads a measurement; `transient` replaces the usual noise of the variation. Returns
    /// the excess loss: the log-likelihood loss beyond its mean.
    pub(crate) fn observe(
        &mut self,
        m: &Measurement,
        noise: &NoiseVariances,
        transient: Option<&TransientNoise>,
    ) -> f64 {
        self.advance(m, noise, transient);
        let by_difference = m.difference.as_ref().map(|scalar| self.update(scalar));
        by_difference.unwrap_or(0.0) + self.update(&m.deviation)
    }

    fn advance(
        &mut self,
        m: &Measurement,
        noise: &NoiseVariances,
        transient: Option<&TransientNoise>,
    ) {
        let t = &m.transition;
        let mut decay = t.decay;
        let mut stationary = noise.stationary;
        if let Some(transient) = transient {
            decay[VARIATION - SLOW] = (-m.seconds / transient.memory_s).exp();
            stationary[VARIATION - LASTING] = transient.variance;
        }
        let [[a, b], [c, d]] = t.schuler;
        let turned = |swing: f64, rate: f64| (a * swing + b * rate, c * swing + d * rate);
        (self.mean[SWING], self.mean[RATE]) = turned(self.mean[SWING], self.mean[RATE]);
        for (value, keep) in self.mean[SLOW..].iter_mut().zip(decay) {
            *value *= keep;
        }
        let p = &mut self.covariance;
        for (panel, rows) in p.panels_mut().into_iter().enumerate() {
            let [swings, rates, slow @ ..] = &mut rows[SWING - panel * PANEL_COLUMNS..] else {
                continue;
            };
            for (swing, rate) in swings.iter_mut().zip(rates) {
                (*swing, *rate) = turned(*swing, *rate);
            }
            for (row, keep) in slow.iter_mut().zip(decay) {
                *row = row.map(|value| value * keep);
            }
        }
        // Columns likewise; all are in the right panel.
        let [_, right] = p.panels_mut();
        for [_, _, swing, rate, slow @ ..] in right {
            (*swing, *rate) = turned(*swing, *rate);
            for (value, keep) in slow.iter_mut().zip(decay) {
                *value *= keep;
            }
        }
        // The variance that the stationary processes lost returns as new noise.
        let swing = stationary[0];
        p.add(SWING, SWING, swing * (1.0 - a * a - b * b));
        p.add(RATE, RATE, swing * (1.0 - c * c - d * d));
        p.add(RATE, SWING, -swing * (a * c + b * d));
        for (s, keep) in (SLOW..=SATELLITE).zip(decay) {
            p.add(s, s, stationary[s - LASTING] * (1.0 - keep * keep));
        }
        for s in DRIFTING {
            p.add(s, s, m.drift);
        }
        if let Some([swing, rate]) = t.since_turn {
            p.add(SWING, SWING, noise.turn * swing * swing);
            p.add(RATE, SWING, noise.turn * swing * rate);
            p.add(RATE, RATE, noise.turn * rate * rate);
        }
    }

    fn update(&mut self, scalar: &Scalar) -> f64 {
        let load = &scalar.load;
        let gain = self.covariance.multiply(load);
        let innovation = scalar.value - dot(load, &self.mean);
        let variance = scalar.variance + dot(load, &gain);
        let z_squared = innovation * innovation / variance;
        let loss = robust_loss(z_squared);
        self.log_likelihood -= 0.5 * (loss + variance.ln());
        let per_raised = weight(z_squared) / variance;
        for (mean, gain) in self.mean.iter_mut().zip(&gain) {
            *mean += gain * (per_raised * innovation);
        }
        self.covariance.subtract_outer_product(&gain, per_raised);
        0.5 * (loss - 1.0)
    }
}
