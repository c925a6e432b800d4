//! λ of an earlier berth, carried over to the present setting.

use super::corrector_errors::setting_errors;
use super::field_drift::drift_nt;
use super::magnetic_state::MagneticState;
use crate::adjust::inputs::{AdjustError, Adjustment, EarlierLambda};
use crate::binnacle::{Binnacle, Setting};
use crate::corrector::{Effect, effect};
use binnacle_compass::time::Timestamp;

impl EarlierLambda {
    /// Determines λ from a berth, with the setting of its binnacle.
    ///
    /// # Errors
    /// Fails when its reading gives no λ.
    pub fn from_berth(
        at: Timestamp,
        adjustment: &Adjustment<'_>,
    ) -> Result<Option<EarlierLambda>, AdjustError> {
        let state = MagneticState::new(adjustment)?;
        let lambda = state.lambda();
        let [forward, starboard] = adjustment.reading.field_nt();
        let drift = drift_nt(adjustment) / forward.hypot(starboard);
        // Without the model's covariance, the error of λ is unknown.
        let earlier = adjustment.model.covariance.map(|_| EarlierLambda {
            at,
            lambda,
            standard_error: lambda * state.lambda_sd_share().hypot(drift),
        });
        Ok(earlier)
    }

    /// Converts λ from the setting `stood` to the setting of this binnacle, with the
    /// tolerance of the moved correctors as an error. `None` where the binnacle does not
    /// allow `stood`.
    #[must_use]
    pub fn adapted_to(self, binnacle: &Binnacle, stood: &Setting) -> Option<EarlierLambda> {
        binnacle.with_setting(stood.clone()).ok()?;
        // Needles add nothing to λ.
        let share = |effect: &Effect| effect.as_ship(f64::INFINITY).lambda() - 1.0;
        let of = |setting: &Setting| share(&effect(binnacle, setting));
        let errors = setting_errors(binnacle, stood).into_iter();
        let add = |sum: f64, error: Effect| sum.hypot(share(&error));
        Some(EarlierLambda {
            at: self.at,
            lambda: self.lambda + of(&binnacle.setting) - of(stood),
            standard_error: errors.fold(self.standard_error, add),
        })
    }
}
