//! Transients: gales, storms, anomalies and magnets.

use crate::voyages::fleet::{Event, Log, Name, sail_log};
use crate::voyages::gauss;
use crate::{HOUR_S, began, calm, certain, is_sound, of_the_ship, run};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::result::{Cause, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Adds five days of gale from day 20 on: the card swings twice as far, and most windows
/// are lost.
fn in_a_gale(log: &mut Log, seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let since_days = |time: Timestamp| time.seconds_since(log.start) / 86_400.0;
    let in_it = |s: &&mut Sample| (20.0..25.0).contains(&since_days(s.time));
    for sample in log.samples.iter_mut().filter(in_it) {
        let off = 0.12 * 2.2 * gauss(&mut rng);
        sample.compass = CompassHeading::new(sample.compass.degrees() + off).unwrap();
        sample.windows = 20;
        sample.spread_deg = Some(0.8);
    }
}

#[test]
fn a_gale_is_no_disturbance_of_the_field() {
    let mut taken_for_one_without_the_scatter = 0;
    for seed in 101..105 {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        in_a_gale(&mut log, seed);
        let analysis = run(&log.samples);
        assert_eq!(certain(&analysis), 0, "seed {seed}");
        for sample in &mut log.samples {
            (sample.windows, sample.spread_deg) = (60, Some(0.4));
        }
        taken_for_one_without_the_scatter += certain(&run(&log.samples));
    }
    assert!(taken_for_one_without_the_scatter > 0);
}

#[test]
fn a_storm_is_no_step_and_its_samples_are_left_out() {
    let mut plan = calm(Event::Nothing);
    plan.faults.storms_per_month = 6.0;
    let mut stormy = 0;
    for seed in 20..23 {
        let log = sail_log(seed, &plan);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        assert!(of_the_ship(&analysis).is_empty(), "{:?}", analysis.changes);
        let causes = analysis.changes.iter().map(|c| c.cause);
        stormy += causes
            .filter(|cause| *cause == Cause::MagneticStorm)
            .count();
        let left_out = analysis.samples.iter();
        let left_out = left_out.filter(|s| s.reason == Some(SampleReason::Disturbance));
        assert!(left_out.count() > 0, "seed {seed}");
    }
    assert!(stormy > 3, "{stormy}");
}

#[test]
fn what_is_gone_within_hours_at_sea_is_no_strike() {
    for (seed, event) in [
        (1, Event::Magnet(3000.0)),
        (2, Event::Magnet(3000.0)),
        (1, Event::VariationError(4.0)),
        (2, Event::VariationError(8.0)),
        (3, Event::VariationError(8.0)),
    ] {
        let log = sail_log(seed, &calm(event));
        let began = began(&log, Name::Brief);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        assert!(of_the_ship(&analysis).is_empty(), "{:?}", analysis.changes);
        let reported = analysis.changes.iter().find(|c| c.detected_at >= began);
        let reported = reported.unwrap_or_else(|| panic!("seed {seed}: {event:?} went unnoticed"));
        assert_eq!(
            reported.cause,
            Cause::LocalAnomaly,
            "seed {seed}: {reported:?}"
        );
        let lasted_h = reported.ended.unwrap().seconds_since(reported.from) / HOUR_S;
        assert!((0.5..5.0).contains(&lasted_h), "seed {seed}: {lasted_h} h");
        assert_eq!(analysis.epochs.len(), 1);
        let during = log
            .samples
            .iter()
            .zip(&analysis.samples)
            .filter(|(s, _)| s.time > reported.from && Some(s.time) <= reported.ended);
        let reasons = during.map(|(_, s)| s.reason).collect::<Vec<_>>();
        assert!(reasons.contains(&Some(SampleReason::Disturbance)));
    }
}

#[test]
fn a_step_that_was_reported_and_is_gone_again_says_so_and_stays_one_change() {
    let log = sail_log(2, &calm(Event::VariationError(8.0)));
    let analysis = run(&log.samples);
    let reported = &analysis.changes[0];
    assert!(
        reported.evidence[1].contains("at first taken for"),
        "{reported:?}"
    );
    // In between it had been.
    let before = log
        .samples
        .partition_point(|s| s.time <= reported.detected_at);
    let then = run(&log.samples[..before]);
    assert_eq!(of_the_ship(&then).len(), 1, "{:?}", then.changes);
}

/// Turns every compass reading between two times.
fn turned(log: &mut Log, from: Timestamp, to: Timestamp, degrees: f64) {
    let during = |s: &&mut Sample| (from..to).contains(&s.time);
    for sample in log.samples.iter_mut().filter(during) {
        sample.compass = CompassHeading::new(sample.compass.degrees() + degrees).unwrap();
    }
}

#[test]
fn a_compass_off_on_every_heading_for_hours_is_one_fault_that_passed() {
    for seed in [50, 51, 52, 54] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let from = log.samples[log.samples.len() / 2].time;
        turned(&mut log, from, from.plus_seconds(5.0 * HOUR_S), 12.0);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported: Vec<_> = analysis.changes.iter().filter(|c| c.confirmed).collect();
        let causes: Vec<Cause> = reported.iter().map(|c| c.cause).collect();
        assert_eq!(causes, [Cause::CompassFault], "seed {seed}: {reported:?}");
        let lasted_h = reported[0].ended.unwrap().seconds_since(reported[0].from) / HOUR_S;
        assert!((4.0..6.0).contains(&lasted_h), "seed {seed}: {lasted_h} h");
        assert_eq!(analysis.epochs.len(), 1, "seed {seed}");
    }
}

#[test]
fn a_zero_that_is_put_right_after_a_day_ends_its_change() {
    for seed in [50, 53, 54] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let from = log.samples[log.samples.len() / 2].time;
        let to = from.plus_seconds(30.0 * HOUR_S);
        turned(&mut log, from, to, 8.0);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported = of_the_ship(&analysis);
        assert_eq!(reported.len(), 1, "seed {seed}: {reported:?}");
        // On one course a strike does the same.
        let is_reported = matches!(
            reported[0].cause,
            Cause::Alignment | Cause::LightningOrShock
        );
        assert!(is_reported, "seed {seed}: {reported:?}");
        let late_h = reported[0].ended.unwrap().seconds_since(to) / HOUR_S;
        assert!(late_h.abs() < 1.0, "seed {seed}: {late_h} h");
        assert_eq!(analysis.epochs[2].resumes, Some(0), "seed {seed}");
    }
}
