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
/// Residual about zero beyond which the model is of no use: a compass that deviates by more
/// must be adjusted (AMSA, Marshall Islands, Panama), and a corrected one would deviate so.
const UNUSABLE_DEG: f64 = 5.0;
/// Share of the samples below which those with weight are a minority: beyond one half no
/// robust fit can say which part is wrong (breakdown point).
const LEAST_USED_SHARE: f64 = 0.5;
/// Residual and noise from which the result needs a caution.
const CAUTION_DEG: f64 = 1.0;

/// Fails for implausible residuals, and where the model does not explain its own samples.
/// Returns a caution for large residuals.
///
/// # Errors
/// The refusal by name.
pub fn check_residuals(
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
    // The limits are those of headings: a course over ground drifts beside.
    let limit = |heading_deg: f64| heading_deg.hypot(levels.drift_angle_deg);
    // The spread is about the median: a reference that was wrong for days moves the constant
    // away from all the rest, which is still plausible.
    if spread_deg > limit(ALLOWED_DEG) && noise_deg > limit(ALLOWED_NOISE_DEG) {
        return Err(FitError::Contradictory {
            residual_deg: spread_deg,
            allowed_deg: limit(ALLOWED_DEG),
        });
    }
    if residual_deg > limit(UNUSABLE_DEG) {
        return Err(FitError::ModelDoesNotExplain {
            residual_deg,
            allowed_deg: limit(UNUSABLE_DEG),
        });
    }
    let is_large = residual_deg > limit(ALLOWED_DEG)
        || (residual_deg > limit(CAUTION_DEG) && noise_deg > limit(CAUTION_DEG));
    Ok(is_large.then_some(Caution::LargeResiduals { residual_deg }))
}

/// Fails where most of the samples have no weight in the fit.
///
/// # Errors
/// [`FitError::FewSamplesUsed`].
pub fn check_used(used: u64, found: u64) -> Result<(), FitError> {
    if used as f64 >= LEAST_USED_SHARE * found as f64 {
        return Ok(());
    }
    Err(FitError::FewSamplesUsed { used, found })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals evenly spread about a middle.
    fn check(middle_deg: f64, half_width_deg: f64) -> Result<Option<Caution>, FitError> {
        let place = |row: i32| f64::from(row) / 50.0 - 1.0;
        let residuals = (0..=100).map(|row| middle_deg + half_width_deg * place(row));
        check_residuals(residuals, &NoiseLevels::TYPICAL)
    }

    #[test]
    fn a_model_of_a_minority_of_the_samples_is_refused() {
        let (used, found) = (50, 101);
        let refusal = FitError::FewSamplesUsed { used, found };
        assert_eq!(check_used(used, found), Err(refusal));
        assert_eq!(check_used(51, found), Ok(()));
    }

    #[test]
    fn a_model_that_misses_its_own_samples_by_more_than_a_compass_may_deviate_is_refused() {
        let refused = check(6.0, 1.0);
        let is_named = matches!(
            refused,
            Err(FitError::ModelDoesNotExplain { residual_deg, .. }) if residual_deg > 5.0
        );
        assert!(is_named, "{refused:?}");
        // A reference that was wrong for days moves the constant.
        let beside = check(2.5, 1.0);
        assert!(
            matches!(beside, Ok(Some(Caution::LargeResiduals { .. }))),
            "{beside:?}"
        );
    }

    #[test]
    fn residuals_that_a_drift_angle_explains_are_no_contradiction() {
        let check = |drift_angle_deg: f64| {
            let levels = NoiseLevels {
                drift_angle_deg,
                ..NoiseLevels::TYPICAL
            };
            let residuals = (0..=100).map(|row| 0.16 * f64::from(row - 50));
            check_residuals(residuals, &levels)
        };
        assert_eq!(check(6.0), Ok(None));
        assert!(check(0.0).is_err());
    }
}
