//! Magnets that stood with the other end at the reading than recorded.
//!
//! The sum of ship and correctors is measured, and their shares follow from the record. A
//! wrong red end in it shows when the magnets move, and not before: the compass then turns
//! by twice their field more or less.

use super::inputs::Adjustment;
use super::instructions::{Step, compass_turn, replaced, reversed, stands};
use super::state::MagneticState;
use crate::binnacle::Binnacle;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::NORMAL_99;

/// Prior probability of magnets that stood with the other end than recorded, after someone
/// confirmed the record.
pub(crate) const FOUND_OTHERWISE: f64 = 0.002;

/// The binnacle with a step's magnets reversed at the reading, and the resulting turn.
pub(crate) struct FoundOtherwise {
    /// Binnacle with the setting as it would have been.
    pub(crate) binnacle: Binnacle,
    /// Turn of the compass by the step, degrees.
    pub(crate) change_deg: f64,
    /// Tolerance of the turn, degrees.
    pub(crate) tolerance_deg: f64,
}

impl FoundOtherwise {
    /// Supposes it of the magnets that a step moves; none for other correctors, or magnets
    /// that have moved since the reading.
    pub(crate) fn suppose(adjustment: &Adjustment<'_>, step: &Step) -> Option<FoundOtherwise> {
        let recorded = adjustment.binnacle;
        let from = step.from.as_ref()?;
        let other = reversed(from)?;
        if !stands(&recorded.setting, step.corrector, from) {
            return None;
        }
        let instead = |setting| replaced(setting, step.corrector, Some(from), Some(&other));
        let binnacle = recorded.with_setting(instead(&recorded.setting)).ok()?;
        let state = MagneticState::new(&Adjustment {
            binnacle: &binnacle,
            ..adjustment.clone()
        })
        .ok()?;
        let before = instead(&step.setting_before);
        let turn = compass_turn(adjustment, &state, &before, &step.setting_after);
        Some(FoundOtherwise {
            change_deg: turn.change_deg,
            tolerance_deg: (NORMAL_99 * turn.sd_deg).max(step.tolerance_deg),
            binnacle,
        })
    }

    /// Returns the observed less the resulting turn, degrees.
    pub(crate) fn off_deg(&self, turned_deg: f64) -> f64 {
        wrap_180(turned_deg - self.change_deg)
    }

    /// Logarithm of its prior probability times the density of the turn, per degree.
    pub(crate) fn log_weight(&self, turned_deg: f64) -> f64 {
        let sd_deg = self.tolerance_deg / NORMAL_99;
        FOUND_OTHERWISE.ln() + log_density(self.off_deg(turned_deg), sd_deg)
    }
}

/// Logarithm of a normal density but for its constant.
pub(crate) fn log_density(off: f64, sd: f64) -> f64 {
    -(off / sd).powi(2) / 2.0 - sd.ln()
}
