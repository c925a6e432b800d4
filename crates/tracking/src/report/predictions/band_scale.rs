//! Scale of the band by what became of predictions, and the band widened by it.
//!
//! The noise of a watch counts less than its effect on the model. Errors that the filter
//! does not know may last for a day: wind, a sea, a gyro's mood. They leave each watch within its
//! band and the model far off, as it takes ten watches of one day for ten witnesses. So the errors
//! are added up by day, each times its slopes by the ship over its variance. The covariance of
//! these scores is known if the band is right, and their excess over it is the excess of the
//! model's own variance (the sandwich estimator, clustered by day: Huber 1967; White 1982).
//!
//! Two models of that excess: there is none; or the variance is wrong by a factor s², on which
//! lies an inverse-gamma prior, so that the posterior is one again (Gelman et al., Bayesian Data
//! Analysis, 3rd ed., section 2.6). The factor is the mean over both, weighed by their posterior:
//! what chance explains widens nothing.

use super::frozen_filter::ShipLoad;
use binnacle_compass::model::Covariance;
use nalgebra::{SMatrix, SVector};

/// Prior probability that the band is not right.
const WRONG: f64 = 0.05;
/// Shape and scale of the prior of s²: 2 in the mean, 1 at its mode.
const SHAPE: f64 = 3.0;
const SCALE: f64 = 4.0;
/// Greatest error that counts, standard deviations: one watch in a strike or beside a wreck is no
/// wrong band.
const LARGEST: f64 = 3.0;

/// Number of values of a model: seven parameters, and the constant.
const VALUES: usize = 8;
const CONSTANT: usize = VALUES - 1;
type Matrix = SMatrix<f64, VALUES, VALUES>;
type Vector = SVector<f64, VALUES>;

/// Error of the prediction of a watch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Error {
    /// Day, counted from any.
    pub(crate) day: i64,
    /// Error over its predicted standard deviation.
    pub(crate) deviations: f64,
    /// Slopes by the ship over the same.
    pub(crate) load: ShipLoad,
}

/// Scale of a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Mean square of the errors; 1 without any.
    pub(crate) mean_square: f64,
    /// Factor of the band, 1 at least.
    pub(crate) widening: f64,
}

/// Returns the scale by the errors of watches, those of a day together.
pub(crate) fn scale(errors: &[Error]) -> Scale {
    let limited = |error: &Error| error.deviations.clamp(-LARGEST, LARGEST);
    let squares: f64 = errors.iter().map(|error| limited(error).powi(2)).sum();
    let days: Vec<(Vector, Matrix)> = errors
        .chunk_by(|a, b| a.day == b.day)
        .map(|day| {
            let loads = day.iter().map(|error| Vector::from(error.load));
            let score = loads
                .clone()
                .zip(day)
                .map(|(load, e)| load * limited(e))
                .sum();
            (score, loads.map(|load| load * load.transpose()).sum())
        })
        .collect();
    Scale {
        mean_square: if errors.is_empty() {
            1.0
        } else {
            squares / errors.len() as f64
        },
        widening: widening(&excess(&days)),
    }
}

/// Variance of scores over the expected one, and the number of independent squares in it.
struct Excess {
    ratio: f64,
    squares: f64,
}

/// Returns the excess of days' scores, each with its expected covariance, weighed by what the
/// days and the population together leave open (Satterthwaite 1946).
fn excess(days: &[(Vector, Matrix)]) -> Excess {
    let information = Matrix::identity() + days.iter().map(|(_, own)| own).sum::<Matrix>();
    let Some(factor) = information.cholesky() else {
        return Excess {
            ratio: 1.0,
            squares: 0.0,
        };
    };
    let (mut found, mut expected, mut spread) = (0.0, 0.0, 0.0);
    for (score, own) in days {
        let share = factor.solve(own);
        found += score.dot(&factor.solve(score));
        expected += share.trace();
        spread += (share * share).trace();
    }
    if spread <= f64::MIN_POSITIVE {
        return Excess {
            ratio: 1.0,
            squares: 0.0,
        };
    }
    Excess {
        ratio: found / expected,
        squares: expected * expected / spread,
    }
}

/// Returns the factor of the band by the excess.
fn widening(excess: &Excess) -> f64 {
    let half = excess.squares / 2.0;
    let shape = SHAPE + half;
    let scale = SCALE + excess.ratio * half;
    let log_bayes_factor = SHAPE * SCALE.ln() - log_gamma(SHAPE) + log_gamma(shape)
        - shape * scale.ln()
        + excess.ratio * half;
    let odds = WRONG / (1.0 - WRONG) * log_bayes_factor.min(700.0).exp();
    let wrong = odds / (1.0 + odds);
    // Never narrower: a band that held by luck may not hold tomorrow.
    let variance = (scale / (shape - 1.0)).max(1.0);
    (1.0 - wrong + wrong * variance).sqrt()
}

/// Returns ln Γ(x) for x of 3 or more, within 10⁻⁶ (Stirling's series; Abramowitz & Stegun, 6.1.41).
fn log_gamma(x: f64) -> f64 {
    let series = 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3)) + 1.0 / (1260.0 * x.powi(5));
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series
}

