//! Distribution of observations over headings.

use crate::observation::Observation;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::result::FitError;
use serde::{Deserialize, Serialize};

/// Sectors of heading, of 15° each.
const SECTORS: usize = 24;
const SECTOR_DEG: u32 = 15;
/// Least number of sectors with samples.
const NEEDED_SECTORS: u32 = 6;
/// Widest gap: beyond a wider one the deviation would be the prior's alone.
const ALLOWED_GAP_DEG: f64 = 240.0;

/// Least and greatest heading in each sector: all gaps that matter lie between these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Headings {
    ends: [Option<(f64, f64)>; SECTORS],
}

impl Headings {
    /// Adds a heading.
    pub fn add(&mut self, compass: CompassHeading) {
        let heading = compass.degrees();
        self.widen(
            heading as usize / SECTOR_DEG as usize % SECTORS,
            heading,
            heading,
        );
    }

    /// Adds all headings of others.
    pub fn append(&mut self, others: &Headings) {
        for (sector, ends) in others.ends.iter().enumerate() {
            if let Some((from, to)) = *ends {
                self.widen(sector, from, to);
            }
        }
    }

    fn widen(&mut self, sector: usize, from: f64, to: f64) {
        let (least, most) = self.ends[sector].get_or_insert((from, to));
        *least = least.min(from);
        *most = most.max(to);
    }

    /// Checks that they suffice for a model.
    ///
    /// # Errors
    /// [`FitError::TooFewHeadings`] with the missing sectors.
    pub fn check(&self) -> Result<(), FitError> {
        let filled = self.ends.map(|ends| ends.is_some());
        let found = filled.iter().filter(|&&filled| filled).count() as u32;
        let mut widest_gap_deg: f64 = 0.0;
        let ends = || self.ends.iter().flatten().copied();
        let around = ends().next();
        let around = around.map(|(least, most)| (least + 360.0, most + 360.0));
        let next = ends().skip(1).chain(around);
        for ((_, most), (least, _)) in ends().zip(next) {
            widest_gap_deg = widest_gap_deg.max(least - most);
        }
        if found >= NEEDED_SECTORS && widest_gap_deg <= ALLOWED_GAP_DEG {
            return Ok(());
        }
        Err(FitError::TooFewHeadings {
            found,
            needed: NEEDED_SECTORS,
            widest_gap_deg,
            allowed_gap_deg: ALLOWED_GAP_DEG,
            missing_deg: missing(&filled),
        })
    }
}

/// Checks that observations lie on enough headings for a model.
///
/// # Errors
/// [`FitError::TooFewHeadings`] with the missing sectors.
pub(super) fn check_headings(rows: &[Observation]) -> Result<(), FitError> {
    let mut headings = Headings::default();
    for row in rows {
        headings.add(row.compass);
    }
    headings.check()
}

/// Returns ranges of empty sectors, each by its first degree and the one after its last; a
/// range through north ends beyond 360.
fn missing(filled: &[bool; SECTORS]) -> Vec<(u32, u32)> {
    let Some(first_filled) = filled.iter().position(|&filled| filled) else {
        return vec![(0, 360)];
    };
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for sector in (first_filled..first_filled + SECTORS).filter(|s| !filled[s % SECTORS]) {
        let from = sector as u32 * SECTOR_DEG;
        match ranges.last_mut() {
            Some((_, to)) if *to == from => *to += SECTOR_DEG,
            _ => ranges.push((from, from + SECTOR_DEG)),
        }
    }
    for range in ranges.iter_mut().filter(|range| range.0 >= 360) {
        *range = (range.0 - 360, range.1 - 360);
    }
    ranges.sort_unstable();
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_sectors_run_together_and_through_north() {
        let mut filled = [true; SECTORS];
        for sector in [0, 1, 6, 7, 8, 12, 23] {
            filled[sector] = false;
        }
        let missing = missing(&filled);
        assert_eq!(missing, [(90, 135), (180, 195), (345, 390)]);
        assert_eq!(super::missing(&[false; SECTORS]), [(0, 360)]);
    }
}
