//! Turn of the compass at the berth from one setting to another.

use crate::adjust::diagnosis::turn_sd_deg;
use crate::adjust::inputs::Adjustment;
use crate::adjust::state::{MagneticState, errors_between};
use crate::berth::Alignment;
use crate::binnacle::Setting;
use crate::corrector::{Effect, effect};
use binnacle_compass::angle::{wrap_180, wrap_360};
use binnacle_compass::deviation::NORMAL_99;

/// Least tolerance of a step, degrees.
const LEAST_TOLERANCE_DEG: f64 = 0.5;

/// Predicts the compass heading at the berth with correctors of this effect, degrees.
pub(crate) fn compass_at_berth(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    effect: &Effect,
) -> f64 {
    let reading = adjustment.reading;
    let aligned_deg = match reading.alignment() {
        Alignment::Keel => 0.0,
        Alignment::AsFitted => state.constant_deg(),
    };
    let magnetic_deg = reading.magnetic().degrees() - aligned_deg;
    let ship = state.with_effect(effect, adjustment.earth.h_nt);
    let deviation = ship.deviation_rad(magnetic_deg.to_radians(), adjustment.earth);
    wrap_360(magnetic_deg - deviation.to_degrees())
}

/// Turn of the compass from one setting to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompassTurn {
    /// Change of the compass heading, degrees, clockwise positive.
    pub(crate) change_deg: f64,
    /// Standard error of the change, degrees.
    pub(crate) sd_deg: f64,
}

/// Predicts the turn of the compass at the berth from one setting to another.
pub(crate) fn compass_turn(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    before: &Setting,
    after: &Setting,
) -> CompassTurn {
    let of = |effect: &Effect| compass_at_berth(adjustment, state, effect);
    let [old, new] = [before, after].map(|setting| effect(state.binnacle, setting));
    let shown = of(&new);
    let change = wrap_180(shown - of(&old));
    let errors = errors_between(state.binnacle, before, after);
    let variance: f64 = errors
        .iter()
        .map(|error| wrap_180(of(&new.plus(error)) - shown).powi(2))
        .sum();
    let of_lambda = change * state.lambda_sd_share();
    CompassTurn {
        change_deg: change,
        sd_deg: variance.sqrt().hypot(of_lambda),
    }
}

/// Returns the tolerance of a turn with this standard error in a horizontal field, degrees.
pub(crate) fn tolerance_deg(sd_deg: f64, h_nt: f64) -> f64 {
    let tolerance_deg = NORMAL_99 * sd_deg.hypot(turn_sd_deg(h_nt));
    tolerance_deg.max(LEAST_TOLERANCE_DEG)
}
