//! Bands of a choice of soft iron, for the search.

use super::magnetic_state::MagneticState;
use crate::adjust::inputs::Water;
use crate::binnacle::{Setting, Soft};
use crate::corrector::effect;
use binnacle_compass::deviation::NORMAL_95;
use binnacle_compass::model::{Covariance, Parameters};
use binnacle_compass::ship::PARAMETERS;

/// Bands with a choice of soft iron and magnets that leave no B and C in the mean of the
/// waters. Without a covariance of the model the bands are zero.
pub(crate) struct IronBands {
    covariance: Covariance,
}

impl IronBands {
    /// Propagates the errors of model, λ and moved iron (docs/science.md, eq. 24).
    pub(crate) fn new(
        state: &MagneticState<'_>,
        standing: &Setting,
        soft: &Soft,
        waters: &[Water],
    ) -> IronBands {
        let setting = Setting {
            quadrantal: soft.quadrantal.clone(),
            flinders: soft.flinders.clone(),
            ..standing.clone()
        };
        let effect = effect(state.binnacle, &setting);
        let ship = state.with_effect(&effect, state.reference_h_nt);
        let covariance = ship.parameters_over_lambda().ok().map(|after| {
            let weights: f64 = waters.iter().map(|water| water.weight).sum();
            let z_nt = waters
                .iter()
                .map(|water| water.weight * water.z_nt)
                .sum::<f64>()
                / weights;
            let after = Parameters {
                bx_nt: -after.chi13 * z_nt,
                by_nt: -after.chi23 * z_nt,
                ..after
            };
            state.covariance(&setting, &after, &ship)
        });
        IronBands {
            covariance: covariance.unwrap_or_default(),
        }
    }

    /// Returns half the 95 % band on a magnetic heading in a water, radians, where hardly any
    /// deviation is left (docs/science.md, eq. 9 with δ = 0).
    pub(crate) fn band_rad(&self, water: &Water, magnetic_rad: f64) -> f64 {
        let (sin, cos) = magnetic_rad.sin_cos();
        let (sin2, cos2) = (2.0 * magnetic_rad).sin_cos();
        let slope: [f64; PARAMETERS + 1] = [
            sin / water.h_nt,
            water.z_nt * sin / water.h_nt,
            cos / water.h_nt,
            water.z_nt * cos / water.h_nt,
            sin2 / 2.0,
            (cos2 - 1.0) / 2.0,
            f64::midpoint(cos2, 1.0),
            1_f64.to_radians(),
        ];
        let row =
            |row: &[f64; PARAMETERS + 1]| row.iter().zip(slope).map(|(c, s)| c * s).sum::<f64>();
        let variance: f64 = self
            .covariance
            .iter()
            .zip(slope)
            .map(|(c, s)| s * row(c))
            .sum();
        NORMAL_95 * variance.max(0.0).sqrt()
    }
}
