//! Size of a change: a step of magnetism and of deviation, or the error of a disturbance.

use crate::constants::SMALLER_SHARE;
use crate::state_space::ship_state::ShipState;
use crate::state_space::states::USUAL_H_NT;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::result::Step;
use binnacle_compass::ship::{EarthField, PARAMETERS, compass_rad, wrap_pi};

/// Number of headings at which a change is evaluated.
const HEADINGS: u32 = 36;

/// Ship on both sides of a change.
#[derive(Clone, Copy)]
pub(super) struct Sides<'a> {
    pub(super) before: &'a ShipState,
    pub(super) after: &'a ShipState,
}

impl Sides<'_> {
    /// Returns the largest change of deviation over headings in a field, degrees.
    pub(super) fn worst_change_deg(self, earth: EarthField) -> f64 {
        let (before, after) = (self.before.parameters(), self.after.parameters());
        (0..HEADINGS)
            .map(|k| {
                let magnetic = f64::from(k * 360 / HEADINGS).to_radians();
                let compass = |p: &Parameters| {
                    let [x, y] = p.field_over_lambda(magnetic, earth);
                    compass_rad(x, y)
                };
                wrap_pi(compass(&before) - compass(&after)).abs()
            })
            .fold(0.0, f64::max)
            .to_degrees()
    }

    /// Returns the change of the compass's alignment, degrees.
    pub(super) fn alignment_change_deg(self) -> f64 {
        wrap_180(self.after.mean[PARAMETERS] - self.before.mean[PARAMETERS]).abs()
    }

    /// Returns the step of the permanent magnetism.
    pub(super) fn step(self) -> Step {
        let moved = |j: usize| self.after.mean[j] - self.before.mean[j];
        let se = |j: usize| {
            let variance = self.before.covariance[j][j] + self.after.covariance[j][j];
            variance.max(0.0).sqrt()
        };
        Step {
            bx_nt: moved(0),
            by_nt: moved(2),
            bx_se_nt: se(0),
            by_se_nt: se(2),
        }
    }
}

/// Error of the compass during a disturbance, degrees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disturbance {
    /// Error as it was seen.
    pub(super) seen_deg: f64,
    /// Error by the same field where H is 24 µT.
    pub(super) nominal_deg: f64,
}

/// Returns the error of the compass by its epoch's model, without a few wild readings; none
/// without readings.
pub(super) fn disturbance<'a>(
    readings: impl Iterator<Item = &'a Reading>,
    model: &Model,
) -> Option<Disturbance> {
    let (mut seen, mut nominal): (Vec<f64>, Vec<f64>) = readings
        .filter_map(|reading| {
            let (earth, measured_deg) = reading.earth.zip(reading.diagnostic.deviation_deg)?;
            let predicted = model.deviation(reading.sample().compass, earth).ok()?;
            let off = wrap_180(measured_deg - predicted.deviation.degrees_east()).abs();
            Some((off, off * earth.h_nt / USUAL_H_NT))
        })
        .unzip();
    let most = |of: &mut Vec<f64>| {
        of.sort_by(f64::total_cmp);
        of.get((SMALLER_SHARE * of.len() as f64) as usize).copied()
    };
    Some(Disturbance {
        seen_deg: most(&mut seen)?,
        nominal_deg: most(&mut nominal)?,
    })
}
