//! Transients: gales, storms, anomalies and magnets.

use crate::voyages::fleet::{Event, Log, sail_log};
use crate::voyages::gauss;
use crate::{calm, certain, is_sound, of_the_ship, run};
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
