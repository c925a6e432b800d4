//! Analyses of simulated ships by weighed hypotheses.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
#[path = "../../analysis/tests/voyages/mod.rs"]
mod voyages;

use binnacle_compass::result::{Analysis, Cause, Change};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::analyse;
use voyages::fleet::{Event, Log, Name, Plan, sail_log};
use voyages::{Variety, predicted, true_deviation};

fn run(samples: &[Sample]) -> Analysis {
    analyse(samples, &[], &AnalysisSettings::default())
}

fn sail(seed: u64, event: Event, days: f64) -> Log {
    let mut plan = Plan::new(event, Variety::Poor);
    plan.days = days;
    plan.event_day = 20.0;
    plan.anomalies = 0.0;
    plan.gyro_faults = 0.0;
    plan.faults.storms_per_month = 0.0;
    sail_log(seed, &plan)
}

fn ship_changes(analysis: &Analysis) -> Vec<&Change> {
    let changes = analysis.changes.iter();
    changes
        .filter(|change| change.confirmed && change.cause.changes_deviation())
        .collect()
}

/// Returns the share of 36 headings whose band holds the truth at the ship's place.
fn held(analysis: &Analysis, log: &Log) -> f64 {
    let model = analysis.current_epoch().unwrap().model.as_ref().unwrap();
    let (h, z) = (log.truth.h_nt, log.truth.z_nt);
    let held = (0..36).filter(|k| {
        let compass_deg = 10.0 * f64::from(*k);
        let (deviation, se) = predicted(model, compass_deg, h, z);
        let off = deviation - true_deviation(&log.truth, compass_deg, h, z);
        binnacle_compass::angle::wrap_180(off).abs() <= 1.96 * se
    });
    held.count() as f64 / 36.0
}

#[test]
fn a_sound_ship_has_a_band_that_holds_and_no_change() {
    let logs = (1..=4).map(|seed| sail(seed, Event::Nothing, 40.0));
    let shares: Vec<f64> = logs
        .map(|log| {
            let analysis = run(&log.samples);
            assert!(ship_changes(&analysis).is_empty(), "{:?}", analysis.changes);
            held(&analysis, &log)
        })
        .collect();
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    assert!(mean > 0.8, "{shares:?}");
}

#[test]
fn a_strike_is_found_within_a_day_and_begins_an_epoch() {
    let log = sail(2, Event::Step(3000.0), 30.0);
    let struck = log.happened.iter().find(|h| h.what == Name::Step).unwrap();
    let analysis = run(&log.samples);
    let changes = ship_changes(&analysis);
    assert_eq!(changes.len(), 1, "{:?}", analysis.changes);
    assert_eq!(changes[0].cause, Cause::LightningOrShock);
    let after_s = changes[0].detected_at.seconds_since(struck.from);
    assert!((0.0..86_400.0).contains(&after_s), "{after_s}");
    assert_eq!(analysis.epochs.len(), 2);
    assert!(analysis.epochs.iter().all(|epoch| epoch.model.is_some()));
}

#[test]
fn a_gyro_that_steps_is_named_and_the_ship_is_not() {
    let log = sail(3, Event::GyroFault(4.0), 30.0);
    let analysis = run(&log.samples);
    assert!(ship_changes(&analysis).is_empty(), "{:?}", analysis.changes);
    let named = analysis.changes.iter().filter(|change| change.confirmed);
    assert!(named.clone().any(|c| c.cause == Cause::ReferenceFault));
}

#[test]
fn a_compass_turned_round_has_the_same_deviation_but_for_half_a_circle() {
    let log = sail(4, Event::Nothing, 20.0);
    let turned: Vec<Sample> = log
        .samples
        .iter()
        .map(|sample| Sample {
            compass: binnacle_compass::angle::CompassHeading::new(sample.compass.degrees() + 180.0)
                .unwrap(),
            ..*sample
        })
        .collect();
    let (right, turned) = (run(&log.samples), run(&turned));
    assert!(ship_changes(&turned).is_empty(), "{:?}", turned.changes);
    let model = |analysis: &Analysis| analysis.epochs[0].model.clone().unwrap();
    let (h, z) = (log.truth.h_nt, log.truth.z_nt);
    for k in 0..36 {
        let compass_deg = 10.0 * f64::from(k);
        let (deviation, se) = predicted(&model(&right), compass_deg, h, z);
        let (round, _) = predicted(&model(&turned), (compass_deg + 180.0) % 360.0, h, z);
        let off = binnacle_compass::angle::wrap_180(round - deviation - 180.0);
        assert!(off.abs() < 2.0 * se, "{compass_deg}: {off} {se}");
    }
}

#[test]
fn order_and_repetition_change_nothing() {
    let log = sail(5, Event::Step(2000.0), 25.0);
    let mut shuffled = log.samples.clone();
    shuffled.reverse();
    shuffled.extend_from_slice(&log.samples[..500]);
    let (a, b) = (run(&log.samples), run(&shuffled));
    assert_eq!(a, b);
}
