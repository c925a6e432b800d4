//! Bayesian online changepoint detection [Adams & MacKay 2007] on the mean residuals of
//! hours: in every run they are Gaussian about what an unknown step of (bx, by) adds.
//!
//! The alarm is for how far the step of the run that now lasts is from none. That a
//! run began is no alarm: each storm begins one, and another when it is over. With
//! one level in place of a step, and with noise as large as it is from hour to hour,
//! steps were found later.

use crate::score::listen;
use crate::ship::{Hour, Ship};
use nalgebra::{Matrix2, Vector2};

/// A change in five years of hours.
const HAZARD: f64 = 1.0 / (5.0 * 365.25 * 24.0);
/// Standard deviation of a step before any data, and of what is no step, µT.
const STEP_UT: f64 = 1.0;
const NO_STEP_UT: f64 = 0.1;
/// Noise from hour to hour is not new each time: it counts for so many times its size.
const REMEMBERED: f64 = 3.0;
/// Runs of fewer hours are not judged.
const YOUNG_HOURS: usize = 6;
/// Log probability below which a run is dropped.
const GIVEN_UP: f64 = -14.0;
/// Hours before the watch that the first run reads.
const FED_HOURS: usize = 240;

/// Returns the alarms by a threshold on the log-likelihood ratio.
pub(crate) fn alarms(ship: &Ship, threshold: f64) -> Vec<usize> {
    let noise_deg = REMEMBERED * ship.usual_hour_deg();
    let watched = ship.hours.partition_point(|hour| hour.last < ship.watched);
    let hours = ship.hours[watched.saturating_sub(FED_HOURS)..].iter();
    let mut runs = Runs::new(noise_deg);
    listen(
        ship,
        hours,
        |hour: &&Hour| hour.last,
        |hour, anew| {
            if anew {
                runs = Runs::new(noise_deg);
            }
            runs.take(hour.mean_deg, Vector2::from(hour.deg_per_ut));
            runs.off() > threshold
        },
    )
}

/// Hours without a change, and their knowledge of the step.
struct Run {
    log_weight: f64,
    hours: usize,
    information: Matrix2<f64>,
    score: Vector2<f64>,
}

impl Run {
    fn new(log_weight: f64) -> Run {
        Run {
            log_weight,
            hours: 0,
            information: Matrix2::identity() / (STEP_UT * STEP_UT),
            score: Vector2::zeros(),
        }
    }

    fn covariance(&self) -> Matrix2<f64> {
        let covariance = self.information.try_inverse();
        covariance.expect("more information than before any data")
    }
}

/// The runs that may be going on, their weights adding up to one.
pub(crate) struct Runs {
    runs: Vec<Run>,
    noise_variance: f64,
}

impl Runs {
    pub(crate) fn new(noise_deg: f64) -> Runs {
        Runs {
            runs: vec![Run::new(0.0)],
            noise_variance: noise_deg * noise_deg,
        }
    }

    /// Reads an hour whose residual is `deg_per_ut` times the step, and noise.
    pub(crate) fn take(&mut self, residual_deg: f64, deg_per_ut: Vector2<f64>) {
        for run in &mut self.runs {
            let covariance = run.covariance();
            let off = residual_deg - deg_per_ut.dot(&(covariance * run.score));
            let variance = self.noise_variance + deg_per_ut.dot(&(covariance * deg_per_ut));
            run.log_weight -= 0.5 * (off * off / variance + variance.ln());
            run.information += deg_per_ut * deg_per_ut.transpose() / self.noise_variance;
            run.score += deg_per_ut * (residual_deg / self.noise_variance);
            run.hours += 1;
        }
        let weights = self.runs.iter().map(|run| run.log_weight);
        let most = weights.clone().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = weights.map(|weight| (weight - most).exp()).sum();
        for run in &mut self.runs {
            run.log_weight += (1.0 - HAZARD).ln() - most - sum.ln();
        }
        self.runs.retain(|run| run.log_weight > GIVEN_UP);
        self.runs.push(Run::new(HAZARD.ln()));
    }

    /// Probability that a run of fewer hours than so many is going on.
    #[cfg(test)]
    pub(crate) fn is_younger(&self, hours: usize) -> f64 {
        let young = self.runs.iter().filter(|run| run.hours < hours);
        young.map(|run| run.log_weight.exp()).sum()
    }

    /// Returns the distance of the step from none: half its square, in variances of its
    /// uncertainty and of no step, averaged over runs.
    pub(crate) fn off(&self) -> f64 {
        let none = Matrix2::identity() * (NO_STEP_UT * NO_STEP_UT);
        let off = |run: &Run| {
            let covariance = run.covariance();
            let step = covariance * run.score;
            let inverse = (covariance + none).try_inverse().expect("more than none");
            run.log_weight.exp() * step.dot(&(inverse * step)) / 2.0
        };
        let judged = self.runs.iter().filter(|run| run.hours >= YOUNG_HOURS);
        judged.map(off).sum()
    }
}
