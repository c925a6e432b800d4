//! Magnetic cargo: the base model returns with the discharge, and not before.

use crate::causes::with_step;
use crate::voyages::fleet::{Event, Happened, Log, Name, sail_log};
use crate::{HOUR_S, analyse_with, calm, entry, is_sound, of_the_ship, run};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Analysis, Cause, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

#[test]
fn after_discharge_the_base_model_is_resumed() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(43, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let analysis = run(&log.samples);
    is_sound(&analysis);
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::MagneticCargo);
    let ended = found[0].ended.unwrap();
    let off_days = ended.seconds_since(cargo.to.unwrap()).abs() / 86_400.0;
    assert!(off_days < 1.5, "{off_days} days");
    assert_eq!(analysis.epochs.len(), 3);
    assert_eq!(analysis.epochs[2].resumes, Some(0));
    let used = |i: usize| analysis.epochs[i].model.as_ref().unwrap().samples_used;
    assert!(used(2) > used(0), "the base's samples count again");
}

/// Returns the officer's report of the cargo, written hours later.
fn reported(cargo: &Happened) -> LogbookEntry {
    let late = |time: Timestamp| time.plus_seconds(5.0 * HOUR_S);
    entry(
        LogbookKind::MagneticCargo,
        late(cargo.from),
        cargo.to.map(late),
    )
}

#[test]
fn a_discharge_that_was_reported_has_the_base_model_back_with_the_first_sample() {
    for seed in [40, 41, 44] {
        let mut plan = calm(Event::Cargo);
        plan.days = 90.0;
        let log = sail_log(seed, &plan);
        let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
        let discharged = cargo.to.unwrap();
        let sailed = log.samples.partition_point(|s| s.time <= discharged);
        let logbook = [reported(cargo)];
        let settings = AnalysisSettings::default();
        let analysis = analyse_with(&log.samples[..=sailed], &logbook, &settings);
        is_sound(&analysis);
        let epoch = analysis.current_epoch().unwrap();
        let is_base = epoch.resumes == Some(0) || epoch.begun_by_change.is_none();
        assert!(is_base, "seed {seed}: {:?}", analysis.changes);
        assert!(epoch.model.is_some(), "seed {seed}: {:?}", epoch.refusal);
    }
}

#[test]
fn a_discharge_written_down_for_an_hour_under_way_is_of_the_port_that_follows() {
    for seed in [43, 48, 50] {
        let mut plan = calm(Event::Cargo);
        plan.days = 90.0;
        let log = sail_log(seed, &plan);
        let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
        let arrived = cargo.to.unwrap();
        let early = arrived.plus_seconds(-4.0 * HOUR_S);
        let logbook = [LogbookEntry {
            to: Some(early),
            ..reported(cargo)
        }];
        let settings = AnalysisSettings::default();
        let under_way = log.samples.partition_point(|s| s.time <= early);
        assert!(log.samples[under_way].time < arrived, "seed {seed}");
        let analysis = analyse_with(&log.samples[..=under_way], &logbook, &settings);
        assert_eq!(analysis.current_epoch().unwrap().resumes, None);
        let sailed = log.samples.partition_point(|s| s.time <= arrived);
        let analysis = analyse_with(&log.samples[..=sailed + 100], &logbook, &settings);
        is_sound(&analysis);
        let epoch = analysis.current_epoch().unwrap();
        assert_eq!(
            epoch.resumes,
            Some(0),
            "seed {seed}: {:?}",
            analysis.changes
        );
        assert_eq!(of_the_ship(&analysis).len(), 1, "seed {seed}");
    }
}

#[test]
fn cargo_on_board_by_the_logbook_is_not_over_at_a_port_call() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let discharged = cargo.to.unwrap();
    let sailed = log.samples.partition_point(|s| s.time <= discharged);
    let stays = LogbookEntry {
        to: Some(discharged.plus_seconds(20.0 * 86_400.0)),
        ..reported(cargo)
    };
    let settings = AnalysisSettings::default();
    let analysis = analyse_with(&log.samples[..=sailed], &[stays], &settings);
    is_sound(&analysis);
    assert_eq!(analysis.current_epoch().unwrap().resumes, None);
    // A day's samples without cargo outweigh any entry in the end.
    let stays = [LogbookEntry {
        to: Some(discharged.plus_seconds(20.0 * 86_400.0)),
        ..reported(cargo)
    }];
    let analysis = analyse_with(&log.samples, &stays, &settings);
    assert_eq!(analysis.current_epoch().unwrap().resumes, Some(0));
}

