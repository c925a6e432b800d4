//! Magnetic cargo: the base model returns with the discharge, and not before.

use crate::named::with_step;
use crate::voyages::Variety;
use crate::voyages::fleet::{Event, Happened, Log, Name, Plan, sail_log};
use crate::{HOUR_S, began, calm, entry, is_sound, of_the_ship, run};
use binnacle_analysis::analyse::analyse;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Analysis, Cause, Change, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

#[test]
fn after_discharge_the_base_model_is_resumed() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
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
        let analysis = analyse(&log.samples[..=sailed], &logbook, &settings);
        is_sound(&analysis);
        let epoch = analysis.current_epoch().unwrap();
        let is_base = epoch.resumes == Some(0) || epoch.begun_by_change.is_none();
        assert!(is_base, "seed {seed}: {:?}", analysis.changes);
        assert!(epoch.model.is_some());
    }
}

#[test]
fn a_discharge_written_down_for_an_hour_under_way_is_of_the_port_that_follows() {
    for seed in [40, 41, 44] {
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
        let analysis = analyse(&log.samples[..=under_way], &logbook, &settings);
        assert_eq!(analysis.current_epoch().unwrap().resumes, None);
        let sailed = log.samples.partition_point(|s| s.time <= arrived);
        let analysis = analyse(&log.samples[..=sailed + 100], &logbook, &settings);
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
fn cargo_that_stays_on_board_by_the_logbook_is_not_over_at_a_call() {
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
    let analysis = analyse(&log.samples[..=sailed], &[stays], &settings);
    is_sound(&analysis);
    assert_eq!(analysis.current_epoch().unwrap().resumes, None);
    // A day's samples without cargo outweigh any entry in the end.
    let stays = [LogbookEntry {
        to: Some(discharged.plus_seconds(20.0 * 86_400.0)),
        ..reported(cargo)
    }];
    let analysis = analyse(&log.samples, &stays, &settings);
    assert_eq!(analysis.current_epoch().unwrap().resumes, Some(0));
}

#[test]
fn cargo_that_is_noticed_days_after_a_disturbance_at_sea_came_on_board_at_the_call() {
    let varieties = [Variety::Rich, Variety::Medium, Variety::Poor];
    for seed in [530_154_u64, 530_158] {
        let plan = Plan {
            days: 75.0,
            ..Plan::new(Event::Cargo, varieties[(seed % 3) as usize])
        };
        let log = sail_log(seed, &plan);
        let loaded = began(&log, Name::Cargo);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let passed = |c: &&Change| c.confirmed && !c.cause.changes_deviation() && c.from > loaded;
        let passed = analysis.changes.iter().find(passed).unwrap();
        let found = of_the_ship(&analysis)[0];
        assert!(passed.from < found.detected_at, "seed {seed}");
        assert_eq!(found.cause, Cause::MagneticCargo, "seed {seed}: {found:?}");
        let sailed = log.samples.partition_point(|s| s.time <= loaded);
        let call = loaded..log.samples[sailed].time;
        assert!(call.contains(&found.from), "seed {seed}: {found:?}");
        let says = |words: &str| found.evidence.iter().any(|line| line.contains(words));
        assert!(says("may have begun at the port call before"), "{found:?}");
        assert!(!says("it began"), "{found:?}");
    }
}

#[test]
fn what_cargo_in_the_logbook_does_is_no_drift_and_may_be_over_with_it() {
    let plan = Plan {
        days: 130.0,
        ..Plan::new(Event::Cargo, Variety::Rich)
    };
    let log = sail_log(530_160, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let sailed = log.samples.partition_point(|s| Some(s.time) <= cargo.to);
    let day = sailed + 144;
    let alone = run(&log.samples[..day]);
    assert_eq!(of_the_ship(&alone)[0].cause, Cause::Drift);
    let settings = AnalysisSettings::default();
    let analysis = analyse(&log.samples[..day], &[reported(cargo)], &settings);
    is_sound(&analysis);
    let found = of_the_ship(&analysis);
    assert!(found.iter().all(|c| c.cause != Cause::Drift), "{found:?}");
    let may_have_ended = |c: &&Change| c.evidence.iter().any(|line| line.contains("have ended"));
    assert!(found.iter().any(may_have_ended), "{found:?}");
}

#[test]
fn what_may_have_changed_in_port_unnoticed_widens_the_band() {
    let varieties = [Variety::Rich, Variety::Medium, Variety::Poor];
    for seed in [410_015_u64, 410_044, 417_052] {
        let plan = Plan {
            days: 80.0,
            ..Plan::new(Event::Refit, varieties[(seed % 3) as usize])
        };
        let log = sail_log(seed, &plan);
        let port = began(&log, Name::Refit);
        let sailed = log.samples.partition_point(|s| s.time <= port);
        let left = log.samples[sailed].time;
        let day = |s: &Sample| s.time.seconds_since(left) < 24.0 * HOUR_S;
        let after_a_day = log.samples.partition_point(day);
        let variance = |until: usize| {
            let analysis = run(&log.samples[..until]);
            assert!(of_the_ship(&analysis).is_empty(), "seed {seed}");
            let model = analysis.current_epoch().unwrap().model.as_ref();
            let covariance = model.unwrap().covariance.unwrap();
            covariance[0][0] + covariance[2][2]
        };
        let (before, after) = (variance(sailed), variance(after_a_day));
        assert!(after > 1.5 * before, "seed {seed}: {after} of {before}");
    }
}

/// Returns a quiet voyage with cargo in the logbook between two port calls and a strike at
/// sea two days after the first, and the end of the second.
fn struck_laden(seed: u64) -> (Log, LogbookEntry, Timestamp, usize) {
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
fn what_struck_her_at_sea_does_not_leave_with_her_cargo() {
    for seed in [40, 41, 44] {
        let (log, cargo, struck, sailed) = struck_laden(seed);
        let strike = entry(LogbookKind::Lightning, struck, None);
        for logbook in [vec![cargo.clone()], vec![cargo, strike]] {
            let settings = AnalysisSettings::default();
            let analysis = analyse(&log.samples[..=sailed], &logbook, &settings);
            is_sound(&analysis);
            let found = of_the_ship(&analysis);
            assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
            assert_eq!(found[0].cause, Cause::LightningOrShock, "seed {seed}");
            let resumed = analysis.current_epoch().unwrap().resumes;
            assert_eq!(resumed, None, "seed {seed}");
        }
    }
}

#[test]
fn what_passes_in_the_first_hours_at_sea_is_no_cargo_for_an_entry_of_some() {
    let mut reports = Vec::new();
    for seed in 40..52 {
        let mut plan = calm(Event::Nothing);
        plan.days = 60.0;
        let log = sail_log(seed, &plan);
        let is_call = |k: &usize| {
            let gap_s = log.samples[*k].time.seconds_since(log.samples[*k - 1].time);
            gap_s > 12.0 * HOUR_S && log.samples[*k].time > log.start.plus_seconds(25.0 * 86_400.0)
        };
        let sailed = (1..log.samples.len()).find(is_call).unwrap();
        let sailed = log.samples[sailed].time;
        let cargo = entry(
            LogbookKind::MagneticCargo,
            sailed.plus_seconds(-6.0 * HOUR_S),
            None,
        );
        let begun = sailed.plus_seconds(2.0 * HOUR_S);
        let over = sailed.plus_seconds(5.0 * HOUR_S);
        let place = |time: Timestamp| log.samples.partition_point(|s| s.time < time);
        let (passed, until) = (place(over), place(over.plus_seconds(24.0 * HOUR_S)));
        let sound = log.samples[passed..until].to_vec();
        let mut samples = with_step(log, begun, [5000.0, -3500.0]).samples;
        samples.splice(passed.., sound);
        let analysis = analyse(&samples, &[cargo], &AnalysisSettings::default());
        is_sound(&analysis);
        let found = of_the_ship(&analysis);
        if !found.is_empty() {
            reports.push(seed);
        }
    }
    assert!(reports.len() <= 3, "{reports:?}");
}

#[test]
fn a_ship_struck_with_cargo_on_board_has_a_model_of_what_she_is_now() {
    let (log, cargo, struck, _) = struck_laden(40);
    let later = struck.plus_seconds(3.0 * 24.0 * HOUR_S);
    let until = log.samples.partition_point(|s| s.time < later);
    let open = LogbookEntry { to: None, ..cargo };
    let analysis = analyse(&log.samples[..until], &[open], &AnalysisSettings::default());
    let epoch = analysis.current_epoch().unwrap();
    assert_eq!(epoch.begun_by_change, Some(Cause::LightningOrShock));
    assert!(epoch.model.is_some(), "{:?}", epoch.refusal);
}

#[test]
fn a_change_at_a_discharge_in_the_logbook_is_not_cargo_that_lasts() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
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
    let analysis = analyse(&since, &[entry], &AnalysisSettings::default());
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::MagneticCargo);
    assert!(found[0].ended.is_some(), "{found:?}");
}

/// The cargo does not move the compass, and nobody recorded its discharge.
#[test]
fn cargo_that_nobody_closed_is_said_to_leave_samples_out_and_after_weeks_leaves_out_none() {
    let log = sail_log(11, &calm(Event::Nothing));
    let loaded = log.start.plus_seconds(15.0 * 86_400.0);
    let open = [entry(LogbookKind::MagneticCargo, loaded, None)];
    let sailed = |days: f64| {
        let until = loaded.plus_seconds(days * 86_400.0);
        let samples = log.samples.partition_point(|s| s.time < until);
        analyse(&log.samples[..samples], &open, &AnalysisSettings::default())
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
    let closed = analyse(&log.samples, &[], &AnalysisSettings::default());
    assert!(closed.notices.is_empty());
}

fn left_out(analysis: &Analysis) -> usize {
    let reasons = analysis.samples.iter().map(|s| s.reason);
    let cargo = reasons.filter(|reason| *reason == Some(SampleReason::MagneticCargo));
    cargo.count()
}

#[test]
fn a_strike_weeks_after_an_entry_that_nobody_closed_takes_no_model_away() {
    let log = sail_log(11, &calm(Event::Nothing));
    let loaded = log.start.plus_seconds(5.0 * 86_400.0);
    let struck = loaded.plus_seconds(36.0 * 86_400.0);
    let log = with_step(log, struck, [2000.0, -1500.0]);
    let open = [entry(LogbookKind::MagneticCargo, loaded, None)];
    let until = struck.plus_seconds(2.0 * 86_400.0);
    let samples = log.samples.partition_point(|s| s.time < until);
    let analysis = analyse(&log.samples[..samples], &open, &AnalysisSettings::default());
    is_sound(&analysis);
    assert_eq!(of_the_ship(&analysis).len(), 1, "{:?}", analysis.changes);
    assert_eq!(left_out(&analysis), 0, "{:?}", analysis.notices);
    assert_eq!(analysis.epochs.len(), 2);
    for epoch in &analysis.epochs {
        assert!(epoch.model.is_some(), "{:?}", epoch.refusal);
    }
}

#[test]
fn cargo_that_left_by_the_samples_leaves_out_none_for_ever_though_nobody_closed_its_entry() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let open = [LogbookEntry {
        to: None,
        ..reported(cargo)
    }];
    let discharged = cargo.to.unwrap();
    let sailed = |days: f64| {
        let until = discharged.plus_seconds(days * 86_400.0);
        let samples = log.samples.partition_point(|s| s.time < until);
        analyse(&log.samples[..samples], &open, &AnalysisSettings::default())
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
        analyse(
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
