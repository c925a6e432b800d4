//! Compass errors larger than those of storms and anomalies.

use crate::voyages::fleet::{Event, Log, sail_log};
use crate::{calm, certain, run};
use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::result::{Analysis, Cause, Change};
use binnacle_compass::time::Timestamp;

const AN_HOUR: usize = 6;

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
fn single_wild_readings_are_no_disturbance() {
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
    for seed in [61, 63] {
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
fn a_compass_that_swings_for_hours_is_one_fault() {
    for (seed, size_deg) in [(61, 20.0), (62, 30.0), (64, 40.0)] {
        let (log, from) = with_error(seed, 12 * AN_HOUR, to_and_fro(size_deg));
        let analysis = run(&log.samples);
        let reported = reported(&analysis);
        assert_eq!(reported.len(), 1, "seed {seed}: {:?}", analysis.changes);
        assert_eq!(reported[0].cause, Cause::CompassFault, "seed {seed}");
        let late_s = reported[0].from.seconds_since(from);
        assert!(late_s.abs() < 3600.0, "seed {seed}: {late_s}");
        assert!(reported[0].ended.is_some(), "seed {seed}");
    }
}

#[test]
fn what_is_gone_within_hours_at_sea_is_no_strike() {
    for seed in [61, 62, 64] {
        // Steel beside the compass, on whatever heading she is.
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let first = log.samples.len() / 2;
        for sample in &mut log.samples[first..first + 2 * AN_HOUR] {
            let compass_deg = sample.compass.degrees();
            let off_deg = 4.0 + 2.0 * compass_deg.to_radians().cos();
            sample.compass = CompassHeading::new(compass_deg + off_deg).unwrap();
        }
        let analysis = run(&log.samples);
        let struck = |c: &Change| c.cause == Cause::LightningOrShock && c.ended.is_none();
        assert!(
            !analysis.changes.iter().any(|c| c.confirmed && struck(c)),
            "seed {seed}: {:?}",
            analysis.changes
        );
    }
}

#[test]
fn no_compass_is_reported_as_off_by_more_than_half_a_turn() {
    for (seed, off_deg) in [(61, 181.0), (62, -179.0), (67, 175.0)] {
        let (log, from) = with_error(seed, 96 * AN_HOUR, |_| off_deg);
        let end = log.samples.partition_point(|s| s.time < from) + 96 * AN_HOUR;
        let analysis = run(&log.samples[..end]);
        let reported = reported(&analysis);
        let sizes: Vec<f64> = reported
            .iter()
            .filter_map(|c| c.deviation_change_deg)
            .collect();
        assert_eq!(sizes.len(), 1, "seed {seed}: {reported:?}");
        assert!(sizes[0] <= 180.0, "seed {seed}: {sizes:?}");
        let turned_deg = wrap_180(off_deg).abs();
        assert!(
            (sizes[0] - turned_deg).abs() < 1.0,
            "seed {seed}: {sizes:?}"
        );
    }
}
