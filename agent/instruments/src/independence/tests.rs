//! References of simulated ships: independent ones serve, and those made of the compass never do.
//!
//! The ships share no code with the test of shared noise.

use super::*;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;

/// Steps of the simulation in a second.
const STEPS_PER_S: usize = 10;
/// Variation that is entered in a converter by hand, or comes from a receiver.
const VARIATION_DEG: f64 = -1.4;

fn normal(rng: &mut StdRng) -> f64 {
    // A sum of twelve even numbers has the variance 1.
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}

fn shown(degrees: f64, digit: f64) -> f64 {
    ((degrees / digit).round() * digit).rem_euclid(360.0)
}

/// A ship and her instruments.
#[derive(Clone, Copy, Debug)]
struct Ship {
    yaw_deg: f64,
    deviation_deg: f64,
    compass_noise_deg: f64,
    compass_digit: f64,
    /// Compass readings a second.
    compass_rate: usize,
    /// Minutes on each course.
    course_minutes: usize,
}

const FREIGHTER: Ship = Ship {
    yaw_deg: 0.8,
    deviation_deg: 3.0,
    compass_noise_deg: 0.15,
    compass_digit: 0.1,
    compass_rate: 10,
    course_minutes: 6,
};
const WELL_ADJUSTED: Ship = Ship {
    deviation_deg: 0.3,
    ..FREIGHTER
};
const YACHT: Ship = Ship {
    yaw_deg: 4.0,
    deviation_deg: 6.0,
    compass_noise_deg: 0.3,
    compass_digit: 0.1,
    compass_rate: 1,
    course_minutes: 6,
};
/// On autopilot in a calm, on one course.
const CALM: Ship = Ship {
    yaw_deg: 0.2,
    course_minutes: 1_000,
    ..FREIGHTER
};
const WHOLE_DEGREES: Ship = Ship {
    compass_digit: 1.0,
    ..YACHT
};

/// Moment at which a reference is read.
struct Moment<'a> {
    true_deg: f64,
    /// Latest readings of the compass, the newest last.
    compass_deg: &'a [f64],
    rng: &'a mut StdRng,
}

/// Result of a voyage.
#[derive(Debug, Default)]
struct Sailed {
    readings: u32,
    /// Readings of the reference that served.
    used: u32,
    problems: Vec<String>,
}