/// Returns a quiet voyage with cargo in the logbook between two port calls and a strike at
/// sea two days after the first, and the end of the second.
fn strike_while_laden(seed: u64) -> (Log, LogbookEntry, Timestamp, usize) {
    let mut plan = calm(Event::Nothing);
    plan.days = 90.0;
    let log = sail_log(seed, &plan);
    let begun = log.samples[0].time;
    let calls: Vec<usize> = (1..log.samples.len())
        .filter(|&k| {
            let [before, after] = [&log.samples[k - 1], &log.samples[k]];
            after.time.seconds_since(before.time) > 12.0 * HOUR_S
                && before.time.seconds_since(begun) > 40.0 * 24.0 * HOUR_S
        })
        .collect();
    let (loaded, discharged) = (calls[0], calls[1]);
    let in_port = |call: usize| log.samples[call].time.plus_seconds(-6.0 * HOUR_S);
    let cargo = entry(
        LogbookKind::MagneticCargo,
        in_port(loaded),
        Some(in_port(discharged)),
    );
    let struck = log.samples[loaded].time.plus_seconds(40.0 * HOUR_S);
    let log = with_step(log, struck, [2000.0, -1500.0]);
    (log, cargo, struck, discharged)
}

#[test]
fn a_strike_at_sea_does_not_end_with_the_discharge_of_cargo() {
    for seed in [43, 48, 50] {
        let (log, cargo, struck, sailed) = strike_while_laden(seed);
        let strike = entry(LogbookKind::Lightning, struck, None);
        for logbook in [vec![cargo.clone()], vec![cargo, strike]] {
            let settings = AnalysisSettings::default();
            let analysis = analyse_with(&log.samples[..=sailed], &logbook, &settings);
            is_sound(&analysis);
            let found = of_the_ship(&analysis);
            assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
            assert_eq!(
                found[0].cause,
                Cause::LightningOrShock,
                "seed {seed}: {found:?}"
            );
            let resumed = analysis.current_epoch().unwrap().resumes;
            assert_eq!(resumed, None, "seed {seed}");
        }
    }
}

#[test]
fn a_vessel_that_lightning_hits_with_cargo_on_board_has_a_model_of_its_present_state() {
    let (log, cargo, struck, _) = strike_while_laden(40);
    let later = struck.plus_seconds(3.0 * 24.0 * HOUR_S);
    let until = log.samples.partition_point(|s| s.time < later);
    let open = LogbookEntry { to: None, ..cargo };
    let analysis = analyse_with(&log.samples[..until], &[open], &AnalysisSettings::default());
    let epoch = analysis.current_epoch().unwrap();
    assert_eq!(
        epoch.begun_by_change,
        Some(Cause::LightningOrShock),
        "{:?}",
        analysis.changes
    );
    assert!(epoch.model.is_some(), "{:?}", epoch.refusal);
}

#[test]
fn a_change_at_a_discharge_in_the_logbook_is_not_cargo_that_lasts() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(48, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    // The log begins with cargo on board.
    let since: Vec<Sample> = log
        .samples
        .iter()
        .filter(|s| s.time > cargo.from)
        .copied()
        .collect();
    let loaded = since[0].time.plus_seconds(-20.0 * 24.0 * HOUR_S);
    let entry = LogbookEntry {
        from: loaded,
        ..reported(cargo)
    };
    let analysis = analyse_with(&since, &[entry], &AnalysisSettings::default());
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::MagneticCargo);
    assert!(found[0].ended.is_some(), "{found:?}");
}

/// The cargo does not move the compass, and nobody recorded its discharge.
#[test]
fn an_open_cargo_entry_leaves_samples_out_with_a_notice_and_none_after_weeks() {
    let log = sail_log(11, &calm(Event::Nothing));
    let loaded = log.start.plus_seconds(15.0 * 86_400.0);
    let open = [entry(LogbookKind::MagneticCargo, loaded, None)];
    let sailed = |days: f64| {
        let until = loaded.plus_seconds(days * 86_400.0);
        let samples = log.samples.partition_point(|s| s.time < until);
        analyse_with(&log.samples[..samples], &open, &AnalysisSettings::default())
    };
    let soon = sailed(10.0);
    assert!(left_out(&soon) > 300);
    assert_eq!(soon.notices.len(), 1, "{:?}", soon.notices);
    let count = format!("{} samples are left out", left_out(&soon));
    assert!(soon.notices[0].contains(&count), "{:?}", soon.notices);
    assert!(soon.notices[0].contains("record the end of the entry"));
    let late = sailed(29.0);
    is_sound(&late);
    assert_eq!(left_out(&late), 0);
    assert_eq!(late.epochs.len(), 1);
    assert!(late.notices[0].contains("used for the model"));
    let used = |analysis: &Analysis| analysis.epochs[0].model.as_ref().unwrap().samples_used;
    assert!(used(&late) as f64 > 0.9 * late.samples.len() as f64);
    let closed = analyse_with(&log.samples, &[], &AnalysisSettings::default());
    assert!(closed.notices.is_empty());
}

