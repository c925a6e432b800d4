//! Analyses of simulated ships by weighed hypotheses.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
#[path = "../../analysis/tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::azimuth::{Azimuth, AzimuthForm, AzimuthKind};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::result::{Analysis, Cause, Change};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::{Input, analyse};
use voyages::fleet::{Event, Log, Name, Plan, sail_log};
use voyages::{Variety, predicted, true_deviation};

fn run(samples: &[Sample]) -> Analysis {
    run_with(samples, &[])
}

fn run_with(samples: &[Sample], azimuths: &[Azimuth]) -> Analysis {
    analyse(&Input {
        samples,
        logbook: &[],
        azimuths,
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    })
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
fn a_steady_drift_is_one_change_and_named() {
    for seed in [4_000_000, 4_000_001] {
        let mut plan = Plan::new(Event::Ramp(2000.0, 20.0), Variety::Rich);
        plan.gyro_faults = 0.0;
        let log = sail_log(seed, &plan);
        let began = log.happened.iter().find(|h| h.what == Name::Ramp).unwrap();
        let analysis = run(&log.samples);
        let changes = ship_changes(&analysis);
        assert_eq!(changes.len(), 1, "{seed}: {:?}", analysis.changes);
        assert_eq!(changes[0].cause, Cause::Drift);
        let late_s = changes[0].from.seconds_since(began.from);
        assert!(late_s.abs() < 10.0 * 86_400.0, "{seed}: {late_s}");
    }
}

#[test]
fn the_band_of_a_ship_that_changes_at_each_call_is_wider_than_a_plain_ships() {
    let band_deg = |load_step_nt: f64| {
        let mut plan = Plan::new(Event::Nothing, Variety::Poor);
        plan.days = 120.0;
        plan.gyro_faults = 0.0;
        plan.habits.load_step_nt = load_step_nt;
        let log = sail_log(7, &plan);
        let analysis = run(&log.samples);
        let model = analysis.current_epoch().unwrap().model.as_ref().unwrap();
        let (h_nt, z_nt) = (log.truth.h_nt, log.truth.z_nt);
        let bands = (0..36).map(|k| predicted(model, 10.0 * f64::from(k), h_nt, z_nt).1);
        let squares: f64 = bands.map(|band| band * band).sum();
        (squares / 36.0, h_nt)
    };
    let ((plain, h_nt), (lively, _)) = (band_deg(0.0), band_deg(300.0));
    // A call's step of bx or by, 0.3 µT, as an angle: half of its square at the least.
    let step_deg = (300.0 / h_nt).to_degrees();
    assert!(
        lively - plain > 0.5 * step_deg * step_deg,
        "{plain} {lively}"
    );
}

#[test]
fn what_each_call_does_to_a_ship_is_a_habit_and_no_change() {
    let loads = |plan: &mut Plan| {
        plan.habits.load_step_nt = 300.0;
        plan.faults.satellite = false;
    };
    let retains = |plan: &mut Plan| plan.habits.retentive_share = 0.02;
    for (seed, variety, loads_at_calls) in [
        (1_000_001, Variety::Poor, true),
        (1_000_003, Variety::Rich, false),
        (1_000_006, Variety::Rich, false),
    ] {
        let mut plan = Plan::new(Event::Nothing, variety);
        plan.days = 100.0;
        plan.gyro_faults = 0.0;
        if loads_at_calls {
            loads(&mut plan);
        } else {
            retains(&mut plan);
        }
        let analysis = run(&sail_log(seed, &plan).samples);
        let changes = ship_changes(&analysis);
        assert!(changes.is_empty(), "{seed}: {changes:?}");
    }
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

/// Returns a transit taken at a sample's time by an observer who is off by `off_deg`.
fn transit(log: &Log, sample: &Sample, off_deg: f64) -> Azimuth {
    let here = field(FieldModel::Igrf14, sample.position, 0.0, sample.time).unwrap();
    let compass_deg = sample.compass.degrees();
    let error_deg = here.declination().degrees_east()
        + true_deviation(&log.truth, compass_deg, here.h_nt(), here.z_nt);
    Azimuth::new(AzimuthForm {
        time: sample.time,
        lat: sample.position.lat_deg(),
        lon: sample.position.lon_deg(),
        kind: AzimuthKind::Transit,
        compass_heading_deg: compass_deg,
        compass_bearing_deg: Some((50.0 - error_deg + off_deg).rem_euclid(360.0)),
        gyro_heading_deg: None,
        gyro_bearing_deg: None,
        horizon: None,
        height_of_eye_m: None,
        name: Some("two lights in line".to_owned()),
        true_bearing_deg: Some(50.0),
        altitude_deg: None,
        confirmed: true,
    })
    .unwrap()
}

/// Returns half the width of the band at the ship's place, root mean square over headings.
fn half_width_deg(analysis: &Analysis, log: &Log) -> f64 {
    let model = analysis.current_epoch().unwrap().model.as_ref().unwrap();
    let variances = (0..36).map(|k| {
        let (_, se) = predicted(model, 10.0 * f64::from(k), log.truth.h_nt, log.truth.z_nt);
        se * se
    });
    1.96 * (variances.sum::<f64>() / 36.0).sqrt()
}

#[test]
fn azimuths_halve_a_settled_band_and_it_still_holds() {
    let log = sail(6, Event::Nothing, 40.0);
    let every = log.samples.len() / 24;
    // Off by turns to either side, 0.7 degrees root mean square.
    let taken: Vec<Azimuth> = (0..20_usize)
        .map(|k| {
            let off = if k % 2 == 0 { 0.7 } else { -0.7 };
            transit(&log, &log.samples[(k + 4) * every - 1], off)
        })
        .collect();
    let (without, with) = (run(&log.samples), run_with(&log.samples, &taken));
    let (wide, narrow) = (half_width_deg(&without, &log), half_width_deg(&with, &log));
    assert!(narrow < 0.6 * wide, "{narrow} of {wide}");
    assert!(held(&with, &log) > 0.7, "{}", held(&with, &log));
}

#[test]
fn an_azimuth_far_from_any_sample_is_named_and_changes_nothing() {
    let log = sail(7, Event::Nothing, 10.0);
    let last = log.samples.last().unwrap();
    let late = Sample {
        time: last.time.plus_seconds(86_400.0),
        ..*last
    };
    let (without, with) = (
        run(&log.samples),
        run_with(&log.samples, &[transit(&log, &late, 5.0)]),
    );
    assert!(without.notices.is_empty());
    assert_eq!(with.notices.len(), 1, "{:?}", with.notices);
    assert_eq!(with.epochs, without.epochs);
}

#[test]
fn a_quay_does_not_check_the_compass_beside_its_steel() {
    let log = sail(7, Event::Nothing, 10.0);
    let sample = &log.samples[log.samples.len() / 2];
    let form = transit(&log, sample, 0.0).form().clone();
    let quay = Azimuth::new(AzimuthForm {
        kind: AzimuthKind::Quay,
        compass_bearing_deg: None,
        true_bearing_deg: Some((sample.gyro.unwrap().degrees() + 8.0).rem_euclid(360.0)),
        ..form
    })
    .unwrap();
    let (without, with) = (run(&log.samples), run_with(&log.samples, &[quay]));
    assert_eq!(with.epochs, without.epochs);
}
