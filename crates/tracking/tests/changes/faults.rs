//! Instrument faults: none of them is the vessel's magnetism.

use crate::voyages::fleet::{Event, Log, sail_log};
use crate::voyages::{predicted, true_deviation};
use crate::{HOUR_S, calm, is_sound, of_the_ship, run};
use binnacle_compass::angle::{CompassHeading, TrueHeading, wrap_180};
use binnacle_compass::result::{Analysis, Cause, Change, SampleReason};
use binnacle_compass::sample::Sample;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn day(log: &Log, sample: &Sample) -> f64 {
    sample.time.seconds_since(log.start) / 86_400.0
}

fn certain(analysis: &Analysis) -> Vec<&Change> {
    analysis.changes.iter().filter(|c| c.confirmed).collect()
}

fn turned(heading: TrueHeading, degrees: f64) -> TrueHeading {
    TrueHeading::new(heading.degrees() + degrees).unwrap()
}

/// On a steady course the gyro gets an error of 9°, and the satellite compass drops out
/// soon after: by the remaining reference the vessel turned.
#[test]
fn a_gyros_fault_while_the_satellite_compass_is_silent_makes_no_stuck_compass() {
    for seed in [61, 62, 64] {
        let log = sail_log(seed, &calm(Event::Nothing));
        let is_steady = |course: &[Sample]| {
            let first = course[0].compass.degrees();
            let off = |s: &Sample| wrap_180(s.compass.degrees() - first).abs();
            day(&log, &course[0]) > 25.0 && course.iter().all(|s| off(s) < 0.8)
        };
        let steady = log.samples.windows(10).position(is_steady).unwrap();
        let mut samples = log.samples.clone();
        for (place, sample) in samples.iter_mut().enumerate().skip(steady + 4) {
            sample.gyro = sample.gyro.map(|gyro| turned(gyro, 9.0));
            if place < steady + 9 {
                sample.satellite = None;
            }
        }
        samples.truncate(steady + 150);
        let analysis = run(&samples);
        let found = certain(&analysis);
        assert!(
            found.iter().all(|c| c.cause != Cause::CompassFault),
            "seed {seed}: {found:?}"
        );
    }
}

#[test]
fn a_moved_zero_of_the_compass_is_no_strike() {
    for (seed, moved_deg) in [(60, 3.0), (61, -4.0), (62, 3.0)] {
        let (log, moved) = zero_moved(seed, moved_deg);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported = of_the_ship(&analysis);
        assert_eq!(reported.len(), 1, "seed {seed}: {reported:?}");
        assert_eq!(reported[0].cause, Cause::Alignment);
        assert!(reported[0].evidence[0].contains("the compass's own alignment"));
        assert!(reported[0].step.is_none());
        let off_h = reported[0].from.seconds_since(log.samples[moved].time) / HOUR_S;
        assert!(off_h.abs() < 36.0, "seed {seed}: {off_h} h");
        let size_deg = reported[0].deviation_change_deg.unwrap();
        assert!((size_deg - moved_deg.abs()).abs() < 0.7, "{size_deg}");
        let constant = |i: usize| analysis.epochs[i].model.as_ref().unwrap().constant_deg;
        let learnt = constant(1) - constant(0);
        assert!((learnt + moved_deg).abs() < 0.7, "seed {seed}: {learnt}");
    }
}

/// Returns a calm voyage whose compass has an error on every heading from day 25 on.
fn zero_moved(seed: u64, moved_deg: f64) -> (Log, usize) {
    let mut log = sail_log(seed, &calm(Event::Nothing));
    let is_past = |s: &Sample| day(&log, s) > 25.0;
    let moved = log.samples.iter().position(is_past).unwrap();
    for sample in &mut log.samples[moved..] {
        let compass = sample.compass.degrees() + moved_deg;
        sample.compass = CompassHeading::new(compass).unwrap();
    }
    (log, moved)
}

