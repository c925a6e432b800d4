//! Habits and incidents of the simulated ships: they are of the stated size, and change
//! nothing else.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code, unused_imports)]
#[path = "voyages/mod.rs"]
mod voyages;

use binnacle_compass::angle::wrap_180;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::sample::Sample;
use voyages::Variety;
use voyages::fleet::{Event, Log, Name, Plan, sail_log};
use voyages::habits::Habits;
use voyages::incidents::Incident;

const DAY_S: f64 = 86_400.0;

fn sail(habits: Habits, incident: Incident) -> Log {
    let plan = Plan {
        days: 40.0,
        event_day: 10.0,
        habits,
        incident,
        ..Plan::new(Event::Nothing, Variety::Poor)
    };
    sail_log(11, &plan)
}

fn plain() -> Log {
    sail(Habits::default(), Incident::Nothing)
}

/// Differences of a reading between two voyages on the same passage, degrees.
fn apart(one: &Log, other: &Log, read: fn(&Sample) -> f64) -> Vec<f64> {
    assert_eq!(one.samples.len(), other.samples.len());
    let pairs = one.samples.iter().zip(&other.samples);
    pairs
        .map(|(a, b)| {
            assert_eq!((a.time, a.position), (b.time, b.position));
            wrap_180(read(b) - read(a))
        })
        .collect()
}

fn compass(sample: &Sample) -> f64 {
    sample.compass.degrees()
}

fn gyro(sample: &Sample) -> f64 {
    sample.gyro.unwrap().degrees()
}

