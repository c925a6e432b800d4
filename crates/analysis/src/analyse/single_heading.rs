//! Uncertainty after a strike while the vessel sails on about one course.
//!
//! The band is widened where it is narrower than the courses sailed account for, and never
//! narrowed.

use crate::fit::RobustFit;
use crate::observation::Observation;
use binnacle_compass::model::Model;

/// Scatter of the headings below which they count as one course, standard deviation in
/// degrees: the needle's stiffness while yawing depends on errors of compass and reference
/// as much as on the vessel.
const YAW_DEG: f64 = 1.5;
/// Scatter above which the courses suffice.
const SEVERAL_DEG: f64 = 8.0;

/// Widens the band of `fit` for a step of `unseen_nt`, standard deviation, along the needle
/// on the course sailed, as far as other courses do not show it.
pub(super) fn widen_along_needle(
    fit: &mut RobustFit,
    observations: &[Observation],
    unseen_nt: f64,
) {
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
    // From the squares of bx sin ζ + by cos ζ: half of the mean direction's angle, and the
    // share across it.
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
    let shown = by_turning / ((1.0 - scatter) * across);
    let open = 1.0 / (1.0 / unseen_nt.powi(2) + shown) - along;
    let axis = [(0, c), (2, -s)];
    if let Some(covariance) = fit.model.covariance.as_mut().filter(|_| open > 0.0) {
        for (i, x) in axis {
            for (j, y) in axis {
                covariance[i][j] += open * x * y;
            }
        }
    }
}

/// Returns the variance of the permanent field in a direction fore and aft and athwart,
/// nT².
fn variance(model: &Model, [x, y]: [f64; 2]) -> Option<f64> {
    let c = model.covariance.as_ref()?;
    let variance = x * x * c[0][0] + x * y * (c[0][2] + c[2][0]) + y * y * c[2][2];
    (variance > 0.0).then_some(variance)
}
