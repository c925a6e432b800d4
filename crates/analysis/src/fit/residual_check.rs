//! Plausibility of a fit's residuals.
//!
//! A variation of the wrong sign, interchanged columns or a wandering reference leave
//! residuals that no vessel explains, and an overconfident model: fast errors make every
//! sample seem to be new information. Two figures must be large for a refusal: the median
//! of the plain residuals, which outliers do not move, and the noise found by the
//! estimator, which is small where the vessel itself changed with time.

use binnacle_compass::model::Caution;
use binnacle_compass::result::{FitError, NoiseLevels};

/// Largest residual and noise of a plausible fit. Usual instruments leave 0.5°, bad ones 1°
/// ([`NoiseLevels`]); residuals are half as large again in weak fields. The limit is three
/// times the worst.
const ALLOWED_DEG: f64 = 3.0;
const ALLOWED_NOISE_DEG: f64 = 1.25;
/// Residual and noise from which the result needs a caution.
const CAUTION_DEG: f64 = 1.0;
/// Median of |x| of a Gaussian, as a part of its standard deviation.
const MEDIAN_TO_SD: f64 = 0.674_489_8;

/// Fails for implausible residuals, and returns a caution for large ones.
pub(super) fn check_residuals(
    residuals_deg: impl Iterator<Item = f64>,
    levels: &NoiseLevels,
) -> Result<Option<Caution>, FitError> {
    let residuals: Vec<f64> = residuals_deg.collect();
    if residuals.is_empty() {
        return Ok(None);
    }
    let noise_deg = levels.row_variance().sqrt();
    // A reference that was wrong for days moves the constant away from all the rest, which
    // is still plausible.
    let spread_deg = robust_sd(&residuals, median(residuals.clone()));
    if spread_deg > ALLOWED_DEG && noise_deg > ALLOWED_NOISE_DEG {
        return Err(FitError::Contradictory {
            residual_deg: spread_deg,
            allowed_deg: ALLOWED_DEG,
        });
    }
    let residual_deg = robust_sd(&residuals, 0.0);
    let is_large =
        residual_deg > ALLOWED_DEG || (residual_deg > CAUTION_DEG && noise_deg > CAUTION_DEG);
    Ok(is_large.then_some(Caution::LargeResiduals { residual_deg }))
}

fn robust_sd(residuals: &[f64], about: f64) -> f64 {
    median(residuals.iter().map(|r| (r - about).abs()).collect()) / MEDIAN_TO_SD
}

/// Returns the median of at least one number.
fn median(mut numbers: Vec<f64>) -> f64 {
    let middle = numbers.len() / 2;
    *numbers.select_nth_unstable_by(middle, f64::total_cmp).1
}
