use super::check::{Reference, check_differences, merge};
use super::*;
use crate::observation::Observation;
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::result::FitError;
use binnacle_compass::time::Timestamp;

fn heading(degrees: f64) -> TrueHeading {
    TrueHeading::new(degrees).unwrap()
}

/// Readings of a ship of known magnetism, every ten minutes, with the errors `off` of gyro
/// and satellite compass.
fn readings(count: u32, off: impl Fn(u32) -> (f64, f64)) -> Vec<HeadingReading> {
    (0..count)
        .map(|i| {
            let compass = f64::from(i * 37 % 360);
            let deviation = 3.0 * compass.to_radians().sin() - 2.0 * compass.to_radians().cos();
            let (gyro, satellite) = off(i);
            HeadingReading {
                time: Timestamp::from_micros(1_780_000_000_000_000 + i64::from(i) * 600_000_000)
                    .ok(),
                position: Position::new(40.0, -20.0).ok(),
                compass: CompassHeading::new(compass).unwrap(),
                gyro: TrueHeading::new(compass + deviation + gyro),
                satellite: TrueHeading::new(compass + deviation + satellite),
                unnamed: None,
                variation: Variation::ZERO,
                h_nt: 24_000.0,
                z_nt: 38_000.0,
                sog_kn: None,
                windows: 60,
                spread_deg: None,
                weight: 1.0,
            }
        })
        .collect()
}

fn wobble(i: u32) -> f64 {
    0.1 * f64::from(i % 7) - 0.3
}

#[test]
fn a_lasting_difference_is_halved_and_widens_the_constant() {
    let referred = observe_readings(&readings(200, |i| (4.0 + wobble(i), 0.0)), 0.5).unwrap();
    assert!((referred.check.offset_deg.unwrap() - 4.0).abs() < 0.11);
    assert!((referred.check.constant_sd_deg - 2.0).abs() < 0.06);
    let check = check_differences((0..40).map(|_| 4.0), 0.5);
    let merged = |gyro, satellite| merge(&check, gyro, satellite).unwrap();
    for Reference { heading, .. } in [
        merged(Some(heading(1.0)), None),
        merged(None, Some(heading(357.0))),
        merged(Some(heading(1.0)), Some(heading(357.0))),
    ] {
        assert!(wrap(heading.degrees() - 359.0).abs() < 1e-9);
    }
}

fn wrap(degrees: f64) -> f64 {
    binnacle_compass::angle::wrap_180(degrees)
}

#[test]
fn references_that_never_agree_are_refused() {
    let refused = observe_readings(&readings(200, |i| (9.0 + wobble(i), 0.0)), 0.5);
    assert!(matches!(
        refused,
        Err(FitError::ReferencesDisagree { offset_deg, .. }) if (offset_deg - 9.0).abs() < 0.2
    ));
}

/// The fault lasts a day out of a week.
#[test]
fn the_reference_that_fails_for_a_day_is_dropped_and_the_other_kept() {
    let failing = |i: u32| if (300..444).contains(&i) { 7.0 } else { 0.0 };
    let gyro_fails =
        observe_readings(&readings(1000, |i| (wobble(i) + failing(i), 0.0)), 0.5).unwrap();
    assert_eq!(gyro_fails.check.gyro_dropped, 144);
    assert_eq!(gyro_fails.check.satellite_dropped, 0);
    let satellite_fails =
        observe_readings(&readings(1000, |i| (0.0, wobble(i) - failing(i))), 0.5).unwrap();
    assert_eq!(satellite_fails.check.gyro_dropped, 0);
    assert_eq!(satellite_fails.check.satellite_dropped, 144);
    for referred in [gyro_fails, satellite_fails] {
        assert!(referred.observations.iter().all(Option::is_some));
        assert!(referred.check.offset_deg.unwrap().abs() < 0.2);
    }
}

