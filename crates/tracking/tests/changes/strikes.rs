//! Strikes of several sizes, and the band in the days after them.

use crate::voyages::fleet::{Event, Name, Plan, START, sail_log};
use crate::voyages::{predicted, true_deviation};
use crate::{HOUR_S, began, calm, certain, is_sound, of_the_ship, run};
use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::time::Timestamp;

const DAY_S: f64 = 86_400.0;

/// Returns the error of the deviation and its standard error, degrees, on every tenth degree of
/// the compass some hours after a strike. Headings that the compass no longer shows are left
/// out.
fn off_after_strike(seed: u64, event: Event, hours: f64) -> Vec<(f64, f64)> {
    let plan = calm(event);
    let log = sail_log(seed, &plan);
    let at = began(&log, Name::Step);
    let sailed = log.samples.iter().find(|s| s.time > at).unwrap().time;
    let until = log
        .samples
        .partition_point(|s| s.time.seconds_since(sailed) < hours * HOUR_S);
    let analysis = run(&log.samples[..until]);
    is_sound(&analysis);
    // The state at that time: the vessel drifts.
    let last = log.samples[until - 1].time;
    let days = last.seconds_since(Timestamp::parse(START).unwrap()) / DAY_S + 0.001;
    let truth = sail_log(seed, &Plan { days, ..plan }).truth;
    let place = analysis.last_place.unwrap();
    let model = analysis.current_epoch().unwrap().model.as_ref();
    let off = |k: i32| {
        let compass_deg = 10.0 * f64::from(k);
        let truth_deg = true_deviation(&truth, compass_deg, place.h_nt, place.z_nt);
        let (predicted_deg, se_deg) = predicted(model?, compass_deg, place.h_nt, place.z_nt);
        let off_deg = wrap_180(truth_deg - predicted_deg);
        off_deg.is_finite().then_some((off_deg, se_deg))
    };
    (0..36).filter_map(off).collect()
}

/// Returns the number of headings on which the band holds the truth.
fn held(off_deg: &[(f64, f64)]) -> usize {
    let held = |(off, se): &&(f64, f64)| off.abs() <= 1.96 * se;
    off_deg.iter().filter(held).count()
}

#[test]
fn days_after_a_strike_the_band_is_narrow_again() {
    for seed in 1..4 {
        let off = off_after_strike(seed, Event::StepBy(3000.0, 60.0), 96.0);
        let widest = off.iter().map(|off| off.1).fold(0.0, f64::max);
        assert!(widest < 1.5, "seed {seed}: {widest}");
        let held = held(&off);
        assert!(held > 30, "seed {seed}: {held}");
    }
}

/// On the first heading a strike shows by half; the rest of it is no second one.
#[test]
fn a_strike_is_one_change_through_the_first_turns() {
    for seed in 1..13 {
        let log = sail_log(seed, &calm(Event::Step(2500.0)));
        let at = began(&log, Name::Step);
        let until = log
            .samples
            .partition_point(|s| s.time.seconds_since(at) < 2.0 * DAY_S);
        let analysis = run(&log.samples[..until]);
        let found = of_the_ship(&analysis);
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
    }
}

#[test]
fn a_step_of_any_size_is_the_ships_own() {
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