/// Sails for some minutes, with the reference read once a second.
fn sail(
    seed: u64,
    minutes: usize,
    ship: Ship,
    reference_deg: impl Fn(&mut Moment<'_>) -> f64,
) -> Sailed {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut independence = Independence::default();
    let mut sailed = Sailed::default();
    let start = Timestamp::parse("2026-05-01T00:00:00Z").unwrap();
    let source = SourceId::from_name("bridge HE HDT");
    let (mut course, mut wanted) = (360.0 * rng.random::<f64>(), 0.0);
    let (mut slow, mut compass) = (0.0, Vec::new());
    for step in 0..minutes * 60 * STEPS_PER_S {
        let second = step as f64 / STEPS_PER_S as f64;
        if step % (ship.course_minutes * 60 * STEPS_PER_S) == 0 {
            wanted = course + 160.0 * rng.random::<f64>() - 80.0;
        }
        // Turns at thirty degrees a minute.
        let turn = 0.5 / STEPS_PER_S as f64;
        course += (wanted - course).clamp(-turn, turn);
        let swell = (TAU * second / 9.0).sin() + 0.4 * (TAU * second / 23.0).sin();
        let true_deg = course + ship.yaw_deg * swell;
        if step % STEPS_PER_S == 0 {
            let now = start.plus_seconds(second);
            independence.observe(Signal::Time(now));
            independence.observe(Signal::Position(Position::new(43.0, -3.0).unwrap()));
        }
        if step % (STEPS_PER_S / ship.compass_rate) == 0 {
            // The card is slower than the ship, and swings with the roll.
            slow = 0.9 * slow + 0.4 * ship.compass_noise_deg * normal(&mut rng);
            let deviation = ship.deviation_deg * (true_deg + 30.0).to_radians().sin();
            let noise = slow + 0.5 * ship.compass_noise_deg * normal(&mut rng);
            let raw = shown(
                true_deg - VARIATION_DEG - deviation + noise,
                ship.compass_digit,
            );
            compass.push(raw);
            independence.observe(Signal::Compass(CompassHeading::new(raw).unwrap()));
        }
        if step % STEPS_PER_S != STEPS_PER_S / 2 {
            continue;
        }
        let heading = reference_deg(&mut Moment {
            true_deg,
            compass_deg: &compass,
            rng: &mut rng,
        });
        let heading = TrueHeading::new(heading).unwrap();
        sailed.readings += 1;
        let reading = ReferenceHeading { heading, source };
        if independence.observe(Signal::Gyro(reading)).is_none() {
            sailed.used += 1;
        }
    }
    sailed.problems = independence.problems().collect();
    sailed
}

/// A converter that repeats one of the latest readings of the compass, now a newer and now an
/// older one.
fn late_reading(moment: &mut Moment<'_>, ship: Ship) -> f64 {
    let most = (4 * ship.compass_rate / 10).max(1);
    let late = (moment.rng.random::<f64>() * most as f64) as usize;
    let readings = moment.compass_deg;
    readings[readings.len().saturating_sub(1 + late)]
}

#[test]
fn an_independent_reference_serves_in_a_quarter_of_an_hour_and_is_never_refused() {
    for ship in [FREIGHTER, WELL_ADJUSTED, YACHT, WHOLE_DEGREES] {
        for digit in [0.01, 0.1] {
            for (seed, noise_deg) in (0..6).zip([0.03, 0.1, 0.3].into_iter().cycle()) {
                let sailed = sail(seed, 40, ship, |moment| {
                    shown(moment.true_deg + noise_deg * normal(moment.rng), digit)
                });
                assert!(sailed.problems.is_empty(), "{ship:?} {seed}: {sailed:?}");
                let share = f64::from(sailed.used) / f64::from(sailed.readings);
                assert!(share > 25.0 / 40.0, "{ship:?} {digit} {seed}: {sailed:?}");
            }
        }
    }
}

#[test]
fn in_a_calm_an_independent_reference_serves_in_half_an_hour() {
    for seed in 0..6 {
        let sailed = sail(seed, 60, CALM, |moment| {
            shown(moment.true_deg + 0.1 * normal(moment.rng), 0.1)
        });
        assert!(sailed.problems.is_empty(), "{seed}: {sailed:?}");
        assert!(sailed.used > 30 * 60, "{seed}: {sailed:?}");
    }
}

#[test]
fn whole_degrees_on_both_sides_are_no_proof_against_a_gyro() {
    for seed in 0..6 {
        let sailed = sail(seed, 60, WHOLE_DEGREES, |moment| {
            shown(moment.true_deg + 0.1 * normal(moment.rng), 1.0)
        });
        let is_refused = sailed.problems.iter().any(|p| p.contains("no reference"));
        assert!(!is_refused, "{seed}: {sailed:?}");
    }
}

#[test]
fn a_heading_made_of_the_compass_never_serves_and_is_named_after_turns() {
    for ship in [FREIGHTER, WELL_ADJUSTED, YACHT, WHOLE_DEGREES] {
        for seed in 0..6 {
            let sailed = sail(seed, 60, ship, |moment| {
                shown(late_reading(moment, ship) + VARIATION_DEG, 0.1)
            });
            assert_eq!(sailed.used, 0, "{ship:?} {seed}: {sailed:?}");
            let named = sailed.problems.concat();
            assert!(named.starts_with("gyro: "), "{ship:?} {seed}: {sailed:?}");
        }
    }
}

/// A display that smooths the compass.
fn smoothed(readings: &[f64], seconds: f64, rate_hz: usize) -> f64 {
    let share = 1.0 - (-1.0 / (seconds * rate_hz as f64)).exp();
    let recent = &readings[readings.len().saturating_sub(600)..];
    recent[1..].iter().fold(recent[0], |smoothed, reading| {
        let off = (reading - smoothed + 540.0).rem_euclid(360.0) - 180.0;
        smoothed + share * off
    })
}

/// A display that shows the mean of the last seconds.
fn averaged(readings: &[f64], seconds: f64, rate_hz: usize) -> f64 {
    let count = ((seconds * rate_hz as f64) as usize).clamp(1, readings.len());
    let recent = &readings[readings.len() - count..];
    let offs = recent
        .iter()
        .map(|reading| (reading - recent[0] + 540.0).rem_euclid(360.0) - 180.0);
    recent[0] + offs.sum::<f64>() / count as f64
}

/// Fails unless a display's heading serves ten minutes at most and is named.
fn assert_named(ship: Ship, seed: u64, display: impl Fn(&[f64]) -> f64) {
    let sailed = sail(seed, 60, ship, |moment| {
        shown(display(moment.compass_deg) + VARIATION_DEG, 0.1)
    });
    assert!(sailed.used <= 10 * 60, "{ship:?} {seed}: {sailed:?}");
    let named = sailed.problems.concat();
    assert!(named.starts_with("gyro: "), "{ship:?} {seed}: {sailed:?}");
}

#[test]
fn a_heading_that_a_display_damps_serves_ten_minutes_at_most_and_is_named() {
    for ship in [FREIGHTER, YACHT] {
        for (seed, seconds) in (0..).zip([1.0, 2.0, 3.5, 5.0, 7.0, 10.0, 12.0]) {
            assert_named(ship, seed, |readings| {
                smoothed(readings, seconds, ship.compass_rate)
            });
        }
    }
}

#[test]
fn a_heading_that_a_display_averages_serves_ten_minutes_at_most_and_is_named() {
    for ship in [FREIGHTER, YACHT] {
        for (seed, seconds) in (0..).zip([2.0, 4.0, 6.0, 10.0, 16.0, 20.0]) {
            assert_named(ship, seed, |readings| {
                averaged(readings, seconds, ship.compass_rate)
            });
        }
    }
}

#[test]
fn a_heading_made_of_the_compass_never_serves_on_one_course_either() {
    for seed in 0..6 {
        let sailed = sail(seed, 60, CALM, |moment| {
            shown(late_reading(moment, CALM) + VARIATION_DEG, 0.1)
        });
        assert_eq!(sailed.used, 0, "{seed}: {sailed:?}");
    }
}

#[test]
fn the_agents_own_corrected_heading_never_serves() {
    for ship in [FREIGHTER, YACHT] {
        for seed in 0..6 {
            let sailed = sail(seed, 60, ship, |moment| {
                let raw = late_reading(moment, ship);
                let card = 5.0 * (raw + 20.0).to_radians().sin();
                shown(raw + card + VARIATION_DEG, 0.1)
            });
            assert_eq!(sailed.used, 0, "{ship:?} {seed}: {sailed:?}");
        }
    }
}

#[test]
fn a_gyro_whose_place_the_compass_takes_is_refused_within_two_hours() {
    let minutes = std::cell::Cell::new(0.0);
    let sailed = sail(3, 240, FREIGHTER, |moment| {
        minutes.set(minutes.get() + 1.0 / 60.0);
        if minutes.get() < 60.0 {
            return shown(moment.true_deg + 0.1 * normal(moment.rng), 0.1);
        }
        shown(late_reading(moment, FREIGHTER) + VARIATION_DEG, 0.1)
    });
    assert!(
        sailed.problems.concat().contains("no reference"),
        "{sailed:?}"
    );
    assert!(sailed.used < 180 * 60, "{sailed:?}");
}
