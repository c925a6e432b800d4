//! Whether what a fit leaves over can be what instruments do.
//!
//! A variation of the wrong sign, columns that changed places or a wandering
//! reference leave residuals that no ship explains, and a model that believes them
//! too much: what is wrong swings fast, so that each sample seems to tell something
//! new. Two figures have to be large before that is said: the middle of the plain
//! residuals, which outliers do not move, and the noise that the estimator found,
//! which is small where the ship herself changed with time.

use binnacle_compass::model::Caution;
use binnacle_compass::result::{FitError, NoiseLevels};

/// Usual instruments leave 0.5°, bad ones 1° ([`NoiseLevels`]); residuals are half
/// as large again in weak fields. Beyond thrice the worst no instrument is believed.
const ALLOWED_DEG: f64 = 3.0;
const ALLOWED_NOISE_DEG: f64 = 1.25;
/// Where both are beyond this, nothing on board is as it should be.
const CAUTION_DEG: f64 = 1.0;
/// The median of |x| of a Gaussian is this part of its standard deviation.
const MEDIAN_TO_SD: f64 = 0.674_489_8;

/// Refuses what no ship explains, and warns of what hardly one does.
pub(super) fn judge(
    residuals_deg: impl Iterator<Item = f64>,
    levels: &NoiseLevels,
) -> Result<Option<Caution>, FitError> {
    let residuals: Vec<f64> = residuals_deg.collect();
    if residuals.is_empty() {
        return Ok(None);
    }
    let noise_deg = levels.row_variance().sqrt();
    // A reference that was wrong for days draws the constant away from all the rest,
    // which still is what a ship does.
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

/// Of at least one number.
fn median(mut numbers: Vec<f64>) -> f64 {
    let middle = numbers.len() / 2;
    *numbers.select_nth_unstable_by(middle, f64::total_cmp).1
}
