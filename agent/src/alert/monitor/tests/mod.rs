//! Ships whose compass goes wrong, and ships whose compass only seems to.

use super::*;
use crate::config::GyroError;
use crate::corrected_heading::predict;
use crate::sampler::Details;
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::position::Position;
use binnacle_instruments::ReckonedPlace;

mod verdict;

/// 2026-09-01T00:00:00Z, in windows.
const START: i64 = 178_822_080;

fn model(version: u32) -> ModelDownlink {
    ModelDownlink {
        id: Uuid::from_u128(u128::from(version)),
        version,
        data_until: end_of(START).unwrap(),
        replaces: None,
        model: Model {
            parameters_over_lambda: Parameters {
                bx_nt: 600.0,
                chi13: 0.0,
                by_nt: -400.0,
                chi23: 0.0,
                chi11_minus_chi22: 0.01,
                chi12: 0.0,
                chi21: 0.0,
            },
            constant_deg: 0.0,
            covariance: None,
            identifiable: None,
            rms_deg: None,
            samples_used: 0,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        },
    }
}

/// Errors of compass and satellite compass; the gyro is exact.
#[derive(Clone, Copy, Default)]
struct Errors {
    compass_deg: f64,
    satellite_deg: Option<f64>,
}

struct Ship {
    monitor: AlertMonitor,
    card: ModelDownlink,
    withdrawn: Option<CardWithdrawn>,
    index: i64,
    revisions: Vec<ShipAlert>,
}

fn ship() -> Ship {
    let card = model(1);
    Ship {
        monitor: AlertMonitor::new(AlertConfig::default(), None, Some(card.id)),
        card,
        withdrawn: None,
        index: START,
        revisions: Vec::new(),
    }
}

impl Ship {
    fn card(&self) -> ActiveCard<'_> {
        ActiveCard {
            model: Some(&self.card),
            withdrawn: self.withdrawn.as_ref(),
        }
    }

    /// Sails the given number of settled windows on a compass heading for which the model is right;
    /// the error comes on top.
    fn sail(&mut self, windows: i64, heading_deg: f64, errors: Errors) {
        for _ in 0..windows {
            self.index += 1;
            // Noise of a ten-second mean in a seaway.
            let noise_deg = [0.4, -0.5, 0.1, -0.3, 0.6, -0.2][self.index.rem_euclid(6) as usize];
            let position = Position::new(43.5, -3.0).unwrap();
            let reading = CompassHeading::new(heading_deg);
            let right = predict(CorrectionInputs {
                compass_is_mixed: false,
                compass: reading,
                place: Some(ReckonedPlace::exactly(position)),
                time: end_of(START),
                model: Some(&self.card),
                withdrawn: None,
                compass_suspected: false,
                withheld: false,
            });
            let gyro_deg = right.true_deg.unwrap().degrees();
            let window = Window {
                is_reckoned: false,
                index: self.index,
                compass_deg: (heading_deg + errors.compass_deg + noise_deg).rem_euclid(360.0),
                gyro_deg: Some(gyro_deg),
                satellite_deg: errors.satellite_deg.map(|error| gyro_deg + error),
                position,
                sog_kn: 12.0,
                rate_of_turn_deg_min: None,
                details: Details::default(),
                gyro_source: None,
                satellite_source: None,
            };
            self.feed(&window);
        }
    }

    fn feed(&mut self, window: &Window) {
        let card = ActiveCard {
            model: Some(&self.card),
            withdrawn: self.withdrawn.as_ref(),
        };
        let id = Uuid::from_u128(window.index.unsigned_abs().into());
        self.revisions
            .extend(self.monitor.observe(window, card, || id));
    }

    fn states(&self) -> Vec<(u32, ShipAlertState)> {
        let revisions = self.revisions.iter();
        revisions
            .map(|alert| (alert.revision, alert.state))
            .collect()
    }
}

const WELL: Errors = Errors {
    compass_deg: 0.0,
    satellite_deg: None,
};
const STRUCK: Errors = Errors {
    compass_deg: 28.0,
    satellite_deg: None,
};

