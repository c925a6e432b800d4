//! Validation of recordings: predictions before use, and one part held against another.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
#[path = "../../analysis/tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::validation::{Part, Validation, validate};
use binnacle_tracking::{Input, analyse};
use voyages::Variety;
use voyages::fleet::{Event, Log, Plan, sail_log};

fn input(samples: &[Sample]) -> Input<'_> {
    static PRIOR: std::sync::LazyLock<ShipPrior> = std::sync::LazyLock::new(ShipPrior::population);
    Input {
        samples,
        logbook: &[],
        azimuths: &[],
        prior: &PRIOR,
        settings: AnalysisSettings::default(),
    }
}

fn sail(seed: u64, days: f64) -> Log {
    let mut plan = Plan::new(Event::Nothing, Variety::Medium);
    plan.days = days;
    plan.anomalies = 0.0;
    plan.gyro_faults = 0.0;
    plan.faults.storms_per_month = 0.0;
    sail_log(seed, &plan)
}

/// Returns the samples with the compass's zero moved from the middle one on.
fn moved_halfway(samples: &[Sample], by_deg: f64) -> Vec<Sample> {
    let moved = samples.iter().enumerate().map(|(k, sample)| Sample {
        compass: CompassHeading::new(
            sample.compass.degrees() + if k < samples.len() / 2 { 0.0 } else { by_deg },
        )
        .unwrap(),
        ..*sample
    });
    moved.collect()
}

fn part(validation: &Validation, predicted: Part) -> (u32, u32, f64) {
    let checks = validation.parts.iter();
    let check = checks.clone().find(|p| p.predicted == predicted).unwrap();
    let held_out = check.held_out.as_ref().unwrap();
    (
        held_out.courses_inside,
        held_out.expected_from,
        held_out.mean_deg,
    )
}

#[test]
fn watches_of_sound_ships_lie_in_their_band_and_widen_nothing() {
    let (mut watches, mut inside) = (0, 0);
    for seed in 1..=4 {
        let log = sail(seed, 40.0);
        let check = analyse(&input(&log.samples)).predictions.unwrap();
        assert_eq!(check.watches, 100, "{check:?}");
        assert!(check.widening < 1.1, "{check:?}");
        watches += check.watches;
        inside += check.watches_inside;
    }
    let expected = binnacle_compass::result::expected_inside(watches);
    assert!(inside >= *expected.start(), "{inside} of {watches}");
}

#[test]
fn both_halves_and_alternate_days_of_a_sound_ship_predict_each_other() {
    let log = sail(5, 20.0);
    let found = validate(&input(&log.samples));
    assert_eq!(found.parts.len(), 4);
    assert_eq!(found.settled.sample_s, None);
    for predicted in [
        Part::FirstHalf,
        Part::SecondHalf,
        Part::OddDays,
        Part::EvenDays,
    ] {
        let (inside, from, mean_deg) = part(&found, predicted);
        assert!(inside >= from, "{predicted:?}: {inside} of at least {from}");
        assert!(mean_deg.abs() < 0.7, "{predicted:?}: {mean_deg}");
    }
}

#[test]
fn a_compass_moved_halfway_is_reported_and_the_parts_are_of_one_side() {
    let log = sail(6, 40.0);
    let found = validate(&input(&moved_halfway(&log.samples, 4.0)));
    assert_eq!(found.changes.len(), 1, "{:?}", found.changes);
    assert!(
        found.stretch.samples < found.used * 2 / 3,
        "{:?}",
        found.stretch
    );
    for predicted in [Part::FirstHalf, Part::SecondHalf] {
        let (inside, from, mean_deg) = part(&found, predicted);
        assert!(inside >= from, "{predicted:?}: {inside} of at least {from}");
        assert!(mean_deg.abs() < 1.0, "{predicted:?}: {mean_deg}");
    }
}

#[test]
fn a_reference_that_errs_otherwise_each_day_falls_short_and_widens_the_band() {
    let log = sail(8, 20.0);
    let start = log.samples[0].time;
    let erring = log.samples.iter().map(|sample| {
        let day = (sample.time.seconds_since(start) / 86_400.0) as i64;
        let side = if day % 2 == 0 { 1.6 } else { -1.6 };
        let off_deg = side * (2.0 * sample.compass.degrees().to_radians()).sin();
        let moved = |heading: TrueHeading| TrueHeading::new(heading.degrees() + off_deg).unwrap();
        Sample {
            gyro: sample.gyro.map(moved),
            satellite: sample.satellite.map(moved),
            ..*sample
        }
    });
    let found = validate(&input(&erring.collect::<Vec<_>>()));
    assert!(found.predictions.falls_short(), "{:?}", found.predictions);
    let sound = validate(&input(&log.samples)).predictions;
    assert!(!sound.falls_short(), "{sound:?}");
    assert!(
        found.predictions.widening > sound.widening + 0.03,
        "{:?} beside {sound:?}",
        found.predictions
    );
}

#[test]
fn a_recording_of_an_hour_says_why_it_has_no_model() {
    let log = sail(7, 3.0);
    let found = validate(&input(&log.samples[..6]));
    assert!(found.refusal.is_some());
    assert_eq!(found.predictions.watches, 0);
    assert!(
        found
            .parts
            .iter()
            .all(|p| p.held_out.is_none() && p.refusal.is_some())
    );
}

#[test]
fn nothing_is_validated_without_a_panic() {
    let found = validate(&input(&[]));
    assert_eq!((found.used, found.settled.rows), (0, 0));
    assert!(found.refusal.is_some());
}
