//! The needles' part of D and E in a model.

use super::effect::Effect;
use super::setting_effect::effect;
use crate::binnacle::Binnacle;
use binnacle_compass::model::{Model, NeedleInduction};

/// Relative standard deviation of the needles' moment, which no catalogue gives.
pub(crate) const NEEDLE_SD: f64 = 0.1;
/// Mean of λ over ships with correctors, and its relative standard deviation.
const USUAL_LAMBDA: (f64, f64) = (0.9, 0.08);

/// Returns the needles' part of D and E of a model fitted to headings, by the binnacle's
/// setting (docs/science.md, eq. 18). Headings do not determine λ, so a usual one is assumed
/// with its error. None without spheres, or for a model that does not say in which field it
/// was fitted.
pub fn needles_of_model(binnacle: &Binnacle, model: &Model) -> Option<NeedleInduction> {
    let (lambda, lambda_sd) = USUAL_LAMBDA;
    let effect = effect(binnacle, &binnacle.setting);
    let known = needle_induction(&effect, lambda, model.reference_h_nt()?)?;
    Some(NeedleInduction {
        relative_sd: known.relative_sd.hypot(lambda_sd),
        ..known
    })
}

/// Returns the needles' part of D and E with correctors of this effect, for a λ and the
/// horizontal field at which a model contains it; none without spheres.
pub(crate) fn needle_induction(
    effect: &Effect,
    lambda: f64,
    reference_h_nt: f64,
) -> Option<NeedleInduction> {
    let [[along, cross], [_, across]] = effect.needle_nt;
    let of_needles = NeedleInduction {
        d_nt: (along - across) / (2.0 * lambda),
        e_nt: cross / lambda,
        reference_h_nt,
        relative_sd: NEEDLE_SD,
    };
    (of_needles.d_nt.hypot(of_needles.e_nt) > 0.0).then_some(of_needles)
}
