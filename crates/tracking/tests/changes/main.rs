//! Changes of a vessel's magnetism: detected, dated, named, and no false alarms.

#![allow(clippy::unwrap_used)] // all of this is tests

mod berths;
mod cargo;
mod causes;
mod disturbances;
mod drifts;
mod faults;
mod large_errors;
mod strikes;
#[allow(dead_code, unused_imports)]
#[path = "../../../analysis/tests/voyages/mod.rs"]
mod voyages;
mod work;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Analysis, Cause, Change, SampleDiagnostic, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use voyages::fleet::{Event, Log, Name, Plan, sail_log};
use voyages::{Faults, Variety};

const HOUR_S: f64 = 3600.0;

/// Returns a plan of nothing but one event.
fn calm(event: Event) -> Plan {
    let usual = Plan::new(event, Variety::Medium);
    Plan {
        days: 45.0,
        event_day: 25.0,
        anomalies: 0.0,
        gyro_faults: 0.0,
        faults: Faults {
            storms_per_month: 0.0,
            ..usual.faults
        },
        ..usual
    }
}

fn analyse_with(
    samples: &[Sample],
    logbook: &[LogbookEntry],
    settings: &AnalysisSettings,
) -> Analysis {
    binnacle_tracking::analyse(&binnacle_tracking::Input {
        samples,
        logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: *settings,
    })
}

fn run(samples: &[Sample]) -> Analysis {
    analyse_with(samples, &[], &AnalysisSettings::default())
}

fn of_the_ship(analysis: &Analysis) -> Vec<&Change> {
    let changes = analysis.changes.iter();
    changes
        .filter(|c| c.confirmed && c.cause.changes_deviation())
        .collect()
}

fn began(log: &Log, what: Name) -> Timestamp {
    log.happened.iter().find(|h| h.what == what).unwrap().from
}

fn entry(kind: LogbookKind, from: Timestamp, to: Option<Timestamp>) -> LogbookEntry {
    LogbookEntry {
        from,
        to,
        kind,
        cargo: None,
        note: String::new(),
    }
}

/// Asserts probabilities between 0 and 1 with the sum 1, and dates in order.
fn is_sound(analysis: &Analysis) {
    for c in &analysis.changes {
        let sum: f64 = c.causes.iter().map(|cause| cause.probability).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{c:?}");
        assert_eq!(c.cause, c.causes[0].cause);
        assert!(
            c.from_earliest <= c.from && c.from <= c.from_latest,
            "{c:?}"
        );
        assert!(!c.evidence.is_empty());
        let sizes = c
            .step
            .map_or([0.0; 4], |s| [s.bx_nt, s.by_nt, s.bx_se_nt, s.by_se_nt]);
        assert!(sizes.iter().all(|x| x.is_finite()), "{c:?}");
    }
    for pair in analysis.epochs.windows(2) {
        assert_eq!(pair[0].to, pair[1].from);
        assert!(pair[0].from.is_none_or(|from| Some(from) < pair[1].from));
    }
}

#[test]
fn a_step_of_two_microtesla_is_detected_within_hours_and_dated() {
    for seed in 1..4 {
        let log = sail_log(seed, &calm(Event::Step(2000.0)));
        let stepped = began(&log, Name::Step);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let found = of_the_ship(&analysis);
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
        let delay_h = found[0].detected_at.seconds_since(stepped) / HOUR_S;
        assert!((0.0..24.0).contains(&delay_h), "seed {seed}: {delay_h} h");
        let off_h = found[0].from.seconds_since(stepped).abs() / HOUR_S;
        assert!(off_h < 1.0, "seed {seed}: off by {off_h} h");
        assert_eq!(found[0].cause, Cause::LightningOrShock);
        let step = found[0].step.unwrap();
        let size = step.bx_nt.hypot(step.by_nt);
        assert!((1200.0..2800.0).contains(&size), "seed {seed}: {size} nT");
        assert_eq!(analysis.epochs.len(), 2);
        assert_eq!(analysis.epochs[1].from, Some(found[0].from));
        assert!(analysis.epochs[1].model.is_some());
    }
}

#[test]
fn on_a_quiet_voyage_nothing_changes() {
    for seed in 10..13 {
        let analysis = run(&sail_log(seed, &calm(Event::Nothing)).samples);
        assert!(analysis.changes.iter().all(Change::is_weak_transient));
        assert_eq!(analysis.epochs.len(), 1);
    }
}