use ShipAlertState::{Agree, NotJudged, Open};

#[test]
fn a_compass_struck_by_lightning_is_an_alert_after_minutes_and_dated_to_the_half_minute() {
    let mut ship = ship();
    ship.sail(400, 90.0, WELL);
    assert_eq!(ship.revisions, []);
    let struck = ship.index;
    ship.sail(14, 90.0, STRUCK);
    assert_eq!(ship.revisions, [], "two minutes are too few");
    ship.sail(6, 90.0, STRUCK);
    let [alert] = ship.revisions[..] else {
        panic!("{:?}", ship.revisions)
    };
    assert_eq!(
        (alert.revision, alert.state, alert.model_version),
        (1, Open, 1)
    );
    assert!(
        (alert.gyro_departure_deg.unwrap() - 28.0).abs() < 2.0,
        "{alert:?}"
    );
    let late_s = alert.since.seconds_since(end_of(struck).unwrap());
    assert!((0.0..=30.0).contains(&late_s), "{late_s}");
    ship.sail(100, 90.0, STRUCK);
    assert_eq!(ship.revisions.len(), 1, "it is said once");
}

#[test]
fn a_gyros_usual_errors_and_single_outliers_are_no_alert() {
    let mut ship = ship();
    for round in 0..200 {
        // A Schuler oscillation of two degrees, and one outlier a minute.
        let swing_deg = 2.0 * (f64::from(round) / 8.4).sin();
        let swung = Errors {
            compass_deg: swing_deg,
            ..WELL
        };
        ship.sail(5, 200.0, swung);
        ship.sail(1, 200.0, STRUCK);
    }
    assert_eq!(ship.revisions, []);
}

#[test]
fn the_limit_is_the_band_and_the_gyros_error_and_grows_towards_the_poles() {
    let ship = ship();
    let limit_deg = |lat: f64| {
        let window = Window {
            is_reckoned: false,
            index: START + 1,
            compass_deg: 90.0,
            gyro_deg: Some(90.0),
            satellite_deg: None,
            position: Position::new(lat, -20.0).unwrap(),
            sog_kn: 12.0,
            rate_of_turn_deg_min: None,
            details: Details::default(),
            gyro_source: None,
            satellite_source: None,
        };
        let now = end_of(window.index).unwrap();
        let apart = ship.monitor.compare(&window, ship.card(), now);
        apart.unwrap().limit_deg - DEFAULT_BAND_DEG
    };
    assert!((limit_deg(0.0) - 2.5).abs() < 1e-9);
    assert!((limit_deg(60.0) - 5.0).abs() < 1e-9);
    assert!((limit_deg(-60.0) - 5.0).abs() < 1e-9);
}

#[test]
fn an_alert_is_revised_and_closes_after_agreement() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    ship.sail(200, 90.0, STRUCK);
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
    ship.sail(20, 90.0, WELL);
    assert_eq!(
        ship.revisions.len(),
        2,
        "three minutes of agreement are too few"
    );
    ship.sail(40, 90.0, WELL);
    assert_eq!(ship.states()[2..], [(3, Agree)]);
    assert!(
        ship.revisions
            .iter()
            .all(|alert| alert.id == ship.revisions[0].id)
    );
    ship.sail(60, 90.0, STRUCK);
    assert_ne!(
        ship.revisions[3].id, ship.revisions[0].id,
        "this is another"
    );
}

#[test]
fn agreement_on_another_heading_ends_nothing_until_it_has_lasted_a_day() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    ship.sail(200, 90.0, STRUCK);
    ship.sail(6 * 360, 180.0, WELL);
    ship.sail(60, 215.0, WELL);
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
    ship.sail(18 * 360 + 300, 180.0, WELL);
    assert_eq!(ship.states()[2..], [(3, Agree)]);
}

#[test]
fn agreement_on_three_courses_across_each_other_speaks_for_all() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    ship.sail(200, 90.0, STRUCK);
    for heading_deg in [180.0, 0.0, 270.0] {
        ship.sail(100, heading_deg, WELL);
    }
    assert_eq!(ship.states(), [(1, Open), (2, Open)], "soft iron's nulls");
    ship.sail(100, 220.0, WELL);
    assert_eq!(ship.states()[2..], [(3, Agree)]);
}

