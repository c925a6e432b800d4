//! Scale of the band by what became of predictions, and the band widened by it.
//!
//! Two models of the squares z² of independent errors over their predicted variance: the band is
//! right, z² is χ² of one degree; or its variance is wrong by a factor s², on which lies an
//! inverse-gamma prior, so that the posterior is one again (Gelman et al., Bayesian Data
//! Analysis, 3rd ed., section 2.6). The factor is the mean over both, weighed by their posterior:
//! what chance explains widens nothing.

use binnacle_compass::model::Covariance;
use nalgebra::SMatrix;

/// Prior probability that the band is not right.
const WRONG: f64 = 0.05;
/// Shape and scale of the prior of s²: 2 in the mean, 1 at its mode.
const SHAPE: f64 = 3.0;
const SCALE: f64 = 4.0;
/// Greatest square that counts: one watch in a strike or beside a wreck is no wrong band.
const LARGEST_SQUARE: f64 = 9.0;
/// ln Γ(3.5) − ln Γ(3).
const HALF_STEP: f64 = 0.507_824_893_226_869;

/// Number of values of a model: seven parameters, and the constant.
const VALUES: usize = 8;
const CONSTANT: usize = VALUES - 1;

/// Scale of a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Mean square of the errors; 1 without any.
    pub(super) mean_square: f64,
    /// Factor of the band, 1 at least.
    pub(super) widening: f64,
}

/// Returns the scale by the squares of independent errors over their predicted variance.
pub(super) fn scale(squares: &[f64]) -> Scale {
    let n = squares.len();
    let sum: f64 = squares.iter().map(|z2| z2.min(LARGEST_SQUARE)).sum();
    let shape = SHAPE + n as f64 / 2.0;
    let scale = SCALE + sum / 2.0;
    let log_bayes_factor = SHAPE * SCALE.ln() + log_gamma_ratio(n) - shape * scale.ln() + sum / 2.0;
    let odds = WRONG / (1.0 - WRONG) * log_bayes_factor.min(700.0).exp();
    let wrong = odds / (1.0 + odds);
    // Never narrower: a band that held by luck may not hold tomorrow.
    let variance = (scale / (shape - 1.0)).max(1.0);
    Scale {
        mean_square: if n == 0 { 1.0 } else { sum / n as f64 },
        widening: (1.0 - wrong + wrong * variance).sqrt(),
    }
}

/// Returns ln Γ(3 + n/2) − ln Γ(3).
fn log_gamma_ratio(n: usize) -> f64 {
    let is_odd = n % 2 == 1;
    let (start, first) = if is_odd {
        (HALF_STEP, SHAPE + 0.5)
    } else {
        (0.0, SHAPE)
    };
    start + (0..n / 2).map(|k| (first + k as f64).ln()).sum::<f64>()
}

/// Returns the covariance of a model whose band is wider by a factor. What no heading shows, a
/// constant of the reference of variance up to `constant_variance`, was not tested and stays.
pub(super) fn widened(covariance: &Covariance, factor: f64, constant_variance: f64) -> Covariance {
    let square = factor * factor;
    let mut widened = covariance.map(|row| row.map(|x| x * square));
    let untested = constant_given_rest(covariance).min(constant_variance);
    widened[CONSTANT][CONSTANT] -= (square - 1.0) * untested;
    widened
}

/// Returns the constant's variance were all parameters known; zero where that is not defined.
fn constant_given_rest(covariance: &Covariance) -> f64 {
    let sd: [f64; VALUES] = std::array::from_fn(|i| covariance[i][i].max(0.0).sqrt());
    let scaled = SMatrix::<f64, VALUES, VALUES>::from_fn(|i, j| {
        covariance[i][j] / (sd[i] * sd[j]).max(f64::MIN_POSITIVE)
    });
    let Some(factor) = scaled.cholesky() else {
        return 0.0;
    };
    // The last diagonal of the factor is the part that the rows before leave.
    (factor.l_dirty()[(CONSTANT, CONSTANT)] * sd[CONSTANT]).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_predictions_widen_nothing_and_too_good_ones_never_narrow() {
        assert_eq!(scale(&[]).mean_square, 1.0);
        assert!((scale(&[]).widening - (0.95_f64 + 0.05 * 2.0).sqrt()).abs() < 1e-9);
        assert!(scale(&[1.0; 60]).widening < 1.01);
        assert!((scale(&[0.2; 60]).widening - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_band_of_half_its_width_is_doubled_after_some_fifty_watches() {
        // Squares of a normal distribution of twice the predicted standard deviation.
        let squares: Vec<f64> = (0..50).map(|k| 4.0 * SQUARES[k % 10]).collect();
        let found = scale(&squares).widening;
        assert!((1.7..2.1).contains(&found), "{found}");
    }

    #[test]
    fn one_wild_watch_among_many_widens_next_to_nothing() {
        let mut squares: Vec<f64> = (0..60).map(|k| SQUARES[k % 10]).collect();
        squares[7] = 900.0;
        assert!(scale(&squares).widening < 1.05, "{squares:?}");
    }

    #[test]
    fn more_errors_never_make_the_band_narrower() {
        let widening = |square: f64| scale(&[square; 40]).widening;
        let growing: Vec<f64> = (0..30).map(|k| widening(0.3 * f64::from(k))).collect();
        assert!(growing.is_sorted(), "{growing:?}");
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

    /// Means of z² of a normal distribution in ten parts of equal probability.
    const SQUARES: [f64; 10] = [
        0.005, 0.037, 0.103, 0.208, 0.361, 0.576, 0.878, 1.325, 2.085, 4.42,
    ];
}