fn left_out(analysis: &Analysis) -> usize {
    let reasons = analysis.samples.iter().map(|s| s.reason);
    let cargo = reasons.filter(|reason| *reason == Some(SampleReason::MagneticCargo));
    cargo.count()
}

#[test]
fn a_strike_weeks_after_an_open_cargo_entry_takes_no_model_away() {
    let log = sail_log(11, &calm(Event::Nothing));
    let loaded = log.start.plus_seconds(5.0 * 86_400.0);
    let struck = loaded.plus_seconds(36.0 * 86_400.0);
    let log = with_step(log, struck, [2000.0, -1500.0]);
    let open = [entry(LogbookKind::MagneticCargo, loaded, None)];
    let until = struck.plus_seconds(2.0 * 86_400.0);
    let samples = log.samples.partition_point(|s| s.time < until);
    let analysis = analyse_with(&log.samples[..samples], &open, &AnalysisSettings::default());
    is_sound(&analysis);
    assert_eq!(of_the_ship(&analysis).len(), 1, "{:?}", analysis.changes);
    assert_eq!(left_out(&analysis), 0, "{:?}", analysis.notices);
    assert_eq!(analysis.epochs.len(), 2);
    for epoch in &analysis.epochs {
        assert!(epoch.model.is_some(), "{:?}", epoch.refusal);
    }
}

#[test]
fn samples_count_again_weeks_after_cargo_left_though_its_entry_is_open() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(48, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let open = [LogbookEntry {
        to: None,
        ..reported(cargo)
    }];
    let discharged = cargo.to.unwrap();
    let sailed = |days: f64| {
        let until = discharged.plus_seconds(days * 86_400.0);
        let samples = log.samples.partition_point(|s| s.time < until);
        analyse_with(&log.samples[..samples], &open, &AnalysisSettings::default())
    };
    let since = |analysis: &Analysis| {
        let later = log.samples.partition_point(|s| s.time < discharged);
        let kept = analysis.samples[later..].iter();
        kept.filter(|s| s.reason != Some(SampleReason::MagneticCargo))
            .count() as f64
            / (analysis.samples.len() - later) as f64
    };
    let (soon, late) = (sailed(10.0), sailed(26.0));
    is_sound(&late);
    assert!(since(&soon) < 0.1, "{}", since(&soon));
    assert!(since(&late) > 0.9, "{}", since(&late));
    let reports = &late.notices[0];
    assert!(
        reports.contains("those of the vessel without it"),
        "{reports}"
    );
}

/// A mistaken year must not leave out a year's samples without a notice.
#[test]
fn an_end_after_the_last_sample_is_none_yet() {
    let log = sail_log(11, &calm(Event::Nothing));
    let day = |days: f64| log.start.plus_seconds(days * 86_400.0);
    let run = |kind, until: f64| {
        let samples = log.samples.partition_point(|s| s.time < day(until));
        let logbook = [entry(kind, day(15.0), Some(day(395.0)))];
        analyse_with(
            &log.samples[..samples],
            &logbook,
            &AnalysisSettings::default(),
        )
    };
    let left_out = |analysis: &Analysis| {
        let reports = analysis.samples.iter().filter_map(|s| s.reason);
        let of_the_logbook = [SampleReason::MagneticCargo, SampleReason::Berth];
        reports
            .filter(|reason| of_the_logbook.contains(reason))
            .count()
    };
    let soon = run(LogbookKind::MagneticCargo, 25.0);
    assert!(left_out(&soon) > 300);
    let reports = &soon.notices;
    assert!(reports[0].contains("samples are left out"), "{reports:?}");
    assert!(
        reports[0].contains("only after the last sample"),
        "{reports:?}"
    );
    let late = run(LogbookKind::MagneticCargo, 44.0);
    assert_eq!(left_out(&late), 0, "{:?}", late.notices);
    // A vessel under way has left its berth, whatever the logbook says.
    assert_eq!(left_out(&run(LogbookKind::Berth, 44.0)), 0);
}