#[test]
fn by_one_reference_the_band_holds_a_zero_that_moved_twice() {
    for seed in 60..64 {
        let mut plan = calm(Event::Nothing);
        plan.faults.satellite = false;
        let mut log = sail_log(seed, &plan);
        let moves = [(22.0, 5.0), (30.0, 6.0)];
        let days: Vec<f64> = log.samples.iter().map(|s| day(&log, s)).collect();
        for (sample, day) in log.samples.iter_mut().zip(days) {
            let moved = moves.iter().filter(|(from, _)| day > *from);
            let off_deg: f64 = moved.map(|(_, deg)| deg).sum();
            sample.compass = CompassHeading::new(sample.compass.degrees() + off_deg).unwrap();
        }
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let place = analysis.last_place.unwrap();
        let Some(model) = &analysis.current_epoch().unwrap().model else {
            continue;
        };
        let held = |shown_deg: f64, moved_deg: f64| {
            let (h, z) = (place.h_nt, place.z_nt);
            let sound_deg = true_deviation(&log.truth, shown_deg - moved_deg, h, z);
            let (predicted_deg, se_deg) = predicted(model, shown_deg, h, z);
            wrap_180(sound_deg - moved_deg - predicted_deg).abs() <= 1.96 * se_deg
        };
        let headings = (0..36).map(|k| 10.0 * f64::from(k));
        let count = headings.filter(|deg| held(*deg, 11.0)).count();
        assert!(count > 30, "seed {seed}: {count}, {:?}", certain(&analysis));
    }
}

#[test]
fn a_card_that_jams_for_hours_is_no_strike() {
    let mut reported_as_stuck = 0;
    for seed in 60..72 {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let is_past = |s: &Sample| day(&log, s) > 25.0;
        let first = log.samples.iter().position(is_past).unwrap();
        let jammed = log.samples[first].compass.degrees();
        for sample in &mut log.samples[first..first + 36] {
            let off = 0.3 * (2.0 * rng.random::<f64>() - 1.0);
            sample.compass = CompassHeading::new(jammed + off).unwrap();
        }
        let analysis = run(&log.samples);
        let reported = of_the_ship(&analysis);
        assert!(reported.is_empty(), "seed {seed}: {reported:?}");
        let mut causes = certain(&analysis).into_iter().map(|c| c.cause);
        reported_as_stuck += usize::from(causes.any(|cause| cause == Cause::CompassFault));
    }
    // Some have not turned meanwhile.
    assert!(reported_as_stuck >= 5, "{reported_as_stuck}");
}

#[test]
fn wild_readings_hours_apart_are_no_fault_of_the_gyro() {
    let mut log = sail_log(10, &calm(Event::Nothing));
    let middle = log.samples.len() / 2;
    for row in [middle, middle + 5, middle + 10] {
        let sample = &mut log.samples[row];
        sample.gyro = sample.gyro.map(|gyro| turned(gyro, 12.0));
    }
    let analysis = run(&log.samples);
    assert!(certain(&analysis).is_empty(), "{:?}", analysis.changes);
}

#[test]
fn a_fault_of_the_satellite_compass_is_named_whichever_way_it_errs() {
    for (seed, off_deg) in [(31, 3.0), (32, -3.0), (33, 1.5), (35, -2.0)] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let start = log.start;
        let is_off =
            |s: &&mut Sample| (25.0..30.0).contains(&(s.time.seconds_since(start) / 86_400.0));
        for sample in log.samples.iter_mut().filter(is_off) {
            sample.satellite = sample.satellite.map(|heading| turned(heading, off_deg));
        }
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported = certain(&analysis);
        assert!(
            reported.iter().all(|c| c.cause == Cause::ReferenceFault),
            "seed {seed}: {reported:?}"
        );
        let names_it = |line: &String| line.contains("the satellite compass had failed");
        let mut evidence = reported.iter().flat_map(|c| &c.evidence);
        assert!(evidence.any(names_it), "seed {seed}: {reported:?}");
        assert_eq!(analysis.epochs.len(), 1, "seed {seed}");
    }
}

