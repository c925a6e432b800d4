//! Whole analysis of a compass by the tracker: samples and logbook to epochs, models and
//! changes.

use super::by_course::{CourseUse, constant_sd_deg};
use super::cargo_entries::{include_contradicted, include_laden};
use super::changes::{Findings, changes};
use super::diagnostics::record_faults;
use super::epochs::{Boundaries, Fitting, fit_epochs, spans};
use super::faults::Faults;
use super::input::Input;
use super::marked_readings::MarkedReadings;
use super::notices::notices;
use super::overlaps::merge_overlapping;
use super::row_times::RowTimes;
use super::voyage::Voyage;
use crate::state_space::levels::{Level, Levels};
use binnacle_analysis::readings::berth_stays::add_berth_changes;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::coverage::{Coverage, coverage};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Analysis, ESTIMATOR, NoiseLevels};

/// Analyses all samples of one compass.
pub fn analyse(input: &Input<'_>) -> Analysis {
    let logbook = input.logbook;
    let MarkedReadings {
        mut readings,
        grade,
        faults: marked,
        stays,
        course,
        references,
    } = MarkedReadings::new(input);
    let mut voyage = Voyage::begin(&input.settings, input.prior);
    let rows = voyage.read_part(input, &readings);
    voyage.finish();
    let tracker = &voyage.tracker;
    let times = RowTimes::new(&rows, logbook);
    let now = times.last();
    let detected = merge_overlapping(&tracker.detected, now);
    let suspected = merge_overlapping(&tracker.suspected(), now);
    let current = tracker.current_ship();
    let until_sailing = tracker.ship_until_sailing();

    let faults = Faults::new(&detected, &suspected, now);
    let reference_sd_deg = input.settings.reference_constant_sd_deg;
    record_faults(&mut readings, &references, &faults);

    let boundaries = Boundaries::collect(&voyage.works, &detected, &times, logbook);
    let spans = spans(&boundaries, until_sailing.as_ref(), &readings);
    include_laden(&spans, &mut readings);
    let contradicted = include_contradicted(&spans, &mut readings, logbook);
    let fitting = Fitting {
        rows: &rows,
        predictions: &voyage.predictions,
        detected: &tracker.detected,
        references: &references,
        faults: &faults,
        prior: input.prior,
        course,
        noise: noise(tracker.levels(), course),
        one_reference_sd_deg: match grade {
            ReferenceGrade::Heading => reference_sd_deg,
            ReferenceGrade::CourseOverGround => constant_sd_deg(reference_sd_deg),
        },
    };
    let epochs = fit_epochs(&spans, &mut readings, &fitting);

    let mut changes = changes(&Findings {
        detected: &detected,
        suspected: &suspected,
        works: &voyage.works,
        boundaries: &boundaries,
        spans: &spans,
        epochs: &epochs,
        readings: &readings,
        times: &times,
        logbook,
        current: current.as_ref(),
    });
    changes.extend(marked);
    add_berth_changes(&stays, &readings, &epochs, &mut changes);
    changes.sort_by_key(|change| (change.from, change.detected_at));
    let mut remarks: Vec<String> = course.map(CourseUse::notice).into_iter().collect();
    remarks.extend(notices(&voyage, &readings, logbook, &epochs, &contradicted));
    Analysis {
        estimator: ESTIMATOR.to_owned(),
        notices: remarks,
        data_from: readings.first().map(|r| r.sample().time),
        data_until: readings.last().map(|r| r.sample().time),
        last_place: readings.iter().rev().find_map(Reading::place),
        coverage: covered(&readings),
        predictions: Some(voyage.predictions.coverage(None, &tracker.detected)),
        epochs,
        changes,
        samples: readings.into_iter().map(|r| r.diagnostic).collect(),
    }
}

/// Returns the headings and magnetic latitudes of the samples with a deviation.
fn covered(readings: &[Reading]) -> Coverage {
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
