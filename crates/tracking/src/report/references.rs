//! Comparison of the references in each epoch of the logbook, and the deviation by them.

use super::faults::Trust;
use super::voyage::LoggedWork;
use binnacle_analysis::fit::{HeadingReading, check_readings_independence, compare_references};
use binnacle_analysis::readings::reading::{Reading, heading_reading};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::{FitError, ReferenceCheck};
use std::ops::Range;

/// Gyro's share of the reference heading where both are read.
const GYRO_SHARE: f64 = 0.7;

/// References of the true headings.
pub(super) enum References {
    /// Gyro and satellite compass, with comparisons in order of time, one for each epoch of the
    /// logbook.
    Headings(Vec<ReferenceSpan>),
    /// Course over ground, with nothing to compare it with.
    CourseOverGround,
}

/// Comparison of the references in one epoch of the logbook.
pub(super) struct ReferenceSpan {
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
        References::Headings(spans.collect())
    }

    /// Returns the comparison to which the reading in a place belongs; the last one for a place
    /// beyond all readings, and none by course over ground.
    ///
    /// # Errors
    /// Fails when the references cannot be used.
    pub(super) fn at(&self, place: usize) -> Result<Option<ReferenceCheck>, FitError> {
        let References::Headings(spans) = self else {
            return Ok(None);
        };
        let within = spans.iter().find(|span| span.own.contains(&place));
        let span = within.or(spans.last());
        span.map(|span| span.compared.clone()).transpose()
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
        let heading_deg = match self {
            References::Headings(_) => self.heading_deg(place, reading, trust)?,
            References::CourseOverGround => sample.cog?.degrees(),
        };
        let variation_deg = reading.variation?.degrees_east();
        Some(wrap_180(
            heading_deg - variation_deg - sample.compass.degrees(),
        ))
    }

    /// Returns the true heading of a reading by the trusted references, degrees.
    fn heading_deg(&self, place: usize, reading: &Reading, trust: Trust) -> Option<f64> {
        let sample = reading.sample();
        let check = self.at(place).ok().flatten();
        let half = check.and_then(|check| check.offset_deg).unwrap_or(0.0) / 2.0;
        let gyro = reading.gyro.map(|gyro| gyro.degrees() - half);
        let satellite = sample.satellite.map(|heading| heading.degrees() + half);
        // Where neither is trusted, the deviation shows what both say.
        let is_any = (gyro.is_some() && trust.gyro) || (satellite.is_some() && trust.satellite);
        let gyro = gyro.filter(|_| trust.gyro || !is_any);
        let satellite = satellite.filter(|_| trust.satellite || !is_any);
        match (gyro, satellite) {
            (Some(gyro), Some(satellite)) => {
                Some(satellite + GYRO_SHARE * wrap_180(gyro - satellite))
            }
            (one, other) => one.or(other),
        }
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
    check_readings_independence(&referred)?;
    compare_references(&referred, one_constant_sd_deg)
}