fn largest(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[test]
fn a_retentive_ship_keeps_at_most_her_share_of_the_induced_field() {
    let habits = Habits {
        retentive_share: 0.01,
        ..Habits::default()
    };
    let (plain, retentive) = (plain(), sail(habits, Incident::Nothing));
    let kept: Vec<f64> = plain
        .states
        .iter()
        .zip(&retentive.states)
        .map(|(a, b)| {
            let (p, q) = (a.truth.parameters, b.truth.parameters);
            (q.bx_nt - p.bx_nt).hypot(q.by_nt - p.by_nt) / a.truth.h_nt
        })
        .collect();
    assert!(largest(&kept) < 0.0101, "{kept:?}");
    assert!(kept.iter().any(|share| *share > 0.003), "{kept:?}");
    assert!(largest(&apart(&plain, &retentive, gyro)) < 1e-9);
}

/// Largest difference of bx between two voyages, and the number of its values.
fn loads(habits: Habits) -> (f64, usize) {
    let (plain, laden) = (plain(), sail(habits, Incident::Nothing));
    let steps = plain.states.iter().zip(&laden.states);
    let steps: Vec<f64> = steps
        .map(|(a, b)| b.truth.parameters.bx_nt - a.truth.parameters.bx_nt)
        .collect();
    let changes = steps
        .windows(2)
        .filter(|pair| (pair[0] - pair[1]).abs() > 1e-3);
    let changes = changes.count();
    (largest(&steps), changes)
}

#[test]
fn loads_add_up_unless_each_is_a_condition_of_its_own() {
    let (summed, port_calls) = loads(Habits {
        load_step_nt: 100.0,
        ..Habits::default()
    });
    let (alone, changes) = loads(Habits {
        load_condition_nt: 100.0,
        ..Habits::default()
    });
    assert_eq!(port_calls, changes);
    assert!((10..30).contains(&port_calls), "{port_calls}");
    assert!(alone < 300.0 && summed > 1.5 * alone, "{alone} {summed}");
}

#[test]
fn a_sticking_card_is_off_by_no_more_than_its_friction() {
    let habits = Habits {
        friction_deg_ut: 12.0,
        ..Habits::default()
    };
    let off = apart(&plain(), &sail(habits, Incident::Nothing), compass);
    // The field is 15 µT at least in these waters.
    assert!((0.2..0.8).contains(&largest(&off)), "{}", largest(&off));
}

#[test]
fn instruments_in_whole_degrees_show_no_others() {
    let habits = Habits {
        reference_digit_deg: 1.0,
        ..Habits::default()
    };
    let off = apart(&plain(), &sail(habits, Incident::Nothing), gyro);
    // Ten roundings on a ship that yaws.
    let squares: f64 = off.iter().map(|x| x * x).sum();
    let rms = (squares / off.len() as f64).sqrt();
    assert!((0.05..0.15).contains(&rms), "{rms}");
    let habits = Habits {
        sample_digit_deg: 0.5,
        ..Habits::default()
    };
    let log = sail(habits, Incident::Nothing);
    assert!(log.samples.iter().all(|s| (2.0 * gyro(s)).fract() == 0.0));
    assert!(
        log.samples
            .iter()
            .all(|s| (2.0 * compass(s)).fract() == 0.0)
    );
}

#[test]
fn a_jammed_card_shows_one_heading() {
    let log = sail(Habits::default(), Incident::Jam);
    let jam = log.happened.iter().find(|h| h.what == Name::Jam).unwrap();
    let (from, to) = (jam.from, jam.to.unwrap());
    let during = log
        .samples
        .iter()
        .filter(|s| s.time.seconds_since(from) > 1200.0 && s.time < to.plus_seconds(-1200.0));
    let shown: Vec<f64> = during.map(compass).collect();
    assert!(shown.len() > 20);
    // But for wild readings.
    let same = shown
        .iter()
        .filter(|x| (*x - shown[0]).abs() < 1e-9)
        .count();
    assert!(same * 10 > shown.len() * 9);
}

#[test]
fn a_gyro_settles_and_a_slow_fault_creeps() {
    let settling = apart(&plain(), &sail(Habits::default(), Incident::Settling), gyro);
    assert!(
        (1.0..4.0).contains(&largest(&settling)),
        "{}",
        largest(&settling)
    );
    assert!(settling.last().unwrap().abs() < 1e-6);
    let creeping = sail(Habits::default(), Incident::GyroRamp(1.0));
    let creeping = apart(&plain(), &creeping, gyro);
    assert!(
        (2.0..6.0).contains(&largest(&creeping)),
        "{}",
        largest(&creeping)
    );
}

#[test]
fn a_dry_dock_is_in_the_logbook_and_fades() {
    let (plain, docked) = (plain(), sail(Habits::default(), Incident::DryDock(3000.0)));
    assert_eq!(docked.logbook[0].kind, LogbookKind::DryDocking);
    let since = |day: f64| {
        let at = docked.logbook[0].from.plus_seconds(day * DAY_S);
        let k = plain.states.partition_point(|s| s.time < at);
        let (p, q) = (
            plain.states[k].truth.parameters,
            docked.states[k].truth.parameters,
        );
        (q.bx_nt - p.bx_nt).hypot(q.by_nt - p.by_nt)
    };
    assert!((since(0.5) - 2950.0).abs() < 60.0, "{}", since(0.5));
    assert!(since(10.0) < 2250.0 && since(10.0) > 1900.0);
}

#[test]
fn three_strikes_fall_in_a_day_and_one_in_a_silence() {
    let log = sail(Habits::default(), Incident::Strikes(2000.0));
    let strikes = log.happened.iter().filter(|h| h.what == Name::Lightning);
    assert_eq!(strikes.count(), 3);
    let log = sail(Habits::default(), Incident::StrikeInStorm(3000.0));
    let strike = log
        .happened
        .iter()
        .find(|h| h.what == Name::Lightning)
        .unwrap();
    let near = |s: &&Sample| s.time.seconds_since(strike.from).abs() < 2.5 * 3600.0;
    assert_eq!(log.samples.iter().filter(near).count(), 0);
}

#[test]
fn roll_and_course_over_ground_are_there_only_where_they_are_measured() {
    assert!(
        plain()
            .samples
            .iter()
            .all(|s| s.roll_deg.is_none() && s.cog.is_none())
    );
    let log = sail(
        Habits {
            list_deg: 3.0,
            heeling_nt: 5000.0,
            has_roll_sensor: true,
            has_course_over_ground: true,
            ..Habits::default()
        },
        Incident::Nothing,
    );
    let rolls: Vec<f64> = log.samples.iter().map(|s| s.roll_deg.unwrap()).collect();
    assert!(
        (3.0..12.0).contains(&largest(&rolls)),
        "{}",
        largest(&rolls)
    );
    let drift = |s: &Sample| wrap_180(s.cog.unwrap().degrees() - gyro(s));
    let drifts: Vec<f64> = log.samples.iter().map(drift).collect();
    let squares: f64 = drifts.iter().map(|d| d * d).sum();
    let rms = (squares / drifts.len() as f64).sqrt();
    assert!((1.5..4.0).contains(&rms), "{rms}");
}
