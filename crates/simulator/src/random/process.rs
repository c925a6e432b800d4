//! Random processes with memory, stepped exactly for steps of any length.

use crate::random::Random;

/// A Gaussian process whose correlation falls by e in `memory`
/// (Ornstein–Uhlenbeck). `memory` and steps share any one unit: seconds, miles.
#[derive(Clone, Debug)]
pub(crate) struct Wander {
    value: f64,
    sd: f64,
    memory: f64,
    step: f64,
    keep: f64,
    fresh: f64,
}

impl Wander {
    /// Starts from a random state of the stationary distribution.
    pub(crate) fn new(sd: f64, memory: f64, random: &mut Random) -> Wander {
        Wander {
            value: sd * random.gaussian(),
            sd,
            memory,
            step: f64::NAN,
            keep: 0.0,
            fresh: 0.0,
        }
    }

    pub(crate) fn value(&self) -> f64 {
        self.value
    }

    pub(crate) fn step(&mut self, step: f64, random: &mut Random) -> f64 {
        #[allow(clippy::float_cmp)] // the very same step, or new coefficients
        if step != self.step {
            self.step = step;
            self.keep = (-step / self.memory).exp();
            self.fresh = self.sd * (1.0 - self.keep * self.keep).max(0.0).sqrt();
        }
        self.value = self.keep * self.value + self.fresh * random.gaussian();
        self.value
    }
}

/// A damped oscillation driven by noise: yaw, roll, a gyro's Schuler swing.
#[derive(Clone, Debug)]
pub(crate) struct Swing {
    re: f64,
    im: f64,
    sd: f64,
    period_s: f64,
    decay_s: f64,
    step: f64,
    cos: f64,
    sin: f64,
    fresh: f64,
}

impl Swing {
    /// An oscillation with this standard deviation and period, whose free
    /// amplitude falls by e in `decay_s`.
    pub(crate) fn new(sd: f64, period_s: f64, decay_s: f64, random: &mut Random) -> Swing {
        Swing {
            re: sd * random.gaussian(),
            im: sd * random.gaussian(),
            sd,
            period_s,
            decay_s,
            step: f64::NAN,
            cos: 1.0,
            sin: 0.0,
            fresh: 0.0,
        }
    }

    /// Adds a random impulse of this standard deviation.
    pub(crate) fn kick(&mut self, sd: f64, random: &mut Random) {
        self.re += sd * random.gaussian();
        self.im += sd * random.gaussian();
    }

    pub(crate) fn step(&mut self, step_s: f64, random: &mut Random) -> f64 {
        #[allow(clippy::float_cmp)] // the very same step, or new coefficients
        if step_s != self.step {
            self.step = step_s;
            let keep = (-step_s / self.decay_s).exp();
            let (sin, cos) = (std::f64::consts::TAU * step_s / self.period_s).sin_cos();
            (self.sin, self.cos) = (keep * sin, keep * cos);
            self.fresh = self.sd * (1.0 - keep * keep).max(0.0).sqrt();
        }
        let (re, im) = (self.re, self.im);
        self.re = self.cos * re - self.sin * im + self.fresh * random.gaussian();
        self.im = self.sin * re + self.cos * im + self.fresh * random.gaussian();
        self.re
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rms(values: &[f64]) -> f64 {
        (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn a_wander_keeps_its_spread_whatever_the_step() {
        let mut random = Random::new(3, "", "");
        for step in [0.5, 5.0, 60.0] {
            let mut wander = Wander::new(0.4, 5.0, &mut random);
            let values: Vec<f64> = (0..100_000)
                .map(|_| wander.step(step, &mut random))
                .collect();
            assert!((rms(&values) - 0.4).abs() < 0.03, "step {step}");
        }
    }

    #[test]
    fn a_swing_keeps_its_spread_and_turns_back_after_half_a_period() {
        let mut random = Random::new(4, "", "");
        let mut swing = Swing::new(1.0, 100.0, 300.0, &mut random);
        let values: Vec<f64> = (0..200_000).map(|_| swing.step(2.0, &mut random)).collect();
        assert!((rms(&values) - 1.0).abs() < 0.1);
        let half_apart: f64 = values.windows(26).map(|w| w[0] * w[25]).sum();
        assert!(half_apart < 0.0);
    }
}
