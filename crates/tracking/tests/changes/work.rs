//! Work in the logbook, and events at about that time.

use crate::voyages::fleet::{Event, Log, Name, sail_log};
use crate::{HOUR_S, analyse_with, began, calm, entry, is_sound, of_the_ship, run};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Analysis, Cause};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

const DAY_S: f64 = 86_400.0;

fn with(log: &Log, logbook: &[LogbookEntry]) -> Analysis {
    analyse_with(&log.samples, logbook, &AnalysisSettings::default())
}

#[test]
fn a_strike_the_day_after_an_adjustment_is_detected_within_hours() {
    let mut asked = 0;
    for seed in [1, 3, 6] {
        let log = sail_log(seed, &calm(Event::Step(2500.0)));
        let struck = began(&log, Name::Step);
        let sailed = |s: &&Sample| s.time < struck;
        let rows = log.samples.iter().filter(sailed).count();
        let adjusted = log.samples[rows - 100].time;
        let analysis = with(&log, &[entry(LogbookKind::Adjustment, adjusted, None)]);
        is_sound(&analysis);
        let found = of_the_ship(&analysis);
        let strike = found.iter().find(|c| c.from > adjusted);
        let strike = strike.unwrap_or_else(|| panic!("seed {seed}: {found:?}"));
        assert_eq!(strike.cause, Cause::LightningOrShock, "seed {seed}");
        let delay_h = strike.detected_at.seconds_since(struck) / HOUR_S;
        assert!((0.0..12.0).contains(&delay_h), "seed {seed}: {delay_h} h");
        let asks = |line: &String| line.contains("correct the entry");
        let is_soon = strike.from.seconds_since(adjusted) < DAY_S;
        assert_eq!(strike.evidence.iter().any(asks), is_soon, "{strike:?}");
        asked += usize::from(is_soon);
    }
    assert!(asked > 0);
}

#[test]
fn work_that_was_planned_for_an_earlier_hour_begins_one_epoch_when_it_was_done() {
    let log = sail_log(1, &calm(Event::Refit));
    let worked = began(&log, Name::Refit);
    let planned = worked.plus_seconds(-20.0 * HOUR_S);
    let analysis = with(&log, &[entry(LogbookKind::Adjustment, planned, None)]);
    is_sound(&analysis);
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::AdjustmentOrRepair);
    let said = found[0]
        .evidence
        .iter()
        .any(|line| line.contains("later than"));
    assert!(said, "{found:?}");
    assert_eq!(analysis.epochs.len(), 2);
    let begun = analysis.epochs[1].from.unwrap();
    let sailed = log.samples.iter().find(|s| s.time > worked).unwrap().time;
    assert!(planned < begun && begun <= sailed, "{begun}");
    // Samples until then belong to the state before.
    let before = log.samples.iter().filter(|s| s.time < begun);
    let used = analysis.epochs[0].model.as_ref().unwrap().samples_used;
    assert!(used as f64 > 0.95 * before.count() as f64);
    let reported = &analysis.changes;
    assert!(
        reported
            .iter()
            .all(|c| c.confirmed || c.is_weak_transient())
    );
}

#[test]
fn an_adjusted_vessel_raises_no_alarm_while_its_model_is_learnt_anew() {
    for seed in 10..13 {
        let log = sail_log(seed, &calm(Event::Nothing));
        let at = log.samples[log.samples.len() / 2].time;
        let analysis = with(&log, &[entry(LogbookKind::Adjustment, at, None)]);
        let found = of_the_ship(&analysis);
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
        assert_eq!(found[0].from, at);
    }
}

#[test]
fn work_that_was_written_down_late_begins_one_epoch_when_it_was_done() {
    let log = sail_log(1, &calm(Event::Step(2500.0)));
    let worked = began(&log, Name::Step);
    let said = worked.plus_seconds(0.5 * DAY_S);
    let analysis = with(&log, &[entry(LogbookKind::Adjustment, said, None)]);
    is_sound(&analysis);
    assert_eq!(analysis.epochs.len(), 2, "{:?}", analysis.changes);
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::AdjustmentOrRepair);
    let begun = analysis.epochs[1].from.unwrap();
    assert!(begun.seconds_since(worked).abs() < HOUR_S, "{begun}");
    assert_eq!(analysis.epochs[1].begun_by, Some(LogbookKind::Adjustment));
}

#[test]
fn the_time_of_detection_stays_as_more_samples_come() {
    let mut plan = calm(Event::Step(4000.0));
    plan.event_day = 6.0;
    let log = sail_log(1, &plan);
    let struck = began(&log, Name::Step);
    let until = |days: f64| {
        let sailed = |s: &&Sample| s.time.seconds_since(struck) < days * DAY_S;
        let samples: Vec<Sample> = log.samples.iter().take_while(sailed).copied().collect();
        assert!(samples.last()?.time.seconds_since(log.start) < 10.0 * DAY_S);
        let analysis = run(&samples);
        Some(of_the_ship(&analysis).first()?.detected_at)
    };
    let found: Vec<Timestamp> = (1..7)
        .filter_map(|half| until(0.5 * f64::from(half)))
        .collect();
    assert!(found.len() > 2, "{found:?}");
    for later in &found[1..] {
        let moved_h = later.seconds_since(found[0]) / HOUR_S;
        assert!(moved_h.abs() < 3.0, "{found:?}");
    }
}