#[test]
fn a_jammed_card_that_trembles_much_is_reported_once() {
    for seed in [61, 62, 64] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let is_in = |s: &Sample| (25.0..39.0).contains(&day(&log, s));
        let first = log.samples.iter().position(is_in).unwrap();
        let last = log.samples.iter().rposition(is_in).unwrap();
        let jammed = log.samples[first].compass.degrees();
        for sample in &mut log.samples[first..last] {
            let off = (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
            sample.compass = CompassHeading::new(jammed + 0.5 * off).unwrap();
        }
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported: Vec<Cause> = certain(&analysis).iter().map(|c| c.cause).collect();
        let jams = reported.iter().filter(|c| **c == Cause::CompassFault);
        assert_eq!(jams.count(), 1, "seed {seed}: {reported:?}");
        // The first hours may look like a transient.
        assert!(reported.len() <= 2, "seed {seed}: {reported:?}");
        assert!(
            of_the_ship(&analysis).is_empty(),
            "seed {seed}: {reported:?}"
        );
    }
}

#[test]
fn a_gyro_that_turns_further_and_further_is_one_fault() {
    for seed in [61, 62, 64] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let first = log.samples.len() / 2;
        for (i, sample) in log.samples[first..first + 60].iter_mut().enumerate() {
            sample.gyro = sample.gyro.map(|gyro| turned(gyro, i as f64));
        }
        let analysis = run(&log.samples[..first + 60]);
        let found = certain(&analysis);
        let causes: Vec<Cause> = found.iter().map(|c| c.cause).collect();
        assert_eq!(causes, [Cause::ReferenceFault], "seed {seed}: {found:?}");
        assert!(of_the_ship(&analysis).is_empty(), "seed {seed}");
    }
}

#[test]
fn a_vessel_on_one_course_has_a_notice_that_a_change_would_not_be_noticed() {
    let log = sail_log(65, &calm(Event::Nothing));
    let course = log.samples[0].compass.degrees();
    let samples = log.samples.iter().copied();
    let one: Vec<Sample> = samples
        .filter(|s| wrap_180(s.compass.degrees() - course).abs() < 10.0)
        .collect();
    let said = |samples: &[Sample]| {
        let notices = run(samples).notices;
        notices.iter().any(|n| n.contains("would not be noticed"))
    };
    assert!(said(&one), "{} samples", one.len());
    assert!(!said(&log.samples));
}

#[test]
fn wild_readings_of_a_gyro_make_no_stuck_compass() {
    let mut plan = calm(Event::Nothing);
    plan.faults.satellite = false;
    let mut log = sail_log(63, &plan);
    for sample in log.samples.iter_mut().step_by(29) {
        sample.gyro = sample.gyro.map(|gyro| turned(gyro, 12.0));
    }
    let analysis = run(&log.samples);
    let mut causes = analysis.changes.iter().map(|c| c.cause);
    assert!(
        causes.all(|cause| cause != Cause::CompassFault),
        "{:?}",
        analysis.changes
    );
}

#[test]
fn a_jammed_card_that_trembles_is_a_stuck_compass() {
    for (seed, trembles_deg) in [(61, 0.1), (62, 0.3), (64, 0.3)] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let first = log
            .samples
            .iter()
            .position(|s| day(&log, s) > 25.0)
            .unwrap();
        let last = log
            .samples
            .iter()
            .position(|s| day(&log, s) > 30.0)
            .unwrap();
        let jammed = log.samples[first].compass.degrees();
        for sample in &mut log.samples[first..last] {
            let off = trembles_deg * (2.0 * rng.random::<f64>() - 1.0);
            sample.compass = CompassHeading::new(jammed + off).unwrap();
        }
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported: Vec<Cause> = certain(&analysis).iter().map(|c| c.cause).collect();
        assert_eq!(reported, [Cause::CompassFault], "seed {seed}");
        let fault = certain(&analysis)[0];
        let jammed_at = log.samples[first].time;
        let late_h = fault.from.seconds_since(jammed_at) / HOUR_S;
        assert!((-1.0..36.0).contains(&late_h), "seed {seed}: {late_h} h");
        let is_failed = |s: &binnacle_compass::result::SampleDiagnostic| {
            s.reason == Some(SampleReason::CompassStuck)
        };
        let stuck = analysis.samples.iter().filter(|s| is_failed(s)).count();
        assert!(stuck > (last - first) / 2, "seed {seed}: {stuck}");
        let before = analysis.samples[..first].iter().filter(|s| is_failed(s));
        assert!(before.count() < 3, "seed {seed}");
    }
}