/// Sails 400 windows on each heading with the deviation that `error_deg` gives.
fn sail_each(ship: &mut Ship, headings_deg: &[f64], error_deg: impl Fn(f64) -> f64) {
    for &heading_deg in headings_deg {
        let errors = Errors {
            compass_deg: error_deg(heading_deg),
            ..WELL
        };
        ship.sail(400, heading_deg, errors);
    }
}

/// Deviation of a magnet: at most 14°, and none on 150° and 330°.
fn magnet_deg(heading_deg: f64) -> f64 {
    14.0 * (heading_deg - 150.0).to_radians().sin()
}

#[test]
fn a_strike_is_not_over_on_a_course_on_which_it_does_nothing() {
    for headings_deg in [
        [190.0, 197.0, 172.0, 150.0, 153.0, 147.0, 155.0, 330.0],
        [190.0, 150.0, 190.0, 150.0, 225.0, 150.0, 225.0, 150.0],
        [250.0, 150.0, 250.0, 330.0, 250.0, 150.0, 90.0, 150.0],
        [40.0, 150.0, 80.0, 330.0, 270.0, 330.0, 30.0, 150.0],
    ] {
        let mut ship = ship();
        ship.sail(60, headings_deg[0], WELL);
        sail_each(&mut ship, &headings_deg, magnet_deg);
        assert_eq!(
            ship.states(),
            [(1, Open), (2, Open)],
            "{headings_deg:?}: {:?}",
            ship.revisions
        );
    }
}

#[test]
fn soft_iron_is_not_over_on_courses_on_which_it_does_nothing() {
    let soft_deg = |heading_deg: f64| 9.0 * (2.0 * heading_deg).to_radians().sin();
    let mut ship = ship();
    ship.sail(60, 45.0, WELL);
    sail_each(
        &mut ship,
        &[45.0, 0.0, 90.0, 45.0, 180.0, 270.0, 45.0],
        soft_deg,
    );
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
}

#[test]
fn a_band_that_has_grown_ends_no_alert() {
    let mut ship = ship();
    let apart = Errors {
        compass_deg: 9.0,
        ..WELL
    };
    ship.sail(60, 90.0, apart);
    assert_eq!(ship.states(), [(1, Open)]);
    ship.card = model(2);
    let mut covariance = [[0.0; 8]; 8];
    covariance[7][7] = 13.0_f64.powi(2);
    ship.card.model.covariance = Some(covariance);
    ship.card.replaces = Some(CardWithdrawn {
        since: end_of(START).unwrap(),
        reason: "a change".to_owned(),
    });
    ship.sail(400, 90.0, apart);
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
    ship.sail(400, 40.0, WELL);
    assert_eq!(ship.states(), [(1, Open), (2, Open)], "it says too little");
}

#[test]
fn a_difference_at_the_limit_does_not_chatter() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    for round in 0..300 {
        let near = Errors {
            compass_deg: 5.6 + 0.5 * f64::from(round % 7 - 3) / 3.0,
            ..WELL
        };
        ship.sail(7, 90.0, near);
    }
    assert!(ship.revisions.len() <= 2, "{:?}", ship.states());
}

#[test]
fn an_alert_ends_on_the_heading_on_which_a_wide_band_raised_it() {
    let mut ship = ship();
    let mut covariance = [[0.0; 8]; 8];
    covariance[7][7] = 2.0_f64.powi(2);
    ship.card.model.covariance = Some(covariance);
    ship.sail(60, 90.0, WELL);
    ship.sail(60, 90.0, STRUCK);
    ship.card.model.covariance = None;
    ship.sail(300, 0.0, STRUCK);
    ship.card.model.covariance = Some(covariance);
    ship.sail(60, 0.0, WELL);
    ship.sail(60, 90.0, WELL);
    assert_eq!(ship.states().last().unwrap().1, Agree);
}

