//! Compass errors larger than those of storms and anomalies.

use crate::voyages::fleet::{Event, Log, sail_log};
use crate::{calm, certain, is_sound, of_the_ship, run};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::result::{Analysis, Cause, Change, SampleReason};
use binnacle_compass::time::Timestamp;

const AN_HOUR: usize = 6;
const HOUR_S: f64 = 3600.0;

/// Returns a calm voyage whose compass has an error from the middle on, for some readings.
fn with_error(seed: u64, readings: usize, off_deg: impl Fn(usize) -> f64) -> (Log, Timestamp) {
    let mut log = sail_log(seed, &calm(Event::Nothing));
    let first = log.samples.len() / 2;
    for (i, sample) in log.samples[first..first + readings].iter_mut().enumerate() {
        let compass_deg = sample.compass.degrees() + off_deg(i);
        sample.compass = CompassHeading::new(compass_deg).unwrap();
    }
    let from = log.samples[first].time;
    (log, from)
}

fn to_and_fro(size_deg: f64) -> impl Fn(usize) -> f64 {
    move |i| size_deg * (0.7 * i as f64).sin()
}

fn reported(analysis: &Analysis) -> Vec<&Change> {
    let reported = analysis.changes.iter();
    reported.filter(|c| c.confirmed).collect()
}

#[test]
fn a_swing_of_any_size_is_one_disturbance_with_a_name_while_it_lasts_and_after() {
    for (size_deg, hours) in [
        (6.0, 3),
        (6.0, 6),
        (10.0, 6),
        (20.0, 2),
        (20.0, 6),
        (40.0, 6),
    ] {
        for seed in [61, 62, 63] {
            let (log, from) = with_error(seed, hours * AN_HOUR, to_and_fro(size_deg));
            let end = log.samples.partition_point(|s| s.time < from) + hours * AN_HOUR;
            for samples in [&log.samples[..end], &log.samples[..]] {
                let analysis = run(samples);
                is_sound(&analysis);
                let reported = reported(&analysis);
                let what = format!("{size_deg} degrees, {hours} h, seed {seed}: {reported:?}");
                assert_eq!(reported.len(), 1, "{what}");
                assert!(
                    reported[0].from.seconds_since(from).abs() < HOUR_S,
                    "{what}"
                );
                assert!(of_the_ship(&analysis).is_empty(), "{what}");
                assert_eq!(analysis.epochs.len(), 1, "{what}");
                let is_fault = reported[0].cause == Cause::CompassFault;
                assert!(is_fault || reported[0].cause.is_transient(), "{what}");
                if size_deg >= 20.0 {
                    assert!(is_fault, "{what}");
                }
                if size_deg <= 6.0 {
                    assert!(!is_fault, "{what}");
                }
                let first = samples.partition_point(|s| s.time < from);
                let during = &analysis.samples[first + 3..end - 3];
                let left_out = during
                    .iter()
                    .filter(|s| matches!(s.reason, Some(SampleReason::Disturbance)) && !s.used);
                assert!(left_out.count() * 10 > during.len() * 9, "{what}");
            }
        }
    }
}

#[test]
fn a_compass_that_swings_for_days_is_one_fault() {
    for seed in [61, 62] {
        let (log, from) = with_error(seed, 72 * AN_HOUR, to_and_fro(40.0));
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported = reported(&analysis);
        let faults = reported.iter().filter(|c| c.cause == Cause::CompassFault);
        assert_eq!(faults.count(), 1, "seed {seed}: {reported:?}");
        assert!(
            reported[0].from.seconds_since(from).abs() < HOUR_S,
            "{reported:?}"
        );
        assert!(of_the_ship(&analysis).is_empty(), "{reported:?}");
    }
}

#[test]
fn a_large_step_is_the_ships_however_large() {
    for (seed, off_deg) in [(61, 15.0), (62, -30.0), (63, 50.0)] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let first = log.samples.len() / 2;
        for sample in &mut log.samples[first..] {
            // A magnet athwart: as the cosine of the heading.
            let compass_deg = sample.compass.degrees();
            let off_deg = off_deg * compass_deg.to_radians().cos();
            sample.compass = CompassHeading::new(compass_deg + off_deg).unwrap();
        }
        let analysis = run(&log.samples);
        is_sound(&analysis);
        assert!(certain(&analysis) > 0, "seed {seed}");
        assert!(
            !of_the_ship(&analysis).is_empty(),
            "seed {seed}: {:?}",
            analysis.changes
        );
    }
}

#[test]
fn wild_readings_that_come_singly_are_no_disturbance() {
    let mut log = sail_log(64, &calm(Event::Nothing));
    for sample in log.samples.iter_mut().skip(500).step_by(29) {
        let compass_deg = sample.compass.degrees() + 25.0;
        sample.compass = CompassHeading::new(compass_deg).unwrap();
    }
    assert_eq!(certain(&run(&log.samples)), 0);
}

#[test]
fn a_swing_in_high_latitudes_where_the_field_is_weak_is_no_strike() {
    // Where H is 16 µT, 6° are what 4° are in the middle latitudes.
    for seed in [61, 62, 63] {
        let (log, from) = with_error(seed, 6 * AN_HOUR, to_and_fro(4.0));
        let end = log.samples.partition_point(|s| s.time < from) + 6 * AN_HOUR;
        let analysis = run(&log.samples[..end]);
        let reported = reported(&analysis);
        assert_eq!(reported.len(), 1, "seed {seed}: {:?}", analysis.changes);
        assert!(
            reported[0].cause.is_transient(),
            "seed {seed}: {reported:?}"
        );
    }
}

#[test]
fn no_compass_is_reported_as_off_by_more_than_half_a_turn() {
    let mut reversed = 0;
    for seed in [61, 62, 63, 65, 67] {
        let (log, _) = with_error(
            seed,
            6 * AN_HOUR,
            |i| if i % 4 == 0 { 120.0 } else { 178.0 },
        );
        let analysis = run(&log.samples);
        for line in analysis.changes.iter().flat_map(|c| &c.evidence) {
            let Some(after) = line.strip_prefix("the error was ") else {
                continue;
            };
            let degrees: f64 = after.split(' ').next().unwrap().parse().unwrap();
            assert!(degrees <= 180.0, "seed {seed}: {line}");
            assert!(
                line.ends_with("the compass no longer pointed north"),
                "{line}"
            );
            reversed += 1;
        }
    }
    assert!(reversed > 1, "{reversed}");
}
