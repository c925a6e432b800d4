//! Stuck reference: one that does not move while the vessel turns.
//!
//! A reference that repeats itself is stuck as soon as the compass turns. One that
//! oscillates about one heading may be that of a vessel that keeps its course, so that the
//! compass must have gone round: steel cargo or lightning moves a compass from one heading
//! to another, and wild readings are few. Where the other reference is steady, too, the
//! compass is at fault.

use super::reading::{HeadingReading, Trust};
use binnacle_compass::angle::{TrueHeading, wrap_180};

/// Least number of identical readings in a row.
const IDENTICAL_MIN_ROWS: usize = 6;
/// Difference below which readings are identical, degrees.
const SAME_DEG: f64 = 0.02;
/// Turn of the compass from which the vessel turned, degrees.
const TURNED_DEG: f64 = 5.0;

/// Greatest difference from the first of a row, degrees, of a reference that oscillates.
const OSCILLATION_DEG: f64 = 1.0;
/// Greatest circular standard deviation of all readings of such a reference, degrees.
const OSCILLATION_SD_DEG: f64 = 5.0;
/// Least number of oscillating readings, least number of 30° sectors of the compass among
/// them, and the share of the readings in each.
const OSCILLATION_MIN_ROWS: usize = 12;
const ROUND_SECTORS: usize = 4;
const SECTOR_SHARE: f64 = 0.06;
/// Greatest difference from the median, degrees, and share of such readings, of a steady
/// reference.
const STEADY_DEG: f64 = 2.0;
const STEADY_PART: f64 = 0.8;

/// Heading of the reference at one reading.
#[derive(Clone, Copy)]
struct ReferenceHeading {
    /// Index of the reading.
    index: usize,
    heading_deg: f64,
}

/// Returns trust in every reference except where it was stuck; `order` is that of time.
pub(super) fn trust(readings: &[HeadingReading], order: &[usize]) -> Vec<Trust> {
    let both = Trust {
        gyro: true,
        satellite: true,
    };
    let mut trust = vec![both; readings.len()];
    let gyro = |r: &HeadingReading| r.gyro.map(TrueHeading::degrees);
    let satellite = |r: &HeadingReading| r.satellite.map(TrueHeading::degrees);
    for index in stuck(readings, order, gyro, satellite) {
        trust[index].gyro = false;
    }
    for index in stuck(readings, order, satellite, gyro) {
        trust[index].satellite = false;
    }
    trust
}

/// Returns the readings in rows of a constant reference under a turning compass.
fn stuck(
    readings: &[HeadingReading],
    order: &[usize],
    reference: impl Fn(&HeadingReading) -> Option<f64>,
    other: impl Fn(&HeadingReading) -> Option<f64>,
) -> Vec<usize> {
    let there = order.iter().filter_map(|&index| {
        Some(ReferenceHeading {
            index,
            heading_deg: reference(&readings[index])?,
        })
    });
    let there: Vec<ReferenceHeading> = there.collect();
    let repeating = there
        .chunk_by(|a, b| wrap_180(a.heading_deg - b.heading_deg).abs() < SAME_DEG)
        .filter(|row| row.len() >= IDENTICAL_MIN_ROWS && heading_changed(readings, row));
    let whole = [there.as_slice()].into_iter();
    let oscillating = rows_within(&there, OSCILLATION_DEG)
        .filter(|row| {
            !is_steady(
                row.iter().filter_map(|at| other(&readings[at.index])),
                row.len(),
            )
        })
        .chain(whole.filter(|all| circular_sd_deg(all) < OSCILLATION_SD_DEG))
        .filter(|row| row.len() >= OSCILLATION_MIN_ROWS && covers_full_circle(readings, row));
    repeating
        .chain(oscillating)
        .flat_map(|row| row.iter().map(|at| at.index))
        .collect()
}

/// Returns true if the vessel kept its course by headings that were read at most of `of`
/// times.
fn is_steady(headings: impl Iterator<Item = f64>, of: usize) -> bool {
    let mut first = None;
    let mut off: Vec<f64> = headings
        .map(|heading| wrap_180(heading - *first.get_or_insert(heading)))
        .collect();
    off.sort_by(f64::total_cmp);
    let Some(middle) = off.get(off.len() / 2).copied() else {
        return false;
    };
    let near = off.iter().filter(|off| (*off - middle).abs() < STEADY_DEG);
    2 * off.len() > of && near.count() as f64 >= STEADY_PART * off.len() as f64
}

/// Returns the rows of readings near the first of each row.
fn rows_within(
    there: &[ReferenceHeading],
    near_deg: f64,
) -> impl Iterator<Item = &[ReferenceHeading]> {
    let mut rest = there;
    std::iter::from_fn(move || {
        let first = rest.first()?.heading_deg;
        let far = |at: &ReferenceHeading| wrap_180(at.heading_deg - first).abs() > near_deg;
        let (row, others) = rest.split_at(rest.iter().position(far).unwrap_or(rest.len()));
        rest = others;
        Some(row)
    })
}

/// Returns the standard deviation of directions about their mean direction \[Mardia\].
fn circular_sd_deg(row: &[ReferenceHeading]) -> f64 {
    let (sin, cos) = row.iter().fold((0.0, 0.0), |(sin, cos), at| {
        let (s, c) = at.heading_deg.to_radians().sin_cos();
        (sin + s, cos + c)
    });
    let length = f64::hypot(sin, cos) / row.len().max(1) as f64;
    (-2.0 * length.min(1.0).ln()).max(0.0).sqrt().to_degrees()
}

/// Returns true if the compass showed enough different headings in a row.
fn covers_full_circle(readings: &[HeadingReading], row: &[ReferenceHeading]) -> bool {
    let mut sectors = [0_usize; 12];
    for at in row {
        sectors[(readings[at.index].compass.degrees() / 30.0) as usize % 12] += 1;
    }
    let enough = (SECTOR_SHARE * row.len() as f64).max(1.0);
    let filled = sectors.iter().filter(|&&count| count as f64 >= enough);
    filled.count() >= ROUND_SECTORS
}

/// Returns true if the compass turned in a row.
fn heading_changed(readings: &[HeadingReading], row: &[ReferenceHeading]) -> bool {
    let compass = |at: &ReferenceHeading| readings[at.index].compass.degrees();
    let first = compass(&row[0]);
    row.iter()
        .any(|at| wrap_180(compass(at) - first).abs() > TURNED_DEG)
}
