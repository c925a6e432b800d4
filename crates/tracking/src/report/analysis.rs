//! Report on a voyage: epochs, models and changes.

use super::by_course::{CourseUse, constant_sd_deg};
use super::cargo_entries::{include_contradicted, include_laden};
use super::changes::{Changes, Findings, changes, record_disturbed};
use super::diagnostics::record_faults;
use super::epochs::{Boundaries, Fitting, fit_epochs, spans};
use super::faults::Faults;
use super::marked_readings::MarkedReadings;
use super::notices::notices;
use super::overlaps::merge_overlapping;
use super::row_times::{RowTime, RowTimes};
use super::voyage::Voyage;
use crate::state_space::levels::{Level, Levels};
use crate::weighing::records::Detected;
use binnacle_analysis::readings::berth_stays::add_berth_changes;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::coverage::{Coverage, coverage};
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::SampleReason;
use binnacle_compass::result::{Analysis, Change, ESTIMATOR, Epoch, NoiseLevels};
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Report on a voyage.
pub(super) struct Report {
    /// Readings that are not settled, with their outcome, and the reasons against their use before.
    pub(super) readings: Vec<Reading>,
    pub(super) marks: Vec<Option<SampleReason>>,
    pub(super) epochs: Vec<Epoch>,
    /// Places of the readings of each epoch.
    pub(super) owns: Vec<Range<usize>>,
    pub(super) faults: Faults,
    /// Changes by events, and by marks of the readings that are not settled.
    pub(super) events: Vec<(Detected, Change)>,
    pub(super) marked: Vec<Change>,
    /// Dates of events and work.
    pub(super) dates: Vec<Timestamp>,
    pub(super) rows: Vec<RowTime>,
    others: Vec<Change>,
    notices: Vec<String>,
}

impl Report {
    /// Reports on the readings that are not settled, and on what is known of the rest.
    pub(super) fn new(voyage: &Voyage, marked: MarkedReadings, logbook: &[LogbookEntry]) -> Report {
        let marks = marked.marks();
        let MarkedReadings {
            mut readings,
            faults: mut by_marks,
            stays,
            course,
            sampled,
            references,
        } = marked;
        let course = course.map(|own| {
            let mut all = voyage.past.course.unwrap_or_default();
            all.append(&own);
            all
        });
        let tracker = &voyage.tracker;
        let current = tracker.current_ship();
        let until_sailing = tracker.ship_until_sailing();
        let rows = voyage.row_times(&readings);
        let times = RowTimes::new(&rows, logbook);
        let now = times.last();
        let found = |events: &[Detected]| {
            let mut events = merge_overlapping(events, now);
            events.retain(|event| !references.is_refused(event.at));
            events
        };
        let detected = found(&tracker.detected);
        let suspected = found(&tracker.suspected());

        let faults = Faults::new(&detected, &suspected, now);
        let reference_sd_deg = voyage.reference_sd_deg();
        record_faults(&mut readings, &references, &faults);

        let boundaries = Boundaries::collect(&voyage.works, &detected, &times, logbook);
        let past = &voyage.past;
        let spans = spans(&boundaries, until_sailing.as_ref(), &readings, &past.pieces);
        include_laden(&spans, &mut readings);
        let contradicted = include_contradicted(&spans, &mut readings, past, logbook);
        let fitting = Fitting {
            rows: &voyage.rows,
            predictions: &voyage.predictions,
            detected: &tracker.detected,
            references: &references,
            faults: &faults,
            prior: voyage.prior(),
            course,
            noise: noise(tracker.levels(), course),
            one_reference_sd_deg: match voyage.grade {
                ReferenceGrade::Heading => reference_sd_deg,
                ReferenceGrade::CourseOverGround => constant_sd_deg(reference_sd_deg),
            },
            settled: &past.epochs,
            sampled: &sampled,
        };
        let epochs = fit_epochs(&spans, &mut readings, &fitting);

        let Changes { events, others } = changes(&Findings {
            detected: &detected,
            suspected: &suspected,
            works: &voyage.works,
            boundaries: &boundaries,
            spans: &spans,
            epochs: &epochs,
            readings: &readings,
            past,
            times: &times,
            logbook,
            current: current.as_ref(),
        });
        let events = events.into_iter();
        let events = events.map(|(place, change)| (detected[place].clone(), change));
        add_berth_changes(&stays, &readings, &epochs, &mut by_marks);
        for change in &mut by_marks {
            record_disturbed(change, &readings, &epochs);
        }
        let mut remarks: Vec<String> = course.map(CourseUse::notice).into_iter().collect();
        remarks.extend(notices(voyage, &readings, logbook, &epochs, &contradicted));
        Report {
            events: events.collect(),
            marked: by_marks,
            dates: boundaries.dates(&voyage.works, &tracker.detected),
            others,
            notices: remarks,
            marks,
            owns: spans.iter().map(|span| span.own.clone()).collect(),
            epochs,
            faults,
            rows,
            readings,
        }
    }

    /// Returns the analysis, with the diagnoses of the readings that are not settled.
    pub(super) fn into_analysis(self, voyage: &Voyage) -> Analysis {
        let past = &voyage.past;
        let mut changes = self.others;
        changes.extend(self.events.into_iter().map(|(_, change)| change));
        changes.extend(self.marked);
        changes.extend(past.marked.iter().cloned());
        changes.sort_by_key(|change| (change.from, change.detected_at));
        let mut counted = past.coverage.clone();
        counted.append(&covered(&self.readings));
        let detected = &voyage.tracker.detected;
        let readings = &self.readings;
        Analysis {
            estimator: ESTIMATOR.to_owned(),
            notices: self.notices,
            data_from: past.from().or(readings.first().map(|r| r.sample().time)),
            data_until: readings.last().map(|r| r.sample().time),
            last_place: readings.iter().rev().find_map(Reading::place),
            coverage: counted,
            predictions: Some(voyage.predictions.coverage(None, detected)),
            epochs: self.epochs,
            changes,
            samples: self.readings.into_iter().map(|r| r.diagnostic).collect(),
        }
    }
}

/// Returns the headings and magnetic latitudes of the samples with a deviation.
pub(super) fn covered(readings: &[Reading]) -> Coverage {
    let with_deviation = readings
        .iter()
        .filter(|r| r.diagnostic.deviation_deg.is_some());
    coverage(with_deviation.filter_map(|r| r.earth.map(|e| (r.sample().compass, e.h_nt, e.z_nt))))
}

/// Returns the levels as reported; those of instruments are zero on a ship without them.
fn noise(levels: &Levels, course: Option<CourseUse>) -> NoiseLevels {
    let of_instruments = |level: Level| match course {
        None => levels.at(level),
        Some(_) => 0.0,
    };
    NoiseLevels {
        white_deg: levels.at(Level::White),
        schuler_deg: of_instruments(Level::Schuler),
        turn_deg: 2.0 * of_instruments(Level::Schuler),
        slow_gyro_deg: of_instruments(Level::GyroSlow),
        compass_swing_deg: levels.at(Level::Swing),
        variation_deg: levels.at(Level::Variation),
        drift_nt: levels.at(Level::Drift),
        satellite_deg: of_instruments(Level::Reflection),
        difference_deg: of_instruments(Level::DifferenceWhite),
        drift_angle_deg: course.map_or(0.0, |course| course.drift_angle_deg(levels)),
    }
}
