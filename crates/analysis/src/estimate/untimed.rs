//! Rows without times, or with times that cannot be theirs: which of them share one error,
//! for all that can be known.
//!
//! A gyro's swing and wander, the compass's and the variation's errors last for hours
//! (docs/science.md, §7), so that rows of half a day tell almost the same thing again.
//! Rows on like headings may be of one such time, and are held to be: of n of them with a
//! part ρ of their variance in common a mean is known as by n/(1 + (n − 1) ρ) independent
//! ones (the design effect of a sample of clusters \[Kish\]).

use crate::fit::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;

/// Headings are alike within this.
const SECTOR_DEG: f64 = 15.0;
/// Ten-minute rows in half a day.
const OF_HALF_A_DAY: f64 = 72.0;

/// Whether every row says when it was taken.
pub(super) fn all_timed(observations: &[Observation]) -> bool {
    observations.iter().all(|o| o.time.is_some())
}

/// Whether the rows' times can be what they are said to be: all have one, and most have
/// it to themselves. A clock that stood still for a while spoils no more than that.
pub(crate) fn are_times_believed(observations: &[Observation]) -> bool {
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

/// The sector of heading that an observation lies in.
pub(super) fn cell_of(o: &Observation) -> i64 {
    (o.compass.degrees() / SECTOR_DEG) as i64
}

/// How many times larger variances are than of independent rows, by the number of
/// rows in each cell.
pub(super) fn design_effect(cells: impl Iterator<Item = f64>) -> f64 {
    let usual = NoiseLevels::TYPICAL;
    let in_common = 1.0 - usual.white_deg.powi(2) / usual.row_variance();
    let (mut rows, mut beside) = (0.0, 0.0);
    for count in cells {
        rows += count;
        beside += count * (count.min(OF_HALF_A_DAY) - 1.0);
    }
    if rows > 0.0 {
        1.0 + in_common * beside / rows
    } else {
        1.0
    }
}
