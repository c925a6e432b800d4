//! Readings of samples, with what excludes some of them.

use super::by_course::CourseUse;
use super::input::Input;
use super::references::References;
use binnacle_analysis::readings::berth_stays::mark_alongside;
use binnacle_analysis::readings::interference::interference;
use binnacle_analysis::readings::reading::{Reading, readings};
use binnacle_analysis::readings::stuck_compass::mark_stuck;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Change, FitError, SampleReason};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Readings in order of time.
pub(super) struct MarkedReadings {
    pub(super) readings: Vec<Reading>,
    /// Times at which the compass stood while the ship turned, and at which the receivers of
    /// satellites were disturbed.
    pub(super) faults: Vec<Change>,
    /// Places of the readings alongside, a range for each stay.
    pub(super) stays: Vec<Range<usize>>,
    /// Use of the course over ground, on a ship without heading reference.
    pub(super) course: Option<CourseUse>,
    /// Some of the readings before, and the comparison of the references by all.
    pub(super) sampled: Vec<Reading>,
    pub(super) references: References,
}

impl MarkedReadings {
    /// Marks readings in order of time, of a ship of some grade; `sampled` are some of those
    /// before.
    pub(super) fn new(
        mut readings: Vec<Reading>,
        grade: ReferenceGrade,
        sampled: Vec<Reading>,
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> MarkedReadings {
        let mut faults = mark_stuck(&mut readings);
        faults.extend(interference(&readings));
        let stays = mark_alongside(&mut readings);
        let course = CourseUse::mark(grade, &mut readings);
        let one_sd_deg = settings.reference_constant_sd_deg;
        let references = References::compare(grade, &sampled, &readings, logbook, one_sd_deg);
        references.mark_refused(&mut readings);
        MarkedReadings {
            readings,
            faults,
            stays,
            course,
            sampled,
            references,
        }
    }

    /// Returns the reason against the use of each reading.
    pub(super) fn marks(&self) -> Vec<Option<SampleReason>> {
        let readings = self.readings.iter();
        readings.map(|reading| reading.diagnostic.reason).collect()
    }

    /// Returns the place of the first reading from a time on, or that of the reading before a stay
    /// or fault that goes on then, if it began no earlier than another time.
    pub(super) fn place(&self, from: Timestamp, earliest: Timestamp) -> usize {
        let time = |place: usize| self.readings[place].sample().time;
        let stays = self.stays.iter();
        let stays = stays.map(|stay| (time(stay.start), Some(time(stay.end - 1))));
        let faults = self.faults.iter().map(|fault| (fault.from, fault.ended));
        let mut lasting: Vec<(Timestamp, Option<Timestamp>)> = stays.chain(faults).collect();
        lasting.sort_unstable_by(|a, b| b.cmp(a));
        let mut begin = from;
        for (from, until) in lasting {
            let goes_on = from < begin && until.is_none_or(|until| until >= begin);
            if goes_on && from >= earliest {
                begin = from;
            }
        }
        let place = self.readings.partition_point(|r| r.sample().time < begin);
        // What a stay changed shows against the reading before it.
        place.saturating_sub(usize::from(begin < from))
    }
}

/// Returns the first refusal of the references of an input.
pub(crate) fn refused_references(input: &Input<'_>) -> Option<FitError> {
    let grade = ReferenceGrade::of(input.samples);
    let readings = readings(input.samples, input.logbook, &input.settings, grade);
    let marked = MarkedReadings::new(readings, grade, Vec::new(), input.logbook, &input.settings);
    marked.references.refusal()
}
