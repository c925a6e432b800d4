//! Analysis of one compass: from its samples and the vessel's logbook to epochs and their
//! models.
//!
//! [`analyse`] is a pure function. The order of the samples and repeated samples change
//! nothing, to the last bit. No sample is left out without a reason. Samples that do not
//! carry a model yield a refusal that names what is missing.

pub mod berth_stays;
mod cargo_entries;
mod changes;
mod epoch;
mod epoch_builder;
pub mod logbook_rules;
mod mixture;
pub mod reading;
mod single_heading;
pub mod steady_course;
pub mod stuck_compass;

use berth_stays::{add_berth_changes, mark_alongside};
use binnacle_compass::coverage::coverage;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Analysis, ESTIMATOR, Epoch};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use cargo_entries::notices;
use changes::merge_faults;
use epoch::epochs;
use epoch_builder::EpochBuilder;
use reading::{Reading, readings};
use stuck_compass::mark_stuck;

/// Notice while changes cannot be detected.
const UNWATCHED: &str = "too little is known of the vessel so far to detect a change of its \
                         magnetism: one would not be noticed. Steady courses on more \
                         headings, by gyro or satellite compass, are needed";

/// Analyses all samples of one compass.
pub fn analyse(
    samples: &[Sample],
    logbook: &[LogbookEntry],
    settings: &AnalysisSettings,
) -> Analysis {
    let mut readings = readings(samples, logbook, settings, ReferenceGrade::Heading);
    let mut builder = EpochBuilder::after(mark_stuck(&mut readings));
    let stays = mark_alongside(&mut readings);
    let mut corrected_start = None;
    for epoch in epochs(logbook) {
        let from = corrected_start.or(epoch.from);
        corrected_start =
            builder.add_logbook_epoch(Epoch { from, ..epoch }, &mut readings, logbook, settings);
    }
    let mut notices = notices(&readings, logbook, &builder.contradicted);
    if builder.is_unwatched {
        notices.push(UNWATCHED.to_owned());
    }
    let EpochBuilder {
        epochs,
        mut changes,
        ..
    } = builder;
    add_berth_changes(&stays, &readings, &epochs, &mut changes);
    changes.sort_by_key(|change| (change.from, change.detected_at));
    merge_faults(&mut changes, &epochs);
    let with_deviation = readings
        .iter()
        .filter(|r| r.diagnostic.deviation_deg.is_some());
    let coverage = coverage(
        with_deviation.filter_map(|r| r.earth.map(|e| (r.sample().compass, e.h_nt, e.z_nt))),
    );
    Analysis {
        estimator: ESTIMATOR.to_owned(),
        data_from: readings.first().map(|r| r.sample().time),
        data_until: readings.last().map(|r| r.sample().time),
        last_place: readings.iter().rev().find_map(Reading::place),
        coverage,
        predictions: None,
        epochs,
        changes,
        notices,
        samples: readings.into_iter().map(|r| r.diagnostic).collect(),
    }
}
