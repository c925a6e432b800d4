//! Advice to read the field on another heading.

use crate::adjust::inputs::{AdjustError, Adjustment};
use crate::adjust::prediction;
use crate::adjust::state::MagneticState;
use crate::binnacle::Setting;
use binnacle_compass::angle::{wrap_180, wrap_360};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Steel on a quay that nobody notices, nT.
const UNNOTICED_NT: f64 = 4_000.0;
/// Least error that is worth shifting the ship for, degrees.
const WORTH_DEG: f64 = 1.0;

/// Advice to shift the vessel to another heading and read the field there too.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SecondHeading {
    /// Error of the plan that 4 µT of unnoticed steel along the needle would leave, and a
    /// second heading would prevent, on the worst heading at the berth, degrees.
    pub gain_deg: f64,
    /// Suitable magnetic headings, degrees: across the present one, and opposite to it.
    pub magnetic_deg: [f64; 3],
}

impl SecondHeading {
    /// Advises it where one heading cannot separate steel from λ, nothing else does, and the
    /// plan would suffer.
    pub(crate) fn advise(
        adjustment: &Adjustment<'_>,
        state: &MagneticState<'_>,
        setting: &Setting,
    ) -> Result<Option<SecondHeading>, AdjustError> {
        let circumstances = &adjustment.circumstances;
        let is_known = circumstances.shifted.is_some()
            || circumstances.earlier_lambda.is_some()
            || circumstances.is_updated_here;
        if is_known {
            return Ok(None);
        }
        let [forward, starboard] = adjustment.reading.field_nt();
        let share = UNNOTICED_NT / forward.hypot(starboard);
        let as_read = prediction::tables(adjustment, state, setting)?;
        let mut gain_deg = 0.0_f64;
        for sign in [1.0, -1.0] {
            let other = state.with_lambda(state.lambda() * (1.0 + sign * share));
            // In a weak field such steel leaves no directive force to speak of.
            let Ok(truly) = prediction::tables(adjustment, &other, setting) else {
                continue;
            };
            let (Some(said), Some(truly)) = (as_read.first(), truly.first()) else {
                continue;
            };
            for (said, truly) in said.rows.iter().zip(&truly.rows) {
                gain_deg = gain_deg.max(wrap_180(truly.deviation_deg - said.deviation_deg).abs());
            }
        }
        let here_deg = adjustment.reading.magnetic().degrees();
        Ok((gain_deg >= WORTH_DEG).then(|| SecondHeading {
            gain_deg,
            magnetic_deg: [90.0, 180.0, 270.0].map(|by| wrap_360(here_deg + by)),
        }))
    }
}

impl fmt::Display for SecondHeading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [across, opposite, other] = self.magnetic_deg;
        write!(
            f,
            "4 microtesla of steel on the quay along the needle would pass for another lambda and \
             leave up to {:.1} degrees that this plan does not predict: when she is shifted, a \
             second reading on about {across:.0}, {opposite:.0} or {other:.0} degrees magnetic \
             would show it",
            self.gain_deg
        )
    }
}
