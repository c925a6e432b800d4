//! Causes that changes are attributed to.

use crate::voyages::fleet::{Event, Log, Name, sail_log};
use crate::{HOUR_S, analyse_with, began, calm, entry, is_sound, of_the_ship, run};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::result::{Analysis, Cause, Change, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

const DAY_S: f64 = 86_400.0;

fn with(log: &Log, logbook: &[binnacle_compass::logbook::LogbookEntry]) -> Analysis {
    analyse_with(&log.samples, logbook, &AnalysisSettings::default())
}

/// Returns the change nearest in time.
fn nearest(analysis: &Analysis, to: Timestamp) -> &Change {
    let off = |c: &&Change| c.from.seconds_since(to).abs();
    let changes = analysis.changes.iter();
    changes.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
}

#[test]
fn a_gyro_fault_with_a_satellite_compass_on_board_is_named_at_once() {
    // Among them a ship whose gyro is believed to have settled two weeks before.
    let ships = 30..37;
    let mut without_false_change = 0;
    for seed in ships.clone() {
        let log = sail_log(seed, &calm(Event::GyroFault(4.0)));
        let broke = began(&log, Name::GyroFault);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        without_false_change += usize::from(of_the_ship(&analysis).is_empty());
        let two_hours = broke.plus_seconds(2.0 * HOUR_S);
        let is_named = analysis.changes.iter().any(|c| {
            c.cause == Cause::ReferenceFault
                && c.detected_at < two_hours
                && c.ended.is_none_or(|ended| ended > two_hours)
        });
        assert!(is_named, "seed {seed}: {:?}", analysis.changes);
    }
    assert!(without_false_change + 1 >= ships.count());
}

#[test]
fn an_adjustment_is_reported_as_expected() {
    let log = sail_log(10, &calm(Event::Nothing));
    let at = log.samples[log.samples.len() / 2].time;
    let logbook = [entry(LogbookKind::Adjustment, at, None)];
    let analysis = analyse_with(&log.samples, &logbook, &AnalysisSettings::default());
    is_sound(&analysis);
    assert_eq!(analysis.changes.len(), 1, "{:?}", analysis.changes);
    assert_eq!(analysis.changes[0].cause, Cause::AdjustmentOrRepair);
    assert!(analysis.changes[0].step.is_some());
}

#[test]
fn a_compass_that_sticks_is_named_and_its_samples_are_left_out() {
    let mut samples = sail_log(60, &calm(Event::Nothing)).samples;
    let from = samples.len() / 2;
    let stuck = samples[from].compass;
    for sample in &mut samples[from..] {
        sample.compass = stuck;
    }
    let analysis = run(&samples);
    is_sound(&analysis);
    let reported: Vec<_> = analysis.changes.iter().map(|c| c.cause).collect();
    assert_eq!(reported, [Cause::CompassFault], "{:?}", analysis.changes);
    assert!(analysis.changes[0].evidence[0].contains("while the vessel turned"));
    assert!(analysis.changes[0].ended.is_none());
    let reasons = analysis.samples[from..].iter().map(|s| s.reason);
    assert!(
        reasons
            .into_iter()
            .all(|r| r == Some(SampleReason::CompassStuck))
    );
    assert!(
        analysis.samples[..from]
            .iter()
            .all(|s| s.reason != Some(SampleReason::CompassStuck))
    );
}

#[test]
fn magnetism_that_fades_after_lightning_hardly_ever_raises_another_alarm() {
    let reported = (60..66).map(|seed| {
        let mut plan = calm(Event::Lightning(4000.0));
        plan.days = 75.0;
        let log = sail_log(seed, &plan);
        let struck = began(&log, Name::Lightning);
        let analysis = run(&log.samples);
        assert_eq!(nearest(&analysis, struck).cause, Cause::LightningOrShock);
        of_the_ship(&analysis).len()
    });
    let reported: usize = reported.sum();
    assert!(reported <= 7, "{reported} alarms of 6 strikes");
}

#[test]
fn work_in_the_logbook_explains_a_change_until_it_ends() {
    let log = sail_log(1, &calm(Event::Step(2000.0)));
    let stepped = began(&log, Name::Step);
    let from = stepped.plus_seconds(-4.4 * DAY_S);
    let to = stepped.plus_seconds(1.6 * DAY_S);
    let analysis = with(&log, &[entry(LogbookKind::Repair, from, Some(to))]);
    assert_eq!(nearest(&analysis, stepped).cause, Cause::AdjustmentOrRepair);
}

#[test]
fn cargo_loaded_later_is_no_cause_of_a_change_at_sea() {
    let log = sail_log(1, &calm(Event::Step(2000.0)));
    let stepped = began(&log, Name::Step);
    let loaded = stepped.plus_seconds(1.8 * DAY_S);
    let analysis = with(&log, &[entry(LogbookKind::MagneticCargo, loaded, None)]);
    assert_eq!(nearest(&analysis, stepped).cause, Cause::LightningOrShock);
}

#[test]
fn a_report_dates_a_change_between_two_samples() {
    let mut log = sail_log(1, &calm(Event::Step(2000.0)));
    let stepped = began(&log, Name::Step);
    let is_read = |s: &Sample| s.time.seconds_since(stepped).abs() > 1.5 * DAY_S;
    log.samples.retain(is_read);
    let said = stepped.plus_seconds(0.2 * HOUR_S);
    let analysis = with(&log, &[entry(LogbookKind::Lightning, said, None)]);
    assert_eq!(nearest(&analysis, stepped).from, said);
}

/// Returns the log with a step of (bx, by) at a time.
pub(crate) fn with_step(mut log: Log, at: Timestamp, [bx_nt, by_nt]: [f64; 2]) -> Log {
    for sample in log.samples.iter_mut().filter(|s| s.time >= at) {
        let earth = field(FieldModel::Igrf14, sample.position, 0.0, sample.time).unwrap();
        let (sin, cos) = sample.compass.degrees().to_radians().sin_cos();
        let off = ((bx_nt * sin + by_nt * cos) / earth.h_nt()).to_degrees();
        sample.compass = CompassHeading::new(sample.compass.degrees() - off).unwrap();
    }
    log
}
