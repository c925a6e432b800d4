//! Rows without times, or with implausible times: groups of rows that may share one error.
//!
//! A gyro's swing and wander, and the compass's and the variation's errors, last for hours
//! (docs/science.md, §7), so that rows of half a day say almost the same. Rows on similar
//! headings may be of one such time, and are taken to be. The mean of n of them with a
//! share ρ of their variance in common is known as by n/(1 + (n − 1) ρ) independent ones
//! (the design effect of a sample of clusters \[Kish\]).

use crate::observation::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;

/// Width of the sectors within which headings are similar.
const SECTOR_DEG: f64 = 15.0;
/// Ten-minute rows in half a day.
const ROWS_IN_HALF_A_DAY: f64 = 72.0;

/// Returns true if every row has a time.
pub(super) fn all_dated(observations: &[Observation]) -> bool {
    observations.iter().all(|o| o.time.is_some())
}

/// Returns true if the rows' times are plausible: all have one, and most have it to
/// themselves. A clock that stood still for a while does no more harm than that.
pub(crate) fn are_times_plausible(observations: &[Observation]) -> bool {
    let times: Option<Vec<Timestamp>> = observations.iter().map(|o| o.time).collect();
    let Some(mut times) = times else {
        return false;
    };
    times.sort_unstable();
    let shared = times
        .chunk_by(|one, other| one == other)
        .map(<[Timestamp]>::len)
        .filter(|rows| *rows > 1);
    2 * shared.sum::<usize>() <= times.len()
}

/// Returns the sector of an observation's heading.
pub(super) fn heading_cell(o: &Observation) -> i64 {
    (o.compass.degrees() / SECTOR_DEG) as i64
}

/// Returns the ratio of variances to those of independent rows, by the number of rows in
/// each cell.
pub(super) fn design_effect(cells: impl Iterator<Item = f64>) -> f64 {
    let usual = NoiseLevels::TYPICAL;
    let in_common = 1.0 - usual.white_deg.powi(2) / usual.row_variance();
    let (mut rows, mut beside) = (0.0, 0.0);
    for count in cells {
        rows += count;
        beside += count * (count.min(ROWS_IN_HALF_A_DAY) - 1.0);
    }
    if rows > 0.0 {
        1.0 + in_common * beside / rows
    } else {
        1.0
    }
}
