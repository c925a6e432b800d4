//! Band in the first hours after a strike: the courses sailed since show the part across
//! the needle on them, and no more.

use crate::voyages::fleet::{Event, Name, Plan, START, sail_log};
use crate::voyages::{Variety, predicted, true_deviation};
use crate::{HOUR_S, began, calm, is_sound, of_the_ship, run};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::{Analysis, Cause, Change};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;

const DAY_S: f64 = 86_400.0;

/// A calm voyage with a strike, up to some hours after it.
struct Struck {
    at: Timestamp,
    samples: Vec<Sample>,
    analysis: Analysis,
    /// Error of the deviation and its standard error, degrees, on every tenth degree of the
    /// compass; none without a model. Headings that the compass no longer shows are left
    /// out.
    off_deg: Vec<(f64, f64)>,
}

fn struck(seed: u64, event: Event, hours: f64) -> Struck {
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
    let off_deg = (0..36).filter_map(off).collect();
    Struck {
        at,
        samples: log.samples[..until].to_vec(),
        analysis,
        off_deg,
    }
}

impl Struck {
    /// Returns true if the vessel has sailed on one heading since.
    fn is_on_one_course(&self) -> bool {
        // The first reading mixes both states.
        let is_since = |s: &&Sample| s.time.seconds_since(self.at) > 600.0;
        let since = self.samples.iter().filter(is_since);
        let compass: Vec<f64> = since.map(|s| s.compass.degrees()).collect();
        compass
            .iter()
            .all(|deg| wrap_180(deg - compass[0]).abs() < 5.0)
    }
}

/// Returns the number of headings on which the band holds the truth.
fn held(off_deg: &[(f64, f64)]) -> usize {
    let held = |(off, se): &&(f64, f64)| off.abs() <= 1.96 * se;
    off_deg.iter().filter(held).count()
}

#[test]
fn an_hour_after_a_strike_that_showed_the_band_holds_the_truth_on_every_course() {
    for nt in [4000.0, 8000.0] {
        for seed in 1..6 {
            // Half of it along the needle, where no heading shows it yet.
            let off = struck(seed, Event::StepBy(nt, 45.0), 1.0).off_deg;
            let held = held(&off);
            assert!(held > 33, "seed {seed}, {nt} nT: {held} of {}", off.len());
        }
    }
}

#[test]
fn hours_after_a_strike_the_band_is_open_where_no_course_has_shown_it() {
    let (mut all, mut in_band) = (0, 0);
    for seed in 1..9 {
        let off = struck(seed, Event::StepBy(6000.0, 60.0), 5.0).off_deg;
        all += off.len();
        in_band += held(&off);
        let runs_aground = |(off, se): &(f64, f64)| off.abs() > 10.0 && 1.96 * se < 5.0;
        assert!(!off.iter().any(runs_aground), "seed {seed}: {off:?}");
    }
    assert!(all > 6 * 36, "{all}");
    assert!(in_band as f64 > 0.93 * all as f64, "{in_band} of {all}");
}

#[test]
fn days_after_a_strike_the_band_is_narrow_again() {
    for seed in 1..4 {
        let off = struck(seed, Event::StepBy(3000.0, 60.0), 96.0).off_deg;
        let widest = off.iter().map(|off| off.1).fold(0.0, f64::max);
        assert!(widest < 1.5, "seed {seed}: {widest}");
        let held = held(&off);
        assert!(held > 30, "seed {seed}: {held}");
    }
}

#[test]
fn a_strike_of_any_size_is_reported_as_one_and_the_band_holds_the_truth_a_day_after() {
    let (mut all, mut in_band) = (0, 0);
    for nt in [12_000.0, 20_000.0] {
        for seed in 1..7 {
            let ship = struck(seed, Event::Step(nt), 24.0);
            let found = of_the_ship(&ship.analysis);
            let what = format!("seed {seed}, {nt} nT: {:?}", ship.analysis.changes);
            assert_eq!(found.len(), 1, "{what}");
            assert_eq!(found[0].cause, Cause::LightningOrShock, "{what}");
            let off_s = found[0].from.seconds_since(ship.at).abs();
            assert!(off_s < HOUR_S, "{what}");
            let delay_h = found[0].detected_at.seconds_since(ship.at) / HOUR_S;
            assert!(delay_h < 4.0, "{what}");
            all += ship.off_deg.len();
            in_band += held(&ship.off_deg);
        }
    }
    // The compass of some has no force left on some headings, and there is no model.
    assert!(all > 6 * 36, "{all}");
    assert!(in_band as f64 > 0.95 * all as f64, "{in_band} of {all}");
}

#[test]
fn what_one_course_does_not_show_of_a_strike_is_open() {
    let (mut on_one_course, mut open) = (0, 0);
    for seed in 1..30 {
        let ship = struck(seed, Event::Step(8000.0), 2.5);
        let is_reported = !of_the_ship(&ship.analysis).is_empty() && !ship.off_deg.is_empty();
        if !ship.is_on_one_course() || !is_reported {
            continue;
        }
        on_one_course += 1;
        let widest_deg = ship.off_deg.iter().map(|off| off.1).fold(0.0, f64::max);
        open += usize::from(held(&ship.off_deg) > 33 && widest_deg > 4.0);
    }
    assert!(on_one_course > 12, "{on_one_course}");
    assert!(10 * open >= 9 * on_one_course, "{open} of {on_one_course}");
}

/// The reading during the first two strikes fits neither state, and on the next course the
/// first reading after it would be another strike; on the first two courses of the others
/// the strike looks like an alignment change.
#[test]
fn a_strike_is_reported_once_whatever_courses_come_after_it() {
    let ships = [
        (381_005, Variety::Poor),
        (381_019, Variety::Medium),
        (381_046, Variety::Medium),
        (382_153, Variety::Medium),
    ];
    for (seed, variety) in ships {
        let plan = Plan {
            gyro_faults: 0.0,
            ..Plan::new(Event::Lightning(4000.0), variety)
        };
        let log = sail_log(seed, &plan);
        let struck = began(&log, Name::Lightning);
        let until = log
            .samples
            .partition_point(|s| s.time.seconds_since(struck) < 6.0 * DAY_S);
        let analysis = run(&log.samples[..until]);
        let since = |c: &&Change| c.detected_at > struck;
        let reported: Vec<_> = of_the_ship(&analysis).into_iter().filter(since).collect();
        assert_eq!(reported.len(), 1, "{seed}: {reported:?}");
        assert_eq!(reported[0].cause, Cause::LightningOrShock, "{seed}");
    }
}
