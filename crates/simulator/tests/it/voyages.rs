//! Ships behave as the scenario says.

use crate::support::{sail, scenario, sentences, ship};
use binnacle_compass::angle::{CompassHeading, Deviation, Variation, wrap_180};
use binnacle_simulator::scenario::Scenario;
use binnacle_simulator::ship::SatelliteReading;
use binnacle_simulator::truth::{TruthRecorder, place};
use std::path::Path;

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn sd(values: &[f64]) -> f64 {
    let middle = mean(values);
    let squares: Vec<f64> = values.iter().map(|v| (v - middle).powi(2)).collect();
    mean(&squares).sqrt()
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    let scenario = scenario("", "");
    let once = sentences(&scenario, 7, 1.0);
    assert!(once == sentences(&scenario, 7, 1.0));
    assert!(once != sentences(&scenario, 8, 1.0));
}

#[test]
fn compass_deviation_and_variation_add_up_to_the_true_heading() {
    let scenario = scenario("", "");
    let mut ship = ship(&scenario, 3);
    let mut checked = 0;
    sail(&mut ship, 1.5, |ship, _| {
        let compass = CompassHeading::new(ship.quiet_compass_deg()).unwrap();
        let deviation = Deviation::new(ship.deviation_deg(compass.degrees())).unwrap();
        let variation = Variation::new(ship.charted_variation_deg()).unwrap();
        let sum = compass + deviation + variation;
        let error = wrap_180(sum.degrees() - ship.heading_deg());
        assert!(error.abs() < 1e-6, "{error} at {}", ship.time());
        checked += 1;
    });
    assert!(checked > 10_000);
}

#[test]
fn the_compass_agrees_with_the_truth_on_average() {
    let scenario = scenario("", "");
    let mut ship = ship(&scenario, 4);
    let mut errors = Vec::new();
    sail(&mut ship, 20.0, |ship, reading| {
        if !reading.alongside && reading.rate_deg_min.abs() < 3.0 {
            errors.push(wrap_180(reading.compass_deg - ship.quiet_compass_deg()));
        }
    });
    assert!(mean(&errors).abs() < 0.1, "mean {}", mean(&errors));
    assert!(
        sd(&errors) > 0.5,
        "a compass at sea is never still: {}",
        sd(&errors)
    );
}

#[test]
fn the_instruments_are_no_better_than_described() {
    let scenario = scenario("", "");
    let mut ship = ship(&scenario, 5);
    let (mut minute, mut minutes) = (Vec::new(), Vec::new());
    let (mut gyro, mut satellite) = (Vec::new(), Vec::new());
    sail(&mut ship, 40.0, |ship, reading| {
        gyro.push(wrap_180(reading.gyro_deg - reading.heading_deg));
        if let SatelliteReading::Heading(degrees) = reading.satellite {
            satellite.push(wrap_180(degrees - reading.heading_deg));
        }
        if reading.alongside {
            minute.clear();
            return;
        }
        minute.push(wrap_180(reading.compass_deg - ship.quiet_compass_deg()));
        if minute.len() == 30 {
            minutes.push(mean(&minute));
            minute.clear();
        }
    });
    // From minute to minute only fast quantities differ.
    let steps: Vec<f64> = minutes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let quick = sd(&steps) / 2f64.sqrt();
    assert!(
        (0.32..0.5).contains(&quick),
        "compass, a minute's mean: {quick}"
    );
    // Schuler swing 0.35°, three-day bias 0.3°, both over cos 45°.
    assert!((0.5..1.2).contains(&sd(&gyro)), "gyro: {}", sd(&gyro));
    assert!(
        (0.45..0.6).contains(&sd(&satellite)),
        "satellite: {}",
        sd(&satellite)
    );
}

#[test]
fn a_turn_disturbs_the_compass_for_two_minutes_and_not_for_ten() {
    let scenario = scenario(
        "",
        "gaussian_error_deg = 6.0\nturn_deg_min = 20\ntraffic_per_day = 0",
    );
    let mut ship = ship(&scenario, 6);
    let (mut turning, mut since_turn_s) = (Vec::new(), 0.0);
    let mut later = Vec::new();
    sail(&mut ship, 10.0, |ship, reading| {
        let error = wrap_180(reading.compass_deg - ship.quiet_compass_deg());
        since_turn_s += 2.0;
        if reading.rate_deg_min.abs() > 15.0 {
            turning.push(error * reading.rate_deg_min.signum());
            since_turn_s = 0.0;
        }
        if (600.0..900.0).contains(&since_turn_s) && !reading.alongside {
            later.push(error);
        }
    });
    assert!(
        mean(&turning) < -1.0,
        "the card goes with the ship: {}",
        mean(&turning)
    );
    assert!(
        mean(&later).abs() < 0.4,
        "and comes to rest: {}",
        mean(&later)
    );
}

#[test]
fn a_voyage_does_not_begin_with_a_turn() {
    let scenario = scenario("", "");
    for seed in 0..10 {
        let reading = ship(&scenario, seed).step(2.0);
        assert!(reading.rate_deg_min.abs() < 10.0, "{reading:?}");
    }
}