/// Ships on which a change of the vessel led for a few rows, without any event.
#[test]
fn a_change_that_later_samples_do_not_confirm_is_withdrawn() {
    let mut withdrawn = 0;
    for (seed, until_day) in [(107_004, 22.0), (107_100, 40.0)] {
        let plan = Plan {
            days: 40.0,
            ..Plan::new(Event::Nothing, Variety::Poor)
        };
        let log = sail_log(seed, &plan);
        let sailed = |s: &Sample| s.time.seconds_since(log.start) < until_day * 24.0 * HOUR_S;
        let analysis = run(&log.samples[..log.samples.partition_point(sailed)]);
        is_sound(&analysis);
        assert!(of_the_ship(&analysis).is_empty(), "{:?}", analysis.changes);
        assert_eq!(analysis.epochs.len(), 1, "seed {seed}");
        let was_the_ships = |c: &&Change| c.withdrawn && c.cause.changes_deviation();
        for change in analysis.changes.iter().filter(was_the_ships) {
            assert!(!change.confirmed && change.ended > Some(change.detected_at));
            assert!(change.evidence.iter().any(|e| e.contains("is withdrawn")));
            assert_eq!((change.step, change.deviation_change_deg), (None, None));
            // In between it was certain.
            let is_before = |s: &Sample| s.time <= change.detected_at;
            let then = run(&log.samples[..log.samples.partition_point(is_before)]);
            assert_eq!(of_the_ship(&then).len(), 1, "{:?}", then.changes);
            assert_eq!(then.epochs.len(), 2, "seed {seed}");
            withdrawn += 1;
        }
    }
    assert!(withdrawn > 0);
}

fn certain(analysis: &Analysis) -> usize {
    analysis.changes.iter().filter(|c| c.confirmed).count()
}

#[test]
fn evidence_is_in_words_that_an_officer_knows() {
    for (seed, event) in [
        (1, Event::Step(2000.0)),
        (31, Event::GyroFault(4.0)),
        (2, Event::VariationError(4.0)),
    ] {
        let analysis = run(&sail_log(seed, &calm(event)).samples);
        let evidence = analysis.changes.iter().flat_map(|c| &c.evidence);
        let reported = evidence.cloned().collect::<Vec<_>>().join("; ");
        for jargon in ["nat", "log likelihood", "NaN", "inf"] {
            let words = || reported.split(|c: char| !c.is_alphabetic());
            assert!(
                !words().any(|word| word == jargon || word == format!("{jargon}s")),
                "{reported}"
            );
        }
        assert!(!reported.is_empty());
    }
    let analysis = run(&sail_log(1, &calm(Event::Step(2000.0))).samples);
    let evidence = &analysis.changes[0].evidence;
    assert!(
        evidence[0].contains("times likelier than a passing"),
        "{evidence:?}"
    );
}

#[test]
fn the_order_of_arrival_changes_nothing() {
    let log = sail_log(1, &calm(Event::Step(2000.0)));
    let expected = serde_json::to_string(&run(&log.samples)).unwrap();
    let mut shuffled: Vec<Sample> = log.samples.iter().rev().copied().collect();
    shuffled.rotate_left(1234);
    shuffled.extend_from_slice(&log.samples[50..90]);
    assert_eq!(serde_json::to_string(&run(&shuffled)).unwrap(), expected);
}

/// Turns every compass reading from a time on.
fn turned(samples: &mut [Sample], from: Timestamp, degrees: f64) {
    for sample in samples.iter_mut().filter(|s| s.time >= from) {
        sample.compass = CompassHeading::new(sample.compass.degrees() + degrees).unwrap();
    }
}

#[test]
fn three_changes_in_a_day_end_the_search_and_are_reported() {
    let mut samples = sail_log(50, &calm(Event::Nothing)).samples;
    let day = samples[samples.len() / 2].time;
    for (hour, degrees) in [(0.0, 6.0), (8.0, -12.0), (16.0, 9.0)] {
        turned(&mut samples, day.plus_seconds(hour * HOUR_S), degrees);
    }
    let analysis = run(&samples);
    is_sound(&analysis);
    assert!(!analysis.changes.is_empty());
    assert!(analysis.changes.len() < 12, "{:?}", analysis.changes);
}

#[test]
fn a_change_inside_a_gap_is_dated_within_it() {
    let log = sail_log(2, &calm(Event::Step(3000.0)));
    let stepped = began(&log, Name::Step);
    let gap_s = 1.5 * 86_400.0;
    let outside = |s: &&Sample| s.time.seconds_since(stepped).abs() > gap_s;
    let samples: Vec<Sample> = log.samples.iter().filter(outside).copied().collect();
    let analysis = run(&samples);
    is_sound(&analysis);
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].from_earliest <= stepped && stepped <= found[0].from_latest);
}

/// A drift happens on the way, too.
#[test]
fn a_change_inside_a_gap_of_days_is_no_drift_of_weeks() {
    for seed in 1..13 {
        let log = sail_log(seed, &calm(Event::Step(2500.0)));
        let stepped = began(&log, Name::Step);
        let outside = |s: &&Sample| {
            !(-3.0 * 86_400.0..3.0 * 86_400.0).contains(&s.time.seconds_since(stepped))
        };
        let until = stepped.plus_seconds(5.0 * 86_400.0);
        let before = log.samples.iter().take_while(|s| s.time < until);
        let samples: Vec<Sample> = before.filter(outside).copied().collect();
        let analysis = run(&samples);
        is_sound(&analysis);
        let found = of_the_ship(&analysis);
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
        let late_s = found[0].from.seconds_since(stepped);
        let is_there = late_s.abs() < 3.25 * 86_400.0;
        assert!(
            found[0].cause != Cause::Drift && is_there,
            "seed {seed}: {found:?}"
        );
    }
}

