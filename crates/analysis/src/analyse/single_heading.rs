//! What a ship on about one course does not show of a strike.
//!
//! What always holds: the band is made wider where it is narrower than the courses that she
//! has sailed on account for, and never narrower.

use crate::fit::RobustFit;
use crate::observation::Observation;
use binnacle_compass::model::Model;

/// Headings that are scattered about their mean by less than this are one course: how stiff
/// the needle is as she yaws about it leans on errors of compass and reference as much as on
/// the ship, standard deviation in degrees.
const YAW_DEG: f64 = 1.5;
/// And beyond this they are several, which tell what they tell.
const SEVERAL_DEG: f64 = 8.0;

/// Opens the band of `fit` to a step of `unseen_nt`, standard deviation, along the needle on
/// the course sailed, as far as other courses do not tell.
pub(super) fn open_along(fit: &mut RobustFit, observations: &[Observation], unseen_nt: f64) {
    let weights = fit.rows.iter().map(|row| row.weight);
    let rows = observations.iter().zip(weights);
    let mut sums = [0.0; 3];
    for (o, weight) in rows {
        let (sin, cos) = (2.0 * o.compass.radians()).sin_cos();
        for (sum, x) in sums.iter_mut().zip([1.0, sin, cos]) {
            *sum += weight * x;
        }
    }
    let [all, sin, cos] = sums;
    if all <= 0.0 {
        return;
    }
    // Of the squares of bx sin ζ + by cos ζ: half of the angle whose mean direction this is,
    // and the part that lies across it.
    let course = 0.5 * sin.atan2(cos);
    let scatter = 0.5 - 0.5 * (sin.hypot(cos) / all).min(1.0);
    if scatter > SEVERAL_DEG.to_radians().powi(2) {
        return;
    }
    let by_turning = (scatter - YAW_DEG.to_radians().powi(2)).max(0.0);
    let (s, c) = course.sin_cos();
    let across = variance(&fit.model, [s, c]);
    let along = variance(&fit.model, [c, -s]);
    let (Some(across), Some(along)) = (across, along) else {
        return;
    };
    let told = by_turning / ((1.0 - scatter) * across);
    let open = 1.0 / (1.0 / unseen_nt.powi(2) + told) - along;
    let axis = [(0, c), (2, -s)];
    if let Some(covariance) = fit.model.covariance.as_mut().filter(|_| open > 0.0) {
        for (i, x) in axis {
            for (j, y) in axis {
                covariance[i][j] += open * x * y;
            }
        }
    }
}

/// Of the permanent field in a direction fore and aft and athwart, nT².
fn variance(model: &Model, [x, y]: [f64; 2]) -> Option<f64> {
    let c = model.covariance.as_ref()?;
    let variance = x * x * c[0][0] + x * y * (c[0][2] + c[2][0]) + y * y * c[2][2];
    (variance > 0.0).then_some(variance)
}
