//! One Kalman filter over everything at once: the ship, her instruments' lasting
//! errors and their passing ones.
//!
//! What always holds: two filters that have taken in the same measurements can be
//! compared by their log likelihoods.

use super::symmetric::{Symmetric, WIDE, dot};
use crate::estimate::{
    CONSTANT, POPULATION_SD, Prior, Station, Transition, UNKNOWNS, Unknowns, loss_of, weight,
};
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::PARAMETERS;

/// States: the seven parameters in population units, the constant, the gyro's
/// leftover speed error, what is left of the references' usual difference; then
/// Schuler swing and rate, slow gyro error, compass swing, variation error and
/// satellite compass's error, degrees.
pub(super) const STATES: usize = 16;
/// Those that the row's prediction depends on.
pub(super) const LASTING: usize = 10;
pub(super) const SPEED: usize = 8;
pub(super) const OFFSET: usize = 9;
const SWING: usize = 10;
const RATE: usize = 11;
const SLOW: usize = 12;
pub(super) const VARIATION: usize = 14;
const SATELLITE: usize = 15;
/// Where the offset stands among the estimator's unknowns.
const OFFSET_UNKNOWN: usize = UNKNOWNS - 1;
const DRIFTING: [usize; 2] = [0, 2];

/// What the filter takes in at one time: the deviation and, where both references
/// were read, their difference.
pub(super) struct Measurement {
    pub(super) transition: Transition,
    pub(super) seconds: f64,
    /// What bx and by each drifted by since the last, variance in population units.
    pub(super) drift: f64,
    pub(super) deviation: Scalar,
    pub(super) difference: Option<Scalar>,
}

/// One number measured, degrees.
pub(super) struct Scalar {
    /// What was measured, were all states zero.
    pub(super) value: f64,
    pub(super) load: [f64; STATES],
    pub(super) variance: f64,
}

/// The sizes of noise as the filter uses them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    pub(super) white: f64,
    pub(super) difference_white: f64,
    stationary: [f64; STATES - LASTING],
    turn: f64,
    drift: f64,
}

impl Noise {
    pub(super) fn new(levels: &NoiseLevels) -> Noise {
        let squared = |sd: f64| sd * sd;
        Noise {
            white: squared(levels.white_deg),
            difference_white: squared(levels.difference_deg),
            stationary: [
                squared(levels.schuler_deg),
                squared(levels.schuler_deg),
                squared(levels.slow_gyro_deg),
                squared(levels.compass_swing_deg),
                squared(levels.variation_deg),
                squared(levels.satellite_deg),
            ],
            turn: squared(levels.turn_deg),
            drift: squared(levels.drift_nt / POPULATION_SD[0]),
        }
    }

    /// Of the variation, as a rule.
    pub(super) fn variation(&self) -> f64 {
        self.stationary[VARIATION - LASTING]
    }
}

/// Variation that is off by much more than usual, and otherwise every hour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Burst {
    /// Variance, degrees squared.
    pub(super) variance: f64,
    pub(super) memory_s: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Filter {
    pub(super) mean: [f64; STATES],
    pub(super) covariance: Symmetric,
    pub(super) log_likelihood: f64,
}

