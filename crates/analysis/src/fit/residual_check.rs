//! Plausibility of a fit's residuals.
//!
//! A variation of the wrong sign, interchanged columns or a wandering reference leave
//! residuals that no vessel explains, and an overconfident model: fast errors make every
//! sample seem to be new information. Two figures must be large for a refusal: the median
//! of the plain residuals, which outliers do not move, and the noise found by the
//! estimator, which is small where the vessel itself changed with time.

use crate::robust_scale::{median, robust_sd};
use binnacle_compass::model::Caution;
use binnacle_compass::result::{FitError, NoiseLevels};

/// Largest residual and noise of a plausible fit. Usual instruments leave 0.5°, bad ones 1°
/// ([`NoiseLevels`]); residuals are half as large again in weak fields. The limit is three
/// times the worst.
const ALLOWED_DEG: f64 = 3.0;
const ALLOWED_NOISE_DEG: f64 = 1.25;
/// Residual and noise from which the result needs a caution.
const CAUTION_DEG: f64 = 1.0;

/// Fails for implausible residuals, and returns a caution for large ones.
pub(super) fn check_residuals(
    residuals_deg: impl Iterator<Item = f64>,
    levels: &NoiseLevels,
) -> Result<Option<Caution>, FitError> {
    let residuals: Vec<f64> = residuals_deg.collect();
    let about = |centre| robust_sd(residuals.iter().copied(), centre);
    let spreads = median(residuals.clone()).and_then(about).zip(about(0.0));
    let Some((spread_deg, residual_deg)) = spreads else {
        return Ok(None);
    };
    let noise_deg = levels.row_variance().sqrt();
    // The spread is about the median: a reference that was wrong for days moves the constant
    // away from all the rest, which is still plausible.
    if spread_deg > ALLOWED_DEG && noise_deg > ALLOWED_NOISE_DEG {
        return Err(FitError::Contradictory {
            residual_deg: spread_deg,
            allowed_deg: ALLOWED_DEG,
        });
    }
    let is_large =
        residual_deg > ALLOWED_DEG || (residual_deg > CAUTION_DEG && noise_deg > CAUTION_DEG);
    Ok(is_large.then_some(Caution::LargeResiduals { residual_deg }))
}