#[test]
fn entries_that_overlap_or_precede_the_first_sample_are_taken_as_they_come() {
    let log = sail_log(3, &calm(Event::Step(2000.0)));
    let stepped = began(&log, Name::Step);
    let day = |days: f64| stepped.plus_seconds(86_400.0 * days);
    let logbook = [
        entry(LogbookKind::Lightning, day(0.1), None),
        entry(LogbookKind::Lightning, day(-100.0), None),
        entry(LogbookKind::MagneticCargo, day(-200.0), Some(day(-190.0))),
        entry(LogbookKind::MagneticCargo, day(-10.0), Some(day(-8.0))),
        entry(LogbookKind::MagneticCargo, day(-9.0), Some(day(-7.0))),
        entry(LogbookKind::Note, day(0.0), None),
    ];
    let analysis = analyse_with(&log.samples, &logbook, &AnalysisSettings::default());
    is_sound(&analysis);
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::LightningOrShock);
    assert!(found[0].causes[0].probability > 0.9);
    assert!(found[0].evidence.iter().any(|e| e.contains("logbook")));
}

#[test]
fn a_gyro_alone_that_is_off_for_days_costs_those_days_and_is_not_taken_for_the_ship() {
    for (seed, size_deg) in [(901, 5.0), (902, 15.0), (903, 15.0)] {
        let mut plan = Plan {
            days: 60.0,
            event_day: 25.0,
            ..calm(Event::GyroFault(size_deg))
        };
        plan.faults.satellite = false;
        let log = sail_log(seed, &plan);
        let fault = log.happened.iter().find(|h| h.what == Name::GyroFault);
        let fault = fault.unwrap();
        let (from, to) = (fault.from, fault.to.unwrap());
        let analysis = run(&log.samples);
        is_sound(&analysis);
        assert!(
            of_the_ship(&analysis).is_empty(),
            "{seed} {size_deg}: {:?}",
            analysis.changes
        );
        let reported = analysis
            .changes
            .iter()
            .find(|c| c.cause == Cause::ReferenceFault);
        let reported = reported.unwrap();
        assert!(
            reported.from.seconds_since(from).abs() < HOUR_S,
            "{seed} {size_deg}: {reported:?}"
        );
        let left_out = |s: &&SampleDiagnostic| s.reason == Some(SampleReason::ReferenceFailed);
        let (during, otherwise): (Vec<_>, Vec<_>) = analysis
            .samples
            .iter()
            .partition(|s| s.sample.time >= from && s.sample.time <= to);
        // A sample at either end may be of both states.
        let kept = during.iter().filter(|s| !left_out(s)).count();
        assert!(kept <= 2, "{seed} {size_deg}: {kept}");
        assert!(
            otherwise.iter().filter(|s| left_out(s)).count() < 12,
            "{seed} {size_deg}"
        );
    }
}

/// Returns the samples with a delay at each of some rows.
fn delayed(samples: &[Sample], rows: impl Fn(usize) -> bool, seconds: f64) -> Vec<Sample> {
    let mut late = 0.0;
    let delayed = samples.iter().enumerate().map(|(row, sample)| {
        if rows(row) {
            late += seconds;
        }
        Sample {
            time: sample.time.plus_seconds(late),
            ..*sample
        }
    });
    delayed.collect()
}

#[test]
fn years_without_sailing_are_one_gap() {
    let log = sail_log(4, &calm(Event::Nothing));
    let middle = log.samples.len() / 2;
    let years = 3.0 * 365.25 * 86_400.0;
    let samples = delayed(&log.samples, |row| row == middle, years);
    let analysis = run(&samples);
    is_sound(&analysis);
    assert!(analysis.changes.len() < 4, "{:?}", analysis.changes);
    assert!(analysis.epochs.iter().all(|epoch| epoch.model.is_some()));
}

#[test]
fn a_thousand_port_calls_are_a_bounded_work() {
    let mut plan = calm(Event::Cargo);
    plan.days = 60.0;
    let log = sail_log(40, &plan);
    let samples = delayed(&log.samples, |row| row % 5 == 4, 4.0 * HOUR_S);
    let analysis = run(&samples);
    is_sound(&analysis);
    assert!(analysis.changes.len() < 60, "{}", analysis.changes.len());
}

#[test]
fn a_possible_discharge_is_named_and_widens_the_band() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let discharged = cargo.to.unwrap();
    let first = log.samples.iter().position(|s| s.time > discharged);
    let first = first.unwrap();
    let analysis = run(&log.samples[..first + 3]);
    is_sound(&analysis);
    let laden = run(&log.samples[..first]);
    let open = analysis.changes.iter().flat_map(|c| &c.evidence);
    assert!(
        open.clone().any(|e| e.contains("may have ended")),
        "{open:?}"
    );
    let variance = |analysis: &Analysis| {
        let model = analysis.current_epoch().unwrap().model.as_ref();
        let covariance = model.unwrap().covariance.unwrap();
        covariance[0][0] + covariance[2][2]
    };
    assert!(variance(&analysis) > variance(&laden));
}