#[test]
fn lightning_is_permanent_and_cargo_is_discharged() {
    let events = r#"events = [
        { kind = "cargo", from_day = 1, to_day = 2, b_nt = [900, 0, 0] },
        { kind = "lightning", day = 3, b_nt = [0, 3000, 0], returning = 0.5, return_days = 1 },
    ]"#;
    let scenario = scenario("", events);
    let mut ship = ship(&scenario, 1);
    let mut recorder = TruthRecorder::new(&ship);
    let mut at_noon = Vec::new();
    for _ in 0..6 {
        sail(&mut ship, 0.5, |ship, _| recorder.record(ship));
        at_noon.push(ship.magnetism().b_nt);
        sail(&mut ship, 0.5, |ship, _| recorder.record(ship));
    }
    let forward: Vec<f64> = at_noon.iter().map(|b| b[0]).collect();
    assert!((forward[0] - 2000.0).abs() < 1e-9 && (forward[1] - 2900.0).abs() < 1e-9);
    assert!((forward[2] - 2000.0).abs() < 1e-9);
    let starboard: Vec<f64> = at_noon.iter().map(|b| b[1] + 2900.0).collect();
    assert!(starboard[2].abs() < 1e-9);
    assert!(
        (2000.0..2900.0).contains(&starboard[3]),
        "half a day after: {}",
        starboard[3]
    );
    assert!(
        (1500.0..1700.0).contains(&starboard[5]),
        "half returns: {}",
        starboard[5]
    );
    let truth = serde_json::to_value(recorder.truth(&scenario, 1, &ship)).unwrap();
    assert_eq!(truth["epochs"].as_array().unwrap().len(), 4);
    assert_eq!(truth["events"].as_array().unwrap().len(), 2);
    assert!(truth["hours"].as_array().unwrap().len() >= 143);
}

#[test]
fn a_faulty_gyro_leaves_the_satellite_compass_behind() {
    let fault = r#"events = [{ kind = "gyro_fault", from_day = 1, to_day = 2, offset_deg = 5 }]"#;
    let scenario = scenario("", fault);
    let mut ship = ship(&scenario, 2);
    let mut by_day = [Vec::new(), Vec::new(), Vec::new()];
    for differences in &mut by_day {
        sail(&mut ship, 1.0, |_, reading| {
            if let SatelliteReading::Heading(degrees) = reading.satellite {
                differences.push(wrap_180(reading.gyro_deg - degrees));
            }
        });
    }
    assert!(mean(&by_day[0]).abs() < 2.0 && mean(&by_day[2]).abs() < 2.0);
    assert!((mean(&by_day[1]) - 5.0).abs() < 2.0);
}

#[test]
fn a_storm_and_an_anomaly_move_the_compass_but_not_the_truth() {
    let around = "[[storms]]\nday = 0.4\nhours = 6\nstrength_nt = 1500\n";
    let (calm, stormy) = (scenario("", ""), scenario(around, ""));
    let (mut in_calm, mut in_storm) = (ship(&calm, 9), ship(&stormy, 9));
    let mut before: f64 = 0.0;
    let mut during: f64 = 0.0;
    for _ in 0..36_000 {
        let (a, b) = (in_calm.step(2.0), in_storm.step(2.0));
        let hours = a.time.seconds_since(calm.start) / 3600.0;
        let moved = wrap_180(a.compass_deg - b.compass_deg).abs();
        assert!((in_calm.quiet_compass_deg() - in_storm.quiet_compass_deg()).abs() < 1e-9);
        if hours < 9.6 {
            before = before.max(moved);
        } else if hours < 15.6 {
            during = during.max(moved);
        }
    }
    assert!(before < 1e-9, "before the storm {before}");
    assert!(during > 2.0, "in the storm {during}");

    let anomaly = r#"
[[anomalies]]
name = "here"
lat = 45.0
lon = -30.0
radius_nm = 3
field_nt = [0, 3000, 0]
"#;
    let odd = scenario(anomaly, "");
    let (mut plain, mut there) = (ship(&calm, 9), ship(&odd, 9));
    let (a, b) = (plain.step(60.0), there.step(60.0));
    assert!(
        wrap_180(a.compass_deg - b.compass_deg) > 4.0,
        "east field draws the card east"
    );
    assert!((plain.quiet_compass_deg() - there.quiet_compass_deg()).abs() < 1e-9);
}

#[test]
fn every_ship_of_the_demonstration_steers_most_headings() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/demo.toml");
    let scenario = Scenario::read(&path).unwrap();
    assert_eq!(scenario.ships.len(), 8);
    for plan in &scenario.ships {
        let start = scenario.start;
        let mut ship = binnacle_simulator::ship::Ship::new(&scenario, plan, 1, start).unwrap();
        let mut minutes = [0_u32; 24];
        let mut alongside = 0;
        // Coarse steps are enough to see the route.
        for _ in 0..60 * 86_400 / 30 {
            let reading = ship.step(30.0);
            if reading.alongside {
                alongside += 1;
            } else {
                minutes[(reading.heading_deg / 15.0) as usize % 24] += 1;
            }
        }
        let visited = minutes.iter().filter(|&&steps| steps > 40).count();
        assert!(
            visited >= 20,
            "{}: {visited} of 24 sectors {minutes:?}",
            plan.name
        );
        assert!(alongside > 0, "{} comes into port", plan.name);
    }
}

#[test]
fn the_truth_at_the_end_is_a_whole_curve() {
    let scenario = scenario("", "");
    let mut ship = ship(&scenario, 1);
    sail(&mut ship, 0.3, |_, _| {});
    let place = place(&ship);
    assert_eq!(place.rows.len(), 36);
    for row in &place.rows {
        assert!((row.deviation_deg - ship.deviation_deg(row.compass_deg)).abs() < 1e-12);
    }
    // A is nearly the alignment, with the sign of a reading that is too great.
    let rows: Vec<f64> = place.rows.iter().map(|row| row.deviation_deg).collect();
    assert!((mean(&rows) + 0.5).abs() < 0.2, "{}", mean(&rows));
}