impl Filter {
    /// Before the first measurement; none when the prior is no prior.
    pub(super) fn new(prior: &Prior, noise: &Noise) -> Filter {
        let mut scale = [1.0; PARAMETERS + 1];
        scale[..PARAMETERS].copy_from_slice(&POPULATION_SD);
        let mut mean = [0.0; STATES];
        let mut covariance = Symmetric::zeros();
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

    /// The lasting states as the estimator's unknowns.
    pub(super) fn unknowns(&self) -> Unknowns {
        let mut unknowns = [0.0; UNKNOWNS];
        unknowns[..=SPEED].copy_from_slice(&self.mean[..=SPEED]);
        unknowns[OFFSET_UNKNOWN] = self.mean[OFFSET];
        unknowns
    }

    /// Whether the constant is what it was in another, as far as either knows.
    pub(super) fn has_constant_of(&self, other: &Filter) -> bool {
        let k = CONSTANT_STATE;
        let apart = (self.mean[k] - other.mean[k]).abs();
        let variance = self.covariance.at(k, k) + other.covariance.at(k, k);
        apart < 2.58 * variance.max(0.0).sqrt()
    }

    /// By how much the deviation, or the references' difference, is not as expected,
    /// degrees.
    pub(super) fn astray_deg(&self, m: &Measurement) -> f64 {
        let off = |scalar: &Scalar| {
            let expected: f64 = scalar.load.iter().zip(&self.mean).map(|(l, x)| l * x).sum();
            (scalar.value - expected).abs()
        };
        off(&m.deviation).max(m.difference.as_ref().map_or(0.0, off))
    }

    /// How far bx and by are from those of another, population units.
    pub(super) fn far_from(&self, other: &Filter) -> f64 {
        let [x, y] = DRIFTING.map(|s| self.mean[s] - other.mean[s]);
        x.hypot(y)
    }

    /// The same of the deviation alone, as an error of the variation where H is 24 µT.
    pub(super) fn variation_astray_deg(&self, m: &Measurement) -> f64 {
        let Scalar { value, load, .. } = &m.deviation;
        ((value - dot(load, &self.mean)) / load[VARIATION]).abs()
    }

    /// How far the deviation is from what is expected, squared standard deviations.
    pub(super) fn z_squared(&self, m: &Measurement) -> f64 {
        let Scalar {
            value,
            load,
            variance,
        } = &m.deviation;
        let innovation = value - dot(load, &self.mean);
        innovation * innovation / (variance + dot(load, &self.covariance.times(load)))
    }

    /// Takes in what was measured; `burst` is what the variation does meanwhile, if
    /// not the usual. By how much that surprised, nats: 0 on the average.
    pub(super) fn take(&mut self, m: &Measurement, noise: &Noise, burst: Option<&Burst>) -> f64 {
        self.advance(m, noise, burst);
        let by_difference = m.difference.as_ref().map(|scalar| self.update(scalar));
        by_difference.unwrap_or(0.0) + self.update(&m.deviation)
    }

    fn advance(&mut self, m: &Measurement, noise: &Noise, burst: Option<&Burst>) {
        let t = &m.transition;
        let mut decay = t.decay;
        let mut stationary = noise.stationary;
        if let Some(burst) = burst {
            decay[VARIATION - SLOW] = (-m.seconds / burst.memory_s).exp();
            stationary[VARIATION - LASTING] = burst.variance;
        }
        let [[a, b], [c, d]] = t.schuler;
        let turned = |swing: f64, rate: f64| (a * swing + b * rate, c * swing + d * rate);
        (self.mean[SWING], self.mean[RATE]) = turned(self.mean[SWING], self.mean[RATE]);
        for (value, keep) in self.mean[SLOW..].iter_mut().zip(decay) {
            *value *= keep;
        }
        let p = &mut self.covariance;
        for (panel, rows) in p.panels_mut().into_iter().enumerate() {
            let [swings, rates, slow @ ..] = &mut rows[SWING - panel * WIDE..] else {
                continue;
            };
            for (swing, rate) in swings.iter_mut().zip(rates) {
                (*swing, *rate) = turned(*swing, *rate);
            }
            for (row, keep) in slow.iter_mut().zip(decay) {
                *row = row.map(|value| value * keep);
            }
        }
        // The same to the columns, which are all in the right panel.
        let [_, right] = p.panels_mut();
        for [_, _, swing, rate, slow @ ..] in right {
            (*swing, *rate) = turned(*swing, *rate);
            for (value, keep) in slow.iter_mut().zip(decay) {
                *value *= keep;
            }
        }
        // What the stationary processes lost in the step comes in as new noise.
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
        let gain = self.covariance.times(load);
        let innovation = scalar.value - dot(load, &self.mean);
        let variance = scalar.variance + dot(load, &gain);
        let z_squared = innovation * innovation / variance;
        let loss = loss_of(z_squared);
        self.log_likelihood -= 0.5 * (loss + variance.ln());
        let per_raised = weight(z_squared) / variance;
        for (mean, gain) in self.mean.iter_mut().zip(&gain) {
            *mean += gain * (per_raised * innovation);
        }
        self.covariance.take_off(&gain, per_raised);
        0.5 * (loss - 1.0)
    }
}

/// What `station` and `row` measure, as a filter takes it in; `unsettled` is what bx and
/// by drift beyond their usual, variance in thirty days.
pub(super) fn measurement(
    station: &Station,
    row: &crate::estimate::Row,
    at: &Unknowns,
    seconds: f64,
    noise: &Noise,
    unsettled: f64,
) -> Measurement {
    let scalar = |residual: f64, columns: &[f64; UNKNOWNS], loads: &[f64], variance: f64| {
        let mut load = [0.0; STATES];
        load[..=SPEED].copy_from_slice(&columns[..=SPEED]);
        load[OFFSET] = columns[OFFSET_UNKNOWN];
        load[LASTING..].copy_from_slice(&loads[..STATES - LASTING]);
        let known: f64 = columns.iter().zip(at).map(|(c, u)| c * u).sum();
        Scalar {
            value: residual + known,
            load,
            variance,
        }
    };
    Measurement {
        transition: station.transition,
        seconds,
        drift: (noise.drift + unsettled) * station.transition.drift_share,
        deviation: scalar(
            row.residual,
            &row.columns,
            &station.loads(row),
            station.white.variance(noise.white),
        ),
        difference: row.difference.map(|residual| {
            let (columns, loads) = station.difference(row);
            scalar(
                residual,
                &columns,
                &loads,
                station.difference_white.variance(noise.difference_white),
            )
        }),
    }
}

/// The constant's place among the states is its place among the unknowns.
pub(super) const CONSTANT_STATE: usize = CONSTANT;
