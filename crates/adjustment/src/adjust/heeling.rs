//! Heeling magnets, set only where the vertical field at the compass was measured
//! plausibly.
//!
//! The card has no heeling error when the vertical field at the compass is λ(1 − D) Z,
//! equal to the athwartship field in an earth's field of the same strength
//! (docs/science.md, eq. 23).

use super::inputs::Adjustment;
use super::state::{MagneticState, errors_between};
use crate::binnacle::{HeelingSetting, Red, Setting};
use crate::corrector::{Effect, Iron, effect, heeling_effect};
use binnacle_compass::deviation::NORMAL_99;
use serde::{Deserialize, Serialize};

/// Acceptable heeling error, degrees per degree of heel.
const GOOD_ENOUGH: f64 = 0.05;

/// Plan for the heeling magnets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct HeelingPlan {
    /// Present heeling error on north at the berth, degrees per degree of heel; none
    /// without a plausible vertical reading.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub before_deg_per_deg: Option<f64>,
    /// Heeling error after the plan, degrees per degree of heel.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub after_deg_per_deg: Option<f64>,
    /// Left as found for want of a plausible vertical reading.
    pub left_as_found: bool,
}

/// Predicts the magnetometer's vertical reading with correctors of this effect, nT.
fn down_nt(adjustment: &Adjustment<'_>, state: &MagneticState<'_>, effect: &Effect) -> Option<f64> {
    let read_nt = state.vertical?.down_nt;
    let z_nt = adjustment.earth.z_nt;
    Some(read_nt + state.chi33_change(effect) * z_nt + state.bz_change(effect))
}

/// Describes the check of a step with heeling magnets, which no compass on an even keel
/// shows; none without a vertical reading.
pub(crate) fn check_instruction(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    before: &Setting,
    after: &Setting,
) -> Option<String> {
    let binnacle = state.binnacle;
    let [was_nt, will_nt] =
        [before, after].map(|setting| down_nt(adjustment, state, &effect(binnacle, setting)));
    let (was_nt, will_nt) = (was_nt?, will_nt?);
    let errors = adjustment.reading.errors();
    let tilted_nt = adjustment.earth.h_nt * errors.tilt_sd_deg.to_radians();
    // Both readings use the same instrument: noise and tilt differ, its scale does not.
    let instrument_nt = std::f64::consts::SQRT_2 * errors.field_sd_nt.hypot(tilted_nt);
    let scale_nt = adjustment.scale_sd * (will_nt - state.vertical?.down_nt);
    let of_correctors = errors_between(binnacle, &binnacle.setting, after);
    let squares = of_correctors.iter().map(|error| {
        let down_nt = error.chi[2][2] * adjustment.earth.z_nt + error.b_nt[2];
        down_nt.powi(2)
    });
    let correctors_nt = squares.sum::<f64>().sqrt();
    let sd_nt = instrument_nt.hypot(scale_nt).hypot(correctors_nt);
    Some(format!(
        "on an even keel the compass does not show these: with the bowl out, the magnetometer in \
         its previous place must now read {:.1} microtesla down, within {:.1}; before this step \
         {:.1}",
        will_nt / 1e3,
        NORMAL_99 * sd_nt / 1e3,
        was_nt / 1e3
    ))
}

/// Predicts J with correctors of this effect, degrees per degree.
fn heeling_error(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    effect: &Effect,
) -> Option<f64> {
    let at_card_nt = down_nt(adjustment, state, effect)?;
    let z_nt = adjustment.earth.z_nt;
    let h_nt = adjustment.earth.h_nt;
    let ship = state.with_effect(effect, h_nt);
    Some(((1.0 + ship.chi[1][1]) * z_nt - at_card_nt) / (ship.lambda() * h_nt))
}

/// Chooses the magnets with the least heeling error for this iron; keeps the present ones
/// without a vertical reading, or where they are good enough.
pub(crate) fn choose_magnets(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    iron: &Iron,
    of_iron: &Effect,
) -> Option<HeelingSetting> {
    let standing = adjustment.standing().heeling.clone();
    let binnacle = state.binnacle;
    let error = |set: Option<&HeelingSetting>| {
        let of_magnets = set.map(|set| heeling_effect(binnacle, iron, set));
        let whole = of_iron.plus(&of_magnets.unwrap_or_default());
        heeling_error(adjustment, state, &whole).map(f64::abs)
    };
    let (Some(bucket), Some(now)) = (&binnacle.design.heeling, error(standing.as_ref())) else {
        return standing;
    };
    if now <= GOOD_ENOUGH {
        return standing;
    }
    let available = binnacle.magnet_count(&bucket.magnet);
    let mut best = (now, standing);
    let mut all = vec![None];
    for place in &bucket.positions {
        for count in (1..=bucket.at_most).filter(|count| u16::from(*count) <= available) {
            for red in [Red::Up, Red::Down] {
                all.push(Some(HeelingSetting {
                    position: place.number,
                    count,
                    red,
                }));
            }
        }
    }
    for set in all {
        if let Some(error) = error(set.as_ref())
            && error < best.0
        {
            best = (error, set);
        }
    }
    best.1
}

pub(crate) fn heeling_plan(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    setting: &Setting,
) -> HeelingPlan {
    let of = |setting: &Setting| heeling_error(adjustment, state, &effect(state.binnacle, setting));
    HeelingPlan {
        before_deg_per_deg: of(&adjustment.binnacle.setting),
        after_deg_per_deg: of(setting),
        left_as_found: state.vertical.is_none(),
    }
}
