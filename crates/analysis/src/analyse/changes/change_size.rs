//! Size of a change, as a step of magnetism and of deviation.

use crate::analyse::reading::Reading;
use crate::change::{Event, Snapshot};
use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::result::{Cause, Change, Epoch, Step};
use binnacle_compass::ship::EarthField;

const HEADINGS: u32 = 36;

/// Returns the largest change of deviation over headings in a field, degrees.
pub(super) fn worst_change_deg(before: &Parameters, after: &Parameters, earth: EarthField) -> f64 {
    (0..HEADINGS)
        .map(|k| {
            let magnetic = f64::from(k * 360 / HEADINGS).to_radians();
            let compass = |p: &Parameters| {
                let [x, y] = p.field_over_lambda(magnetic, earth);
                binnacle_compass::ship::compass_rad(x, y)
            };
            binnacle_compass::ship::wrap_pi(compass(before) - compass(after)).abs()
        })
        .fold(0.0, f64::max)
        .to_degrees()
}

/// Horizontal field for which disturbances are given in degrees, nT.
const USUAL_H_NT: f64 = 24_000.0;
/// Share of the readings with a smaller error: the largest are wild readings.
const SMALLER_SHARE: f64 = 0.75;

/// Error of the compass against the earlier state, degrees.
pub(super) struct Disturbance {
    /// Error as it was seen.
    pub(super) seen_deg: f64,
    /// Error by the same field where H is 24 µT.
    pub(super) nominal_deg: f64,
}

/// Returns the error of the compass without a few wild readings.
pub(super) fn disturbance(before: &Snapshot, readings: &[Observation]) -> Disturbance {
    let off = |o: &Observation| {
        let magnetic = o.compass.degrees() + o.deviation.degrees_east() - before.constant_deg;
        let earth = EarthField {
            h_nt: o.h_nt,
            z_nt: o.z_nt,
        };
        let field = before
            .parameters
            .field_over_lambda(magnetic.to_radians(), earth);
        let expected = binnacle_compass::ship::compass_rad(field[0], field[1]).to_degrees();
        let seen_deg = wrap_180(o.compass.degrees() - expected).abs();
        (seen_deg, seen_deg * o.h_nt / USUAL_H_NT)
    };
    let (seen, usual): (Vec<f64>, Vec<f64>) = readings.iter().map(off).unzip();
    let most = |mut of: Vec<f64>| {
        of.sort_by(f64::total_cmp);
        let place = (SMALLER_SHARE * of.len() as f64) as usize;
        of.get(place).copied().unwrap_or(0.0)
    };
    Disturbance {
        seen_deg: most(seen),
        nominal_deg: most(usual),
    }
}

/// Returns the change of the compass's alignment, degrees.
pub(super) fn alignment_change_deg(before: &Snapshot, after: &Snapshot) -> f64 {
    wrap_180(after.constant_deg - before.constant_deg).abs()
}

pub(super) fn step(before: &Snapshot, after: &Snapshot) -> Step {
    let se = |j: usize| {
        (before.covariance[j][j] + after.covariance[j][j])
            .max(0.0)
            .sqrt()
    };
    Step {
        bx_nt: after.parameters.bx_nt - before.parameters.bx_nt,
        by_nt: after.parameters.by_nt - before.parameters.by_nt,
        bx_se_nt: se(0),
        by_se_nt: se(2),
    }
}

/// Returns the cosine between two steps of (bx, by); 0 where one is zero.
pub(super) fn cosine(one: &Event, other: &Event) -> f64 {
    let of = |event: &Event| {
        let step = step(&event.before, &event.after);
        (step.bx_nt, step.by_nt)
    };
    let ((ax, ay), (bx, by)) = (of(one), of(other));
    let product = ax.hypot(ay) * bx.hypot(by);
    if product == 0.0 {
        0.0
    } else {
        (ax * bx + ay * by) / product
    }
}

/// Updates the size of a change by the models of the epochs on both sides.
pub(crate) fn refine_size(
    change: &mut Change,
    before: &Epoch,
    after: &Epoch,
    readings: &[Reading],
) {
    let (Some(old), Some(new)) = (&before.model, &after.model) else {
        return;
    };
    let mut until = readings
        .iter()
        .filter(|r| r.sample().time <= change.detected_at);
    let Some(earth) = until.next_back().and_then(|reading| reading.earth) else {
        return;
    };
    let (Some(old), Some(new)) = (of_model(old), of_model(new)) else {
        return;
    };
    if change.cause == Cause::Alignment {
        change.deviation_change_deg = Some(alignment_change_deg(&old, &new));
        return;
    }
    change.step = Some(step(&old, &new));
    change.deviation_change_deg = Some(worst_change_deg(&old.parameters, &new.parameters, earth));
}

fn of_model(model: &Model) -> Option<Snapshot> {
    Some(Snapshot {
        parameters: model.parameters_over_lambda,
        constant_deg: model.constant_deg,
        covariance: model.covariance?,
    })
}
