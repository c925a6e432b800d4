//! Comparison of the references in each epoch of the logbook, and the deviation by them.

use super::faults::Trust;
use super::kept::{is_offered, keep_some};
use crate::state_space::scalar::GYRO_SHARE;
use binnacle_analysis::fit::{HeadingReading, check_references, compare_references};
use binnacle_analysis::readings::reading::{Reading, heading_reading};
use binnacle_compass::angle::{TrueHeading, wrap_180};
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{FitError, ReferenceCheck, SampleReason};
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// References of the true headings.
pub(super) struct References {
    grade: ReferenceGrade,
    /// Comparisons in order of time, one for each epoch of the logbook.
    spans: Vec<ReferenceSpan>,
}

/// Comparison of the references in one epoch of the logbook.
pub(super) struct ReferenceSpan {
    /// Work that began it.
    from: Option<Timestamp>,
    own: Range<usize>,
    /// None where a course over ground has nothing to be compared with.
    compared: Result<Option<ReferenceCheck>, FitError>,
}

impl References {
    /// Compares the references of readings in order of time; `sampled` are some of those before.
    pub(super) fn compare(
        grade: ReferenceGrade,
        sampled: &[Reading],
        readings: &[Reading],
        logbook: &[LogbookEntry],
        one_constant_sd_deg: f64,
    ) -> References {
        let works = works(logbook);
        let begins = std::iter::once(None).chain(works.iter().copied().map(Some));
        let ends = works.iter().copied().map(Some).chain([None]);
        let spans = begins.zip(ends).map(|(from, to)| {
            let own = within(readings, from, to);
            let sampled = &sampled[within(sampled, from, to)];
            ReferenceSpan {
                from,
                compared: compare(grade, sampled, &readings[own.clone()], one_constant_sd_deg),
                own,
            }
        });
        let spans = spans.collect();
        References { grade, spans }
    }

    /// Marks the readings of every epoch whose references cannot be used: nothing is made of
    /// them.
    pub(super) fn mark_refused(&self, readings: &mut [Reading]) {
        let refused = self.spans.iter().filter(|span| span.compared.is_err());
        for span in refused {
            for reading in &mut readings[span.own.clone()] {
                // Samples beside magnetic cargo are read, too.
                let reason = &mut reading.diagnostic.reason;
                if matches!(reason, None | Some(SampleReason::MagneticCargo)) {
                    *reason = Some(SampleReason::ReferenceFailed);
                }
            }
        }
    }

    /// Returns true if the references of the epoch of a time cannot be used.
    pub(super) fn is_refused(&self, time: Timestamp) -> bool {
        let begun = |span: &&ReferenceSpan| span.from.is_none_or(|from| from <= time);
        let span = self.spans.iter().rev().find(begun);
        span.is_some_and(|span| span.compared.is_err())
    }

    /// Returns the first refusal.
    pub(super) fn refusal(&self) -> Option<FitError> {
        let mut refused = self
            .spans
            .iter()
            .filter_map(|span| span.compared.as_ref().err());
        refused.next().cloned()
    }

    /// Returns the comparison to which the reading in a place belongs; the last one for a place
    /// beyond all readings, and none by course over ground.
    ///
    /// # Errors
    /// Fails when the references cannot be used.
    pub(super) fn at(&self, place: usize) -> Result<Option<ReferenceCheck>, FitError> {
        let within = self.spans.iter().find(|span| span.own.contains(&place));
        let span = within.or(self.spans.last());
        span.map_or(Ok(None), |span| span.compared.clone())
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
        let heading_deg = match self.grade {
            ReferenceGrade::Heading => self.heading_deg(place, reading, trust)?,
            ReferenceGrade::CourseOverGround => sample.cog?.degrees(),
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

/// Returns the times of work on ship or compass, in order.
fn works(logbook: &[LogbookEntry]) -> Vec<Timestamp> {
    let ending = logbook.iter().filter(|entry| entry.kind.ends_an_epoch());
    let mut times: Vec<Timestamp> = ending.map(|entry| entry.from).collect();
    times.sort_unstable();
    times.dedup();
    times
}

/// Returns the places of readings from one time until another.
fn within(readings: &[Reading], from: Option<Timestamp>, to: Option<Timestamp>) -> Range<usize> {
    let place = |at: Timestamp| readings.partition_point(|r| r.sample().time < at);
    from.map_or(0, place)..to.map_or(readings.len(), place)
}

/// Compares the references of an epoch. What is in days of rows shows in the latest ones, and
/// what takes many seas in a few of all.
fn compare(
    grade: ReferenceGrade,
    sampled: &[Reading],
    readings: &[Reading],
    one_constant_sd_deg: f64,
) -> Result<Option<ReferenceCheck>, FitError> {
    let reading = match grade {
        ReferenceGrade::Heading => heading_reading,
        ReferenceGrade::CourseOverGround => course_reading,
    };
    let all = || sampled.iter().chain(readings);
    let has_reference = |r: &Reading| r.sample().gyro.or(r.sample().satellite).is_some();
    if grade.is_heading() && all().next().is_some() && !all().any(has_reference) {
        return Err(FitError::NoReference {
            readings: all().count() as u64,
        });
    }
    check_references(&readings.iter().filter_map(reading).collect::<Vec<_>>())?;
    if !sampled.is_empty() {
        let mut some: Vec<&Reading> = all().collect();
        keep_some(&mut some, |reading| reading.sample().time);
        check_references(&some.into_iter().filter_map(reading).collect::<Vec<_>>())?;
    }
    if !grade.is_heading() {
        return Ok(None);
    }
    let referred: Vec<HeadingReading> = all().filter_map(reading).collect();
    compare_references(&referred, one_constant_sd_deg).map(Some)
}

/// Returns compass and course over ground where the course stands for a heading.
fn course_reading(reading: &Reading) -> Option<HeadingReading> {
    let reason = reading.diagnostic.reason;
    let is_steady = is_offered(reason) || reason == Some(SampleReason::ReferenceFailed);
    if !is_steady {
        return None;
    }
    let sample = reading.sample();
    let (variation, earth) = reading.variation.zip(reading.earth)?;
    Some(HeadingReading {
        time: Some(sample.time),
        position: Some(sample.position),
        compass: sample.compass,
        gyro: None,
        satellite: None,
        unnamed: TrueHeading::new(sample.cog?.degrees()),
        variation,
        h_nt: earth.h_nt,
        z_nt: earth.z_nt,
        // A course over ground has no speed error.
        sog_kn: None,
        windows: sample.windows,
        spread_deg: sample.spread_deg,
        weight: 1.0,
    })
}
