//! Readings of samples, with what excludes some of them.

use super::by_course::CourseUse;
use super::input::Input;
use super::references::References;
use binnacle_analysis::readings::berth_stays::mark_alongside;
use binnacle_analysis::readings::interference::interference;
use binnacle_analysis::readings::reading::{Reading, readings};
use binnacle_analysis::readings::stuck_compass::mark_stuck;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Change, FitError};
use std::ops::Range;

/// Readings in order of time.
pub(super) struct MarkedReadings {
    pub(super) readings: Vec<Reading>,
    pub(super) grade: ReferenceGrade,
    /// Times at which the compass stood while the ship turned, and at which the receivers of
    /// satellites were disturbed.
    pub(super) faults: Vec<Change>,
    /// Places of the readings alongside, a range for each stay.
    pub(super) stays: Vec<Range<usize>>,
    /// Use of the course over ground, on a ship without heading reference.
    pub(super) course: Option<CourseUse>,
    pub(super) references: References,
}

impl MarkedReadings {
    /// Takes and marks the readings of an input.
    pub(super) fn new(input: &Input<'_>) -> MarkedReadings {
        let grade = ReferenceGrade::of(input.samples);
        let mut readings = readings(input.samples, input.logbook, &input.settings, grade);
        let mut faults = mark_stuck(&mut readings);
        faults.extend(interference(&readings));
        let stays = mark_alongside(&mut readings);
        let course = CourseUse::mark(grade, &mut readings);
        let one_sd_deg = input.settings.reference_constant_sd_deg;
        let references = References::compare(grade, &readings, input.logbook, one_sd_deg);
        references.mark_refused(&mut readings);
        MarkedReadings {
            readings,
            grade,
            faults,
            stays,
            course,
            references,
        }
    }
}

/// Returns the first refusal of the references of an input.
pub(crate) fn refused_references(input: &Input<'_>) -> Option<FitError> {
    MarkedReadings::new(input).references.refusal()
}
