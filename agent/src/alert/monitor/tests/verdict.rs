//! Verdicts: the suspected instrument, and for how long it is suspected.

use super::*;
use binnacle_wire::alert::Suspect;

fn beside(compass_deg: f64, satellite_deg: Option<f64>) -> Errors {
    Errors {
        compass_deg,
        satellite_deg,
    }
}

/// An open alert of a gyro that is off by 9°, contradicted by the satellite compass.
fn with_a_gyro_at_fault() -> Ship {
    let mut ship = ship();
    ship.sail(60, 90.0, beside(0.0, Some(0.2)));
    ship.sail(60, 90.0, beside(9.0, Some(9.2)));
    assert_eq!(ship.revisions[0].suspect(), Suspect::Gyro);
    ship
}

fn verdict(ship: &Ship) -> Suspect {
    ship.revisions.last().unwrap().suspect()
}

/// Sails the given number of windows on one course with the gyro switched off.
fn sail_without_gyro(ship: &mut Ship, windows: i64, departure_deg: f64) {
    for _ in 0..windows {
        ship.index += 1;
        let window = Window {
            is_reckoned: false,
            index: ship.index,
            compass_deg: 90.0 + departure_deg,
            gyro_deg: None,
            satellite_deg: Some(90.0),
            position: Position::new(43.5, -3.0).unwrap(),
            sog_kn: 12.0,
            rate_of_turn_deg_min: None,
            details: Details::default(),
            gyro_source: None,
            satellite_source: None,
        };
        ship.feed(&window);
    }
}

#[test]
fn a_gyro_fault_that_the_satellite_compass_sees_ends_on_any_heading() {
    let mut ship = ship();
    let sound = Errors {
        satellite_deg: Some(0.2),
        ..WELL
    };
    ship.sail(60, 90.0, sound);
    // The gyro is off by 9°: beside it, both others are off the other way.
    let fault = Errors {
        compass_deg: 9.0,
        satellite_deg: Some(9.2),
    };
    ship.sail(60, 90.0, fault);
    assert_eq!(ship.revisions[0].suspect(), Suspect::Gyro);
    ship.sail(100, 270.0, sound);
    assert_eq!(ship.states().last(), Some(&(2, Agree)));
}

#[test]
fn a_satellite_compass_that_falls_silent_takes_nothing_back_of_what_it_has_proven() {
    let mut ship = with_a_gyro_at_fault();
    ship.sail(400, 90.0, beside(9.0, None));
    ship.sail(60, 90.0, beside(9.0, Some(9.2)));
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
    assert_eq!(verdict(&ship), Suspect::Gyro);
}

#[test]
fn a_compass_struck_while_the_satellite_compass_is_silent_is_borne_out_no_more() {
    let mut ship = with_a_gyro_at_fault();
    ship.sail(100, 90.0, beside(9.0, None));
    ship.sail(100, 90.0, beside(29.0, None));
    assert_eq!(verdict(&ship), Suspect::Unknown);
    assert!(ship.monitor.record().unwrap().suspects_compass());
    // Nor when it returns, though by then it may look so.
    ship.sail(100, 90.0, beside(9.0, Some(9.2)));
    assert!(ship.monitor.record().unwrap().suspects_compass());
}

#[test]
fn a_compass_that_moves_to_a_bad_gyro_is_not_borne_out_by_it() {
    for struck_deg in [5.9, 6.3, 7.5, 8.9, 12.0] {
        let mut ship = with_a_gyro_at_fault();
        ship.sail(400, 90.0, beside(9.0 - struck_deg, Some(9.2)));
        let record = ship.monitor.record().unwrap();
        assert!(record.suspects_compass(), "{struck_deg}: {record:?}");
    }
}

#[test]
fn a_satellite_compass_that_is_read_on_some_headings_only_bears_nothing_out_by_a_turn() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    ship.sail(60, 90.0, beside(10.0, None));
    for _ in 0..5 {
        ship.sail(24, 180.0, beside(0.2, None));
        ship.sail(12, 180.0, beside(0.2, Some(0.0)));
        ship.sail(60, 90.0, beside(10.0, Some(0.0)));
    }
    let trusting =
        |alert: &ShipAlert| matches!(alert.suspect(), Suspect::Gyro | Suspect::Satellite);
    assert!(!ship.revisions.iter().any(trusting), "{:?}", ship.revisions);
    assert_eq!(verdict(&ship), Suspect::Compass);
}

#[test]
fn a_verdict_at_the_limit_does_not_come_and_go() {
    let mut ship = with_a_gyro_at_fault();
    for round in 0..200 {
        let swing_deg = f64::from(round % 9 - 4) / 4.0;
        ship.sail(30, 90.0, beside(10.0, Some(10.0 - 4.5 - swing_deg)));
    }
    assert!(ship.revisions.len() <= 3, "{:?}", ship.states());
}

#[test]
fn a_gyro_that_is_switched_off_does_not_agree_again() {
    let mut ship = with_a_gyro_at_fault();
    sail_without_gyro(&mut ship, 300, 0.0);
    assert!(ship.monitor.record().unwrap().is_open());
}

#[test]
fn whose_fault_it_is_shows_when_the_satellite_compass_is_back() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    ship.sail(60, 90.0, beside(9.0, None));
    assert_eq!(ship.revisions[0].suspect(), Suspect::Unknown);
    ship.sail(100, 90.0, beside(9.0, Some(9.2)));
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
    assert_eq!(ship.revisions[1].suspect(), Suspect::Gyro);
}

#[test]
fn the_satellite_compass_stands_in_for_a_silent_gyro() {
    let mut ship = ship();
    sail_without_gyro(&mut ship, 60, 0.0);
    sail_without_gyro(&mut ship, 30, 20.0);
    assert_eq!(ship.revisions.len(), 1);
    assert_eq!(ship.revisions[0].gyro_departure_deg, None);
    assert!(ship.revisions[0].satellite_departure_deg.unwrap() > 15.0);
}
