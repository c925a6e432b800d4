//! Comparison of the references in each epoch of the logbook, and the deviation by them.

use super::faults::Trust;
use super::voyage::LoggedWork;
use binnacle_analysis::analyse::reading::{Reading, heading_reading};
use binnacle_analysis::fit::{HeadingReading, compare_references};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::{FitError, ReferenceCheck};
use std::ops::Range;

/// Gyro's share of the reference heading where both are read.
const GYRO_SHARE: f64 = 0.7;

/// Comparisons in order of time, one for each epoch of the logbook.
pub(super) struct References {
    spans: Vec<ReferenceSpan>,
}

/// Comparison of the references in one epoch of the logbook.
struct ReferenceSpan {
    own: Range<usize>,
    compared: Result<ReferenceCheck, FitError>,
}

impl References {
    /// Compares the references of readings in order of time.
    pub(super) fn compare(
        readings: &[Reading],
        works: &[LoggedWork],
        one_constant_sd_deg: f64,
    ) -> References {
        let place = |work: &LoggedWork| readings.partition_point(|r| r.sample().time < work.at);
        let begins = std::iter::once(0).chain(works.iter().map(place));
        let ends = works.iter().map(place).chain([readings.len()]);
        let spans = begins.zip(ends).map(|(begin, end)| ReferenceSpan {
            own: begin..end,
            compared: compare(&readings[begin..end], one_constant_sd_deg),
        });
        References {
            spans: spans.collect(),
        }
    }

    /// Returns the comparison to which the reading in a place belongs; the last one for a place
    /// beyond all readings.
    pub(super) fn at(&self, place: usize) -> &Result<ReferenceCheck, FitError> {
        let within = self.spans.iter().find(|span| span.own.contains(&place));
        let last = &self.spans[self.spans.len() - 1];
        &within.unwrap_or(last).compared
    }

    /// Returns reference less variation less compass of a reading, degrees; none without a
    /// reference or a field.
    pub(super) fn deviation_deg(
        &self,
        place: usize,
        reading: &Reading,
        trust: Trust,
    ) -> Option<f64> {
        let sample = reading.sample();
        let check = self.at(place).as_ref().ok();
        let half = check.and_then(|check| check.offset_deg).unwrap_or(0.0) / 2.0;
        let gyro = reading.gyro.map(|gyro| gyro.degrees() - half);
        let satellite = sample.satellite.map(|heading| heading.degrees() + half);
        // Where neither is trusted, the deviation shows what both say.
        let is_any = (gyro.is_some() && trust.gyro) || (satellite.is_some() && trust.satellite);
        let gyro = gyro.filter(|_| trust.gyro || !is_any);
        let satellite = satellite.filter(|_| trust.satellite || !is_any);
        let heading_deg = match (gyro, satellite) {
            (Some(gyro), Some(satellite)) => satellite + GYRO_SHARE * wrap_180(gyro - satellite),
            (one, other) => one.or(other)?,
        };
        let variation_deg = reading.variation?.degrees_east();
        Some(wrap_180(
            heading_deg - variation_deg - sample.compass.degrees(),
        ))
    }
}

fn compare(readings: &[Reading], one_constant_sd_deg: f64) -> Result<ReferenceCheck, FitError> {
    let has_reference = |r: &Reading| r.sample().gyro.or(r.sample().satellite).is_some();
    if !readings.is_empty() && !readings.iter().any(has_reference) {
        return Err(FitError::NoReference {
            readings: readings.len() as u64,
        });
    }
    let referred: Vec<HeadingReading> = readings.iter().filter_map(heading_reading).collect();
    compare_references(&referred, one_constant_sd_deg)
}