#[test]
fn a_model_that_hardly_knows_the_heading_agrees_with_nothing() {
    let mut ship = ship();
    ship.sail(60, 90.0, WELL);
    ship.sail(60, 90.0, STRUCK);
    let mut covariance = [[0.0; 8]; 8];
    covariance[7][7] = 20.0_f64.powi(2);
    ship.card.model.covariance = Some(covariance);
    // It was fitted to the same hour on the same course.
    ship.sail(400, 90.0, WELL);
    assert!(!ship.states().iter().any(|(_, state)| *state == Agree));
    ship.card.model.covariance = None;
    ship.sail(60, 90.0, WELL);
    assert_eq!(ship.states().last().unwrap().1, Agree);
}

#[test]
fn without_a_card_there_is_no_alert_and_one_that_is_open_ends() {
    let mut ship = ship();
    ship.sail(60, 90.0, STRUCK);
    assert_eq!(ship.states(), [(1, Open)]);
    ship.withdrawn = Some(CardWithdrawn {
        since: end_of(START).unwrap(),
        reason: "lightning".to_owned(),
    });
    ship.sail(60, 90.0, STRUCK);
    assert_eq!(ship.states(), [(1, Open), (2, NotJudged)]);
    let none = ActiveCard::default();
    let now = end_of(ship.index).unwrap();
    assert_eq!(
        ship.monitor.update_card(none, now),
        None,
        "it has ended already"
    );
}

#[test]
fn another_model_judges_anew_on_the_course_on_which_they_parted() {
    let mut ship = ship();
    ship.sail(60, 90.0, STRUCK);
    ship.card = model(2);
    ship.sail(400, 200.0, WELL);
    assert_eq!(ship.states(), [(1, Open), (2, Open)]);
    ship.card = model(3);
    ship.sail(59, 90.0, WELL);
    assert_eq!(ship.revisions.len(), 2);
    ship.sail(1, 90.0, WELL);
    assert_eq!(ship.states()[2..], [(3, Agree)]);
}

#[test]
fn a_restart_goes_on_with_the_same_alert() {
    let mut ship = ship();
    ship.sail(100, 90.0, STRUCK);
    let kept = serde_json::to_string(&ship.monitor.record()).unwrap();
    let kept = serde_json::from_str(&kept).unwrap();
    ship.monitor = AlertMonitor::new(AlertConfig::default(), kept, Some(ship.card.id));
    ship.sail(60, 90.0, STRUCK);
    assert_eq!(ship.states(), [(1, Open)]);
    ship.sail(60, 180.0, WELL);
    assert_eq!(
        ship.states(),
        [(1, Open)],
        "it knows on which heading they parted"
    );
    ship.sail(60, 90.0, WELL);
    assert_eq!(ship.states(), [(1, Open), (2, Agree)]);
}

#[test]
fn clocks_that_jump_neither_raise_nor_end_it() {
    let mut ship = ship();
    for jump_windows in [8640, -8640, 8640 * 30, -8640 * 30] {
        ship.sail(100, 90.0, WELL);
        ship.index += jump_windows;
    }
    ship.index = START;
    ship.sail(100, 90.0, WELL);
    assert_eq!(ship.revisions, []);
    ship.sail(60, 90.0, STRUCK);
    for jump_windows in [8640, -8640] {
        ship.index += jump_windows;
        ship.sail(60, 90.0, STRUCK);
    }
    assert_eq!(ship.states(), [(1, Open)]);
}

#[test]
fn a_week_roll_over_of_the_receiver_is_not_held_against_the_compass() {
    let mut ship = ship();
    // 1024 weeks back: the variation of that year is degrees from today's.
    ship.index -= 1024 * 7 * 8640;
    ship.sail(100, 90.0, STRUCK);
    assert_eq!(ship.revisions, []);
}

#[test]
fn a_wider_error_of_the_gyro_asks_for_more() {
    let mut ship = ship();
    let config = AlertConfig {
        gyro_error_deg: GyroError(30.0),
        ..AlertConfig::default()
    };
    ship.monitor = AlertMonitor::new(config, None, Some(ship.card.id));
    ship.sail(100, 90.0, STRUCK);
    assert_eq!(ship.revisions, []);
}