/// The gyro is 8° off for two thirds of the time: the other third is right.
#[test]
fn a_gyro_that_failed_for_most_of_the_time_is_dropped_all_the_same() {
    let off = |i| (wobble(i) + if i >= 333 { 8.0 } else { 0.0 }, 0.0);
    let referred = observe_readings(&readings(1000, off), 0.5).unwrap();
    assert_eq!(referred.check.gyro_dropped, 667);
    assert_eq!(referred.check.satellite_dropped, 0);
}

/// The error is too small for a single reading, and lasts far longer than the usual
/// difference did.
#[test]
fn a_reference_that_is_off_for_good_never_becomes_the_usual_one() {
    for off_deg in [-3.0, -2.0, 2.0, 3.0] {
        let since = |i: u32| if i >= 1000 { off_deg } else { 0.0 };
        let gyro = observe_readings(&readings(5000, |i| (wobble(i) + since(i), 0.0)), 0.5).unwrap();
        assert_eq!(
            (gyro.check.gyro_dropped, gyro.check.satellite_dropped),
            (4000, 0)
        );
        let satellite = observe_readings(&readings(5000, |i| (wobble(i), since(i))), 0.5).unwrap();
        let dropped = (
            satellite.check.gyro_dropped,
            satellite.check.satellite_dropped,
        );
        assert_eq!(dropped, (0, 4000), "{off_deg}");
        for referred in [gyro, satellite] {
            assert!(referred.observations.iter().all(Option::is_some));
            assert!(referred.check.offset_deg.unwrap().abs() < 0.2);
            assert!(referred.check.constant_sd_deg < 0.4);
        }
    }
}

/// The fault was there from the first day, and was repaired.
#[test]
fn references_that_stand_together_at_last_do_so_as_usual() {
    let before = |i: u32| if i < 1000 { 4.0 } else { 0.0 };
    let referred = observe_readings(&readings(5000, |i| (wobble(i), before(i))), 0.5).unwrap();
    assert_eq!(referred.check.satellite_dropped, 1000);
    assert_eq!(referred.check.gyro_dropped, 0);
    assert!(referred.check.offset_deg.unwrap().abs() < 0.2);
}

#[test]
fn a_reference_that_is_itself_again_is_believed_again() {
    let while_off = |i: u32| if (1500..3500).contains(&i) { 2.0 } else { 0.0 };
    let referred = observe_readings(&readings(5000, |i| (wobble(i), while_off(i))), 0.5).unwrap();
    assert_eq!(referred.check.satellite_dropped, 2000);
    assert_eq!(referred.check.gyro_dropped, 0);
}

/// Half a degree a day is no step, and adds up.
#[test]
fn a_gyro_that_creeps_away_is_left_out() {
    let creeps = |i: u32| f64::from(i.saturating_sub(2000)) / 288.0;
    let referred =
        observe_readings(&readings(5000, |i| (wobble(i) + creeps(i), 0.0)), 0.5).unwrap();
    assert_eq!(referred.check.satellite_dropped, 0);
    // From an error of a degree on.
    let dropped = referred.check.gyro_dropped;
    assert!((2500..2900).contains(&dropped), "{dropped}");
}

#[test]
fn when_the_compass_cannot_tell_neither_is_believed() {
    // Both are 3° off, to either side.
    let off = |i| {
        if (400..500).contains(&i) {
            (3.0 + wobble(i), -3.0)
        } else {
            (wobble(i), 0.0)
        }
    };
    let referred = observe_readings(&readings(1000, off), 0.5).unwrap();
    let without = referred.observations.iter().filter(|o| o.is_none());
    assert_eq!(without.count(), 100);
}

