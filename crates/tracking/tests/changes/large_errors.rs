//! Compass errors larger than those of storms and anomalies.

use crate::voyages::fleet::{Event, Log, sail_log};
use crate::{calm, certain, run};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::result::{Analysis, Change};
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
