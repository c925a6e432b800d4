//! A reference that repeats itself while the ship turns.

use super::{HeadingReading, Trust};
use crate::angle::{TrueHeading, wrap_180};

/// So many readings in a row must be the same.
const ROW: usize = 6;
/// Readings closer than this are the same, degrees.
const SAME_DEG: f64 = 0.02;
/// The ship turned when her compass did so by more than this, degrees.
const TURNED_DEG: f64 = 5.0;

/// Believes every reference but where it was stuck; `order` is that of time.
pub(super) fn trust(readings: &[HeadingReading], order: &[usize]) -> Vec<Trust> {
    let both = Trust {
        gyro: true,
        satellite: true,
    };
    let mut trust = vec![both; readings.len()];
    let gyro = |r: &HeadingReading| r.gyro.map(TrueHeading::degrees);
    for index in stuck(readings, order, gyro) {
        trust[index].gyro = false;
    }
    let satellite = |r: &HeadingReading| r.satellite.map(TrueHeading::degrees);
    for index in stuck(readings, order, satellite) {
        trust[index].satellite = false;
    }
    trust
}

/// Readings in rows of the same reference under a turning compass.
fn stuck(
    readings: &[HeadingReading],
    order: &[usize],
    reference: impl Fn(&HeadingReading) -> Option<f64>,
) -> Vec<usize> {
    let there = order
        .iter()
        .filter_map(|&i| Some((i, reference(&readings[i])?)));
    let there: Vec<(usize, f64)> = there.collect();
    there
        .chunk_by(|a, b| wrap_180(a.1 - b.1).abs() < SAME_DEG)
        .filter(|row| row.len() >= ROW && turned(readings, row))
        .flat_map(|row| row.iter().map(|&(index, _)| index))
        .collect()
}

fn turned(readings: &[HeadingReading], row: &[(usize, f64)]) -> bool {
    let compass = |&(index, _): &(usize, f64)| readings[index].compass.degrees();
    let first = compass(&row[0]);
    row.iter()
        .any(|at| wrap_180(compass(at) - first).abs() > TURNED_DEG)
}
