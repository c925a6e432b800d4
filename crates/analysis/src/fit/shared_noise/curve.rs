//! Smooth difference of reference and compass: a curve of deviation, and what a copy's
//! arithmetic adds to it.

use super::pair::HeadingPair;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::position::Position;
use nalgebra::{SMatrix, SVector};

/// Number of unknowns: five coefficients of the curve, and the slopes by variation, latitude,
/// longitude, time, speed error and rate of turn.
const UNKNOWNS: usize = 11;
/// Greatest time between pairs whose difference is a rate of turn, seconds.
const RATE_WITHIN_S: f64 = 15.0;
/// Weight of the prior of each slope, in pairs: it only keeps what pairs do not show finite.
const PRIOR: f64 = 1e-6;
const ITERATIONS: u32 = 20;
/// Residual from which a pair loses weight, degrees.
const FULL_WEIGHT_DEG: f64 = 0.02;

type Columns = SVector<f64, UNKNOWNS>;

/// Residuals about the curve.
pub(super) struct Residuals {
    /// Residual of each pair, degrees.
    pub(super) degrees: Vec<f64>,
    /// Difference of each pair less that of the first, degrees.
    pub(super) differences_deg: Vec<f64>,
    /// Value of these where reference less variation is the compass itself.
    pub(super) none_deg: f64,
    /// Number of unknowns of the curve.
    pub(super) unknowns: usize,
    /// Mean slope of the curve at the pairs, degrees a degree: on a steady course any noise of
    /// the compass lies on a line of slope −1.
    pub(super) slope: f64,
}

/// Returns the residuals of the chosen pairs about the curve of least absolute residuals;
/// none where it cannot be found.
pub(super) fn residuals(sorted: &[HeadingPair], chosen: &[usize]) -> Option<Residuals> {
    let first = sorted[*chosen.first()?];
    let middle = first.difference_deg();
    let rows: Vec<(Columns, f64)> = chosen
        .iter()
        .map(|&i| {
            let difference = middle + wrap_180(sorted[i].difference_deg() - middle);
            (columns(sorted, i, &first), difference)
        })
        .collect();
    let mut solution = Columns::zeros();
    let mut weights = vec![1.0; rows.len()];
    for _ in 0..ITERATIONS {
        let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity() * PRIOR;
        let mut right = Columns::zeros();
        for ((columns, difference), weight) in rows.iter().zip(&weights) {
            normal += columns * columns.transpose() * *weight;
            right += columns * (*difference * weight);
        }
        solution = normal.cholesky()?.solve(&right);
        for ((columns, difference), weight) in rows.iter().zip(&mut weights) {
            let residual = difference - columns.dot(&solution);
            *weight = 1.0 / (residual.abs() / FULL_WEIGHT_DEG).max(1.0);
        }
    }
    let degrees = rows
        .iter()
        .map(|(columns, difference)| difference - columns.dot(&solution));
    Some(Residuals {
        degrees: degrees.collect(),
        differences_deg: rows.iter().map(|(_, d)| d - middle).collect(),
        none_deg: -middle,
        unknowns: UNKNOWNS,
        slope: mean_slope(sorted, chosen, &solution),
    })
}

/// Returns the mean slope of a curve at the chosen pairs, degrees a degree.
fn mean_slope(sorted: &[HeadingPair], chosen: &[usize], solution: &Columns) -> f64 {
    let slopes = chosen.iter().map(|&i| {
        let (sin, cos) = sorted[i].compass.radians().sin_cos();
        let (sin_2, cos_2) = (2.0 * sorted[i].compass.radians()).sin_cos();
        let slope = solution[1] * cos - solution[2] * sin
            + 2.0 * (solution[3] * cos_2 - solution[4] * sin_2);
        slope.to_radians()
    });
    slopes.sum::<f64>() / chosen.len() as f64
}

/// Returns the columns of a pair, each of the size of one at most where possible.
fn columns(sorted: &[HeadingPair], place: usize, first: &HeadingPair) -> Columns {
    let pair = &sorted[place];
    let (sin, cos) = pair.compass.radians().sin_cos();
    let (sin_2, cos_2) = (2.0 * pair.compass.radians()).sin_cos();
    let (north, east) = match (pair.position, first.position) {
        (Some(here), Some(there)) => apart(here, there),
        _ => (0.0, 0.0),
    };
    let days = match (pair.time, first.time) {
        (Some(now), Some(then)) => now.seconds_since(then) / 86_400.0,
        _ => 0.0,
    };
    Columns::from([
        1.0,
        sin,
        cos,
        sin_2,
        cos_2,
        wrap_180(pair.variation_deg() - first.variation_deg()) / 10.0,
        north,
        east,
        days / 30.0,
        pair.speed_error_deg(),
        rate_of_turn(sorted, place),
    ])
}

/// Returns the distance to the north and to the east, in tens of degrees.
fn apart(here: Position, there: Position) -> (f64, f64) {
    (
        (here.lat_deg() - there.lat_deg()) / 10.0,
        wrap_180(here.lon_deg() - there.lon_deg()) / 10.0,
    )
}

/// Returns the rate of turn since the pair before, degrees a second; 0 where that is too long
/// ago.
fn rate_of_turn(sorted: &[HeadingPair], place: usize) -> f64 {
    let Some(before) = place.checked_sub(1).map(|place| &sorted[place]) else {
        return 0.0;
    };
    let pair = &sorted[place];
    match (pair.time, before.time) {
        (Some(now), Some(then)) => {
            let seconds = now.seconds_since(then);
            if 0.0 < seconds && seconds <= RATE_WITHIN_S {
                wrap_180(pair.compass_deg() - before.compass_deg()) / seconds
            } else {
                0.0
            }
        }
        _ => 0.0,
    }
}