#[test]
fn a_reference_that_repeats_itself_while_the_ship_turns_is_dropped() {
    let mut stuck = readings(300, |i| (wobble(i), 0.0));
    for reading in &mut stuck[100..160] {
        reading.gyro = Some(heading(123.4));
    }
    let referred = observe_readings(&stuck, 0.5).unwrap();
    assert_eq!(referred.check.gyro_dropped, 60);
    assert!(referred.observations.iter().all(Option::is_some));
    // On one course both may repeat themselves.
    let mut straight = readings(300, |i| (wobble(i), 0.0));
    for reading in &mut straight[100..160] {
        reading.compass = CompassHeading::new(90.0).unwrap();
        reading.gyro = Some(heading(93.0));
        reading.satellite = Some(heading(93.1));
    }
    assert_eq!(
        observe_readings(&straight, 0.5).unwrap().check.gyro_dropped,
        0
    );
}

#[test]
fn the_order_of_the_readings_does_not_matter() {
    let off = |i| (wobble(i) + if i < 200 { 6.0 } else { 0.0 }, 0.0);
    let forward = readings(900, off);
    let mut backward = forward.clone();
    backward.reverse();
    let forward = observe_readings(&forward, 0.5).unwrap();
    let mut backward = observe_readings(&backward, 0.5).unwrap();
    backward.observations.reverse();
    assert_eq!(forward, backward);
}

/// The reference oscillates about one heading; the sound gyro is kept.
#[test]
fn a_reference_that_trembles_where_the_ship_turns_is_stuck() {
    for tremble in [0.05, 0.4, 3.0] {
        let oscillating = |i: u32| heading(123.0 + tremble * wobble(i) / 0.3);
        let mut stuck = readings(300, |i| (wobble(i), 0.0));
        for (i, reading) in stuck.iter_mut().enumerate() {
            reading.satellite = Some(oscillating(i as u32));
        }
        let referred = observe_readings(&stuck, 0.5).unwrap();
        assert_eq!(referred.check.satellite_dropped, 300, "{tremble}");
        assert!(referred.observations.iter().all(Option::is_some));
        for reading in &mut stuck {
            reading.gyro = None;
        }
        let refused = observe_readings(&stuck, 0.5);
        assert_eq!(refused, Err(FitError::ReferenceStuck { readings: 300 }));
    }
}

/// Neither wild compass readings on a steady course nor a compass moved by 60° by lightning
/// make a sound gyro a stuck one.
#[test]
fn a_gyro_on_a_steady_course_is_not_stuck_for_what_the_compass_does() {
    let mut steady = readings(300, |i| (wobble(i), 0.0));
    for (i, reading) in steady.iter_mut().enumerate() {
        let moved = if i >= 150 { 60.0 } else { 0.0 };
        let wild = if i % 10 == 0 { 20.0 } else { 0.0 };
        reading.compass = CompassHeading::new(80.0 + moved + wild).unwrap();
        reading.gyro = Some(heading(90.0 + wobble(i as u32)));
        reading.satellite = None;
    }
    let referred = observe_readings(&steady, 0.5).unwrap();
    assert_eq!(referred.check.gyro_dropped, 0);
}

#[test]
fn readings_without_any_reference_are_refused_by_name() {
    let mut none = readings(30, |_| (0.0, 0.0));
    for reading in &mut none {
        (reading.gyro, reading.satellite) = (None, None);
    }
    assert_eq!(
        observe_readings(&none, 0.5),
        Err(FitError::NoReference { readings: 30 })
    );
}

#[test]
fn a_compass_that_swings_over_a_steady_ship_costs_no_reference() {
    let mut readings = readings(200, |i| (wobble(i), wobble(i + 3)));
    for (i, reading) in readings.iter_mut().enumerate().skip(100).take(24) {
        let wobble = wobble(i as u32);
        reading.gyro = TrueHeading::new(90.0 + wobble);
        reading.satellite = TrueHeading::new(90.2 - wobble);
        let swung = 90.0 + 70.0 * (0.7 * i as f64).sin();
        reading.compass = CompassHeading::new(swung).unwrap();
    }
    let referred = observe_readings(&readings, 0.5).unwrap();
    let both = |o: &Option<Observation>| o.is_some_and(|o| o.gyro_less_satellite_deg.is_some());
    assert!(referred.observations[100..124].iter().all(both));
}
