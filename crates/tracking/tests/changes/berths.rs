//! Samples taken alongside, near steel on the quay.

use crate::voyages::fleet::{Event, Log, Name, sail_log};
use crate::voyages::{Truth, gauss, true_deviation};
use crate::{HOUR_S, began, calm, is_sound, run};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::result::{Analysis, Cause, Change, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Returns the first port call after day 25: the places of the samples before and after it.
fn call(log: &Log) -> (usize, usize) {
    let is_past = |k: &usize| log.samples[*k].time.seconds_since(log.start) > 25.0 * 86_400.0;
    let gap_s = |k: usize| log.samples[k].time.seconds_since(log.samples[k - 1].time);
    let mut rows = (1..log.samples.len()).filter(is_past);
    let sailed = rows.find(|k| gap_s(*k) > 10.0 * HOUR_S).unwrap();
    (sailed - 1, sailed)
}

/// Adds samples all through that call with an error of the compass, by the vessel's state
/// at each time.
fn lie_alongside(log: &mut Log, steel_deg: f64, ship: impl Fn(Timestamp) -> Truth) {
    const HEADING: f64 = 70.0;
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (arrived, sailed) = call(log);
    let (first, last) = (log.samples[arrived], log.samples[sailed]);
    let field = FieldAt::from_time(FieldModel::Igrf14, first.time).unwrap();
    let here = field.at(first.position, 0.0).unwrap();
    let minutes = last.time.seconds_since(first.time) / 60.0;
    let lying = (3..(minutes / 10.0) as i32 - 3).map(|k| {
        let time = first.time.plus_seconds(600.0 * f64::from(k));
        let deviation = true_deviation(&ship(time), HEADING, here.h_nt(), here.z_nt);
        let heading = HEADING + deviation + here.declination().degrees_east();
        let off = steel_deg + 0.1 * gauss(&mut rng);
        Sample {
            time,
            compass: CompassHeading::new(HEADING + off).unwrap(),
            gyro: TrueHeading::new(heading + 0.1 * gauss(&mut rng)),
            satellite: TrueHeading::new(heading + 0.1 * gauss(&mut rng)),
            sog_kn: Some(0.1),
            ..first
        }
    });
    let lying: Vec<Sample> = lying.collect();
    log.samples.splice(sailed..sailed, lying);
}

fn confirmed(analysis: &Analysis) -> Vec<&Change> {
    analysis.changes.iter().filter(|c| c.confirmed).collect()
}

fn taken_alongside(analysis: &Analysis) -> usize {
    let of_berth = analysis.samples.iter();
    of_berth
        .filter(|s| s.reason == Some(SampleReason::Berth))
        .count()
}

#[test]
fn an_error_that_begins_and_ends_with_a_berth_is_its_steel() {
    for (seed, steel_deg) in [(70, 4.0), (71, -4.0), (72, 6.0)] {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let truth = log.truth;
        lie_alongside(&mut log, steel_deg, |_| truth);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported = confirmed(&analysis);
        let causes: Vec<Cause> = reported.iter().map(|c| c.cause).collect();
        assert_eq!(causes, [Cause::BerthSteel], "seed {seed}: {reported:?}");
        assert!(reported[0].causes[0].probability > 0.8, "{reported:?}");
        let (arrived, sailed) = (
            log.samples[call_before(&log, reported[0])].time,
            reported[0].ended,
        );
        assert!(reported[0].from > arrived && sailed.is_some());
        assert!(
            reported[0]
                .evidence
                .iter()
                .all(|line| !line.contains("at sea"))
        );
        assert!(taken_alongside(&analysis) > 50);
        assert_eq!(analysis.epochs.len(), 1);
    }
}

/// Returns the last sample under way before a change.
fn call_before(log: &Log, change: &Change) -> usize {
    let before = log.samples.partition_point(|s| s.time < change.from);
    let is_under_way = |k: &usize| log.samples[*k].sog_kn.is_some_and(|kn| kn > 5.0);
    (0..before).rev().find(is_under_way).unwrap()
}

#[test]
fn a_berth_without_steel_is_not_reported() {
    for seed in 70..73 {
        let mut log = sail_log(seed, &calm(Event::Nothing));
        let truth = log.truth;
        lie_alongside(&mut log, 0.0, |_| truth);
        let analysis = run(&log.samples);
        assert_eq!(confirmed(&analysis).len(), 0, "{:?}", analysis.changes);
        assert!(taken_alongside(&analysis) > 50);
    }
}

#[test]
fn while_a_vessel_lies_alongside_the_error_may_be_the_berths_or_its_own() {
    let mut log = sail_log(70, &calm(Event::Nothing));
    let truth = log.truth;
    lie_alongside(&mut log, 5.0, |_| truth);
    let lying = log.samples.iter().rposition(|s| s.sog_kn == Some(0.1));
    let analysis = run(&log.samples[..=lying.unwrap()]);
    is_sound(&analysis);
    assert_eq!(confirmed(&analysis).len(), 0);
    let reported = analysis.changes.last().unwrap();
    let share = |cause: Cause| {
        let of = reported.causes.iter().find(|c| c.cause == cause);
        of.map_or(0.0, |c| c.probability)
    };
    assert!(share(Cause::BerthSteel) > 0.3, "{reported:?}");
    assert!(share(Cause::MagneticCargo) > 0.1, "{reported:?}");
    assert!(reported.ended.is_none());
}

#[test]
fn cargo_loaded_during_a_stay_with_samples_begins_in_port() {
    for seed in [43, 48, 51] {
        let mut log = sail_log(seed, &calm(Event::Cargo));
        let loaded = began(&log, Name::Cargo).plus_seconds(5.0 * HOUR_S);
        let [before, after] = log.changed.unwrap();
        let truth = log.truth;
        lie_alongside(&mut log, 0.0, |time| Truth {
            parameters: if time < loaded { before } else { after },
            ..truth
        });
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let reported = confirmed(&analysis);
        let causes: Vec<Cause> = reported.iter().map(|c| c.cause).collect();
        assert_eq!(causes, [Cause::MagneticCargo], "seed {seed}: {reported:?}");
        assert!(
            reported[0]
                .evidence
                .contains(&"it began at a port call".to_owned())
        );
    }
}