/// Returns the covariance of a model whose band is wider by a factor. What no heading shows, a
/// constant of the reference of variance up to `constant_variance`, was not tested and stays.
pub(crate) fn widened(covariance: &Covariance, factor: f64, constant_variance: f64) -> Covariance {
    let square = factor * factor;
    let mut widened = covariance.map(|row| row.map(|x| x * square));
    let untested = constant_given_rest(covariance).min(constant_variance);
    widened[CONSTANT][CONSTANT] -= (square - 1.0) * untested;
    widened
}

/// Returns the constant's variance were all parameters known; zero where that is not defined.
fn constant_given_rest(covariance: &Covariance) -> f64 {
    let sd: [f64; VALUES] = std::array::from_fn(|i| covariance[i][i].max(0.0).sqrt());
    let scaled = Matrix::from_fn(|i, j| covariance[i][j] / (sd[i] * sd[j]).max(f64::MIN_POSITIVE));
    let Some(factor) = scaled.cholesky() else {
        return 0.0;
    };
    // The last diagonal of the factor is the part that the rows before leave.
    (factor.l_dirty()[(CONSTANT, CONSTANT)] * sd[CONSTANT]).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of z² of a normal distribution in ten parts of equal probability, with signs.
    const DEVIATIONS: [f64; 10] = [
        0.07, -0.19, 0.32, -0.46, 0.6, -0.76, 0.94, -1.15, 1.44, -2.1,
    ];

    /// Returns watches, so many a day, whose errors have `by` times the predicted size.
    fn watches(count: i64, a_day: i64, by: f64) -> Vec<Error> {
        (0..count)
            .map(|k| error(k / a_day, k, by * DEVIATIONS[(7 * k as usize) % 10]))
            .collect()
    }

    /// Returns the error of a watch on the heading of a number.
    fn error(day: i64, number: i64, deviations: f64) -> Error {
        let (sin, cos) = (40.0 * number as f64).to_radians().sin_cos();
        Error {
            day,
            deviations,
            load: [sin, 0.5 * sin, cos, 0.5 * cos, sin * cos, 0.1, 0.1, 1.0],
        }
    }

    #[test]
    fn right_predictions_widen_nothing_and_too_good_ones_never_narrow() {
        assert!((scale(&[]).mean_square - 1.0).abs() < 1e-12);
        assert!((1.0..1.03).contains(&scale(&[]).widening));
        assert!(scale(&watches(100, 5, 1.0)).widening < 1.02);
        assert!((scale(&watches(100, 5, 0.3)).widening - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_band_of_half_its_width_is_doubled_after_a_hundred_watches() {
        let found = scale(&watches(100, 1, 2.0)).widening;
        assert!((1.6..2.2).contains(&found), "{found}");
    }

    #[test]
    fn errors_that_last_for_a_day_widen_the_band_though_each_watch_is_inside() {
        // The same watches, in one order and in another: those of a day all to one side.
        let lasting: Vec<Error> = (0..100)
            .map(|k| error(k / 10, k, if (k / 10) % 2 == 0 { 1.0 } else { -1.0 }))
            .collect();
        let passing: Vec<Error> = (0..100)
            .map(|k| error(k / 10, k, if (k / 3) % 2 == 0 { 1.0 } else { -1.0 }))
            .collect();
        let (lasting, passing) = (scale(&lasting), scale(&passing));
        assert!((lasting.mean_square - passing.mean_square).abs() < 1e-12);
        let (lasting, passing) = (lasting.widening, passing.widening);
        assert!(lasting > 1.4, "{lasting}");
        assert!(passing < 1.1, "{passing}");
    }

    #[test]
    fn one_wild_watch_among_many_widens_next_to_nothing() {
        let mut errors = watches(100, 5, 1.0);
        errors[7].deviations = 30.0;
        assert!(scale(&errors).widening < 1.1, "{}", scale(&errors).widening);
    }

    #[test]
    fn more_errors_never_make_the_band_narrower() {
        let growing: Vec<f64> = (0..30)
            .map(|k| scale(&watches(60, 1, 0.1 * f64::from(k))).widening)
            .collect();
        let grows = growing.windows(2).all(|pair| pair[1] >= pair[0] - 1e-3);
        assert!(grows && growing[29] > 1.5, "{growing:?}");
    }

    #[test]
    fn the_gamma_function_of_five_is_twenty_four() {
        assert!((log_gamma(5.0) - 24.0_f64.ln()).abs() < 1e-6);
        assert!((log_gamma(3.5) - 1.200_973_602).abs() < 1e-5);
    }

    #[test]
    fn a_constant_that_no_heading_shows_is_not_widened() {
        let mut covariance = [[0.0; VALUES]; VALUES];
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] = 4.0;
        }
        covariance[CONSTANT][CONSTANT] = 0.25;
        let wide = widened(&covariance, 2.0, 0.2);
        assert!((wide[0][0] - 16.0).abs() < 1e-12);
        assert!((wide[CONSTANT][CONSTANT] - (0.2 + 4.0 * 0.05)).abs() < 1e-12);
        assert_eq!(widened(&covariance, 1.0, 0.2), covariance);
    }
}
