//! Analysis as a fold over segments, and settlement of readings that no later one can change.

use super::analysis::{Report, covered};
use super::by_course::CourseUse;
use super::epochs::judged;
use super::input::{Input, Part};
use super::kept::{SettledReading, keep_some};
use super::marked_readings::MarkedReadings;
use super::past::{Piece, SettledEvent};
use super::row_times::RowTime;
use super::voyage::Voyage;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Analysis, SampleDiagnostic};
use binnacle_compass::sample::Sample;
use binnacle_compass::segment::Segment;
use binnacle_compass::time::Timestamp;

/// Age from which readings are settled, seconds: events are dated back by 20 days and a day, and
/// only then is an epoch's end certain.
const SETTLED_S: f64 = 30.0 * 86_400.0;
/// Age up to which readings are kept because a stay or a fault that goes on began with them.
const LONGEST_S: f64 = 60.0 * 86_400.0;

/// Analyses all samples of one compass.
pub fn analyse(input: &Input<'_>) -> Analysis {
    let mut samples = input.samples.to_vec();
    samples.sort_by_key(|sample| sample.time);
    let segments: Vec<&[Sample]> = samples
        .chunk_by(|a, b| Segment::of(a.time) == Segment::of(b.time))
        .collect();
    let part = |samples, end| Part::new(samples, input.logbook, input.azimuths, end);
    let mut voyage = Voyage::begin(
        &input.settings,
        input.prior,
        ReferenceGrade::of(input.samples),
    );
    let (last, closed) = segments
        .split_last()
        .map_or((&[][..], &[][..]), |(last, closed)| (*last, closed));
    let mut settled: Vec<SampleDiagnostic> = Vec::new();
    for segment in closed {
        let end = Segment::of(segment[0].time).end();
        settled.extend(voyage.advance(&part(segment, end)));
    }
    let mut analysis = voyage.report(&part(last, None));
    settled.append(&mut analysis.samples);
    Analysis {
        samples: settled,
        ..analysis
    }
}

impl Voyage {
    /// Reads the next part of the voyage. Returns the diagnoses that are settled by it, in order
    /// of time: those of all samples but the last month's, which later ones may change.
    pub fn advance(&mut self, part: &Part<'_>) -> Vec<SampleDiagnostic> {
        let marked = self.read_part(part);
        self.tracker.condense();
        self.predictions.round();
        self.settle(marked, &part.logbook)
    }

    /// Reads the last part of the voyage, and reports on all. The report has the diagnoses that
    /// no part before has settled.
    pub fn report(mut self, part: &Part<'_>) -> Analysis {
        let marked = self.read_part(part);
        self.finish();
        Report::new(&self, marked, &part.logbook).into_analysis(&self)
    }

    /// Settles what is old enough. Returns the diagnoses.
    fn settle(
        &mut self,
        marked: MarkedReadings,
        logbook: &[LogbookEntry],
    ) -> Vec<SampleDiagnostic> {
        let Some(last) = marked.readings.last().map(|r| r.sample().time) else {
            return Vec::new();
        };
        let ago = |seconds: f64| last.plus_seconds(-seconds);
        let cut = marked.place(ago(SETTLED_S), ago(LONGEST_S));
        if cut == 0 {
            return Vec::new();
        }
        let mut report = Report::new(self, marked, logbook);
        let before = report.readings[cut].sample().time;
        self.settle_epochs(&report, cut);
        let past = &mut self.past;
        past.rows = report.next_to_dates(before);
        past.sampled
            .extend(report.readings[..cut].iter().map(SettledReading::of));
        if let Some(work) = self.works.iter().rev().find(|work| work.at <= before) {
            past.sampled.retain(|reading| reading.time() >= work.at);
        }
        keep_some(&mut past.sampled, SettledReading::time);
        past.coverage.append(&covered(&report.readings[..cut]));
        if !self.grade.is_heading() {
            let course = past.course.get_or_insert_default();
            course.append(&CourseUse::of(&report.readings[..cut]));
        }
        let marked = report.marked.iter();
        past.marked
            .extend(marked.filter(|change| change.from < before).cloned());
        let events = report.events.iter();
        past.events = events
            .filter_map(|(detected, change)| SettledEvent::of(detected, change, before))
            .collect();
        self.predictions.forget(before, &self.tracker.detected);
        self.kept.drain(..cut);
        let first = self.rows.partition_point(|row| row.place < cut);
        self.rows.drain(..first);
        for row in &mut self.rows {
            row.place -= cut;
        }
        let settled = report.readings.drain(..cut);
        settled.map(|reading| reading.diagnostic).collect()
    }

    /// Adds the readings before a place to the sums of their epochs, and keeps the epochs that
    /// ended with them.
    fn settle_epochs(&mut self, report: &Report, cut: usize) {
        let before = report.readings[cut].sample().time;
        for own in &report.owns {
            let (begin, end) = (own.start.min(cut), own.end.min(cut));
            let readings = &report.readings[begin..end];
            let judged = judged(&self.rows, &(begin..end), &report.readings);
            let piece = Piece::of(readings, &report.marks[begin..end], &report.faults, judged);
            self.past.pieces.extend(piece);
        }
        let epochs = report.epochs.iter();
        let over = epochs.take_while(|epoch| epoch.to.is_some_and(|to| to <= before));
        self.past.epochs = over.cloned().collect();
    }
}

impl Report {
    fn next_to_dates(&self, before: Timestamp) -> Vec<RowTime> {
        super::row_times::next_to(&self.rows, &self.dates, before)
    }
}
