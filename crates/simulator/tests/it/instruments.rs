//! Instruments as real ships have them: off by a large angle, late, coarse, or under a
//! talker of another.

use crate::support::{changed, sail, scenario, sentences, ship};
use binnacle_compass::angle::wrap_180;
use binnacle_simulator::scenario::Scenario;
use binnacle_simulator::ship::{Reading, SatelliteReading};

const SATELLITE: &str = "satellite = {}";
const ALIGNMENT: &str = "alignment_deg = 0.5";

fn readings(scenario: &Scenario) -> Vec<Reading> {
    let mut readings = Vec::new();
    sail(&mut ship(scenario, 5), 0.6, |_, reading| {
        readings.push(*reading);
    });
    readings
}

#[test]
fn a_compass_thirty_degrees_off_reads_thirty_degrees_more() {
    let near = readings(&scenario("", ""));
    let far = readings(&changed(ALIGNMENT, "alignment_deg = 30"));
    for (near, far) in near.iter().zip(&far) {
        let apart = wrap_180(far.compass_deg - near.compass_deg);
        assert!((apart - 29.5).abs() < 1e-9, "{apart}");
    }
}

#[test]
fn coarse_instruments_give_whole_degrees_and_the_others_stay_as_they_were() {
    let fine = readings(&scenario("", ""));
    let coarse = readings(&scenario(
        "",
        "compass = { resolution_deg = 1 }\ngyro = { resolution_deg = 1 }",
    ));
    for (fine, coarse) in fine.iter().zip(&coarse) {
        let off = coarse.compass_deg - fine.compass_deg.round();
        let gyro_off = coarse.gyro_deg - fine.gyro_deg.round();
        assert!(off.abs() + gyro_off.abs() < 1e-12);
        assert_eq!(coarse.satellite, fine.satellite);
    }
}

#[test]
fn a_slow_gyro_lags_in_a_turn_and_agrees_on_a_course() {
    let prompt = readings(&scenario("", ""));
    let slow = readings(&scenario("", "gyro = { lag_s = 30 }"));
    let behind = |such: fn(&Reading) -> bool| {
        let pairs = prompt.iter().zip(&slow).filter(|(prompt, _)| such(prompt));
        let each: Vec<f64> = pairs
            .map(|(prompt, slow)| wrap_180(prompt.gyro_deg - slow.gyro_deg))
            .collect();
        (each.iter().sum::<f64>() / each.len() as f64, each.len())
    };
    let (in_turns, count) = behind(|reading| reading.rate_deg_min > 8.0);
    // Twelve degrees a minute for half a minute, once the turn has lasted.
    assert!(count > 20, "{count}");
    assert!((2.0..7.0).contains(&in_turns), "{in_turns}");
    let (on_courses, count) = behind(|reading| reading.rate_deg_min.abs() < 2.0);
    assert!(count > 1000, "{count}");
    assert!(on_courses.abs() < 0.3, "{on_courses}");
}

#[test]
fn two_sensors_under_one_talker_write_two_sentences_in_turn() {
    let scenario = changed(
        SATELLITE,
        "satellite = { talker = \"HE\", alignment_deg = 20 }",
    );
    let text = sentences(&scenario, 5, 0.2);
    let text = String::from_utf8_lossy(&text);
    assert!(!text.contains("$GPTHS"));
    let headings: Vec<f64> = text
        .lines()
        .filter_map(|line| {
            line.strip_prefix("$HETHS,")?
                .split(',')
                .next()?
                .parse()
                .ok()
        })
        .collect();
    let apart = headings
        .windows(2)
        .map(|pair| wrap_180(pair[1] - pair[0]).abs());
    let swapped = apart.filter(|apart| (apart - 20.0).abs() < 5.0).count();
    assert!(
        swapped * 10 > headings.len() * 8,
        "{swapped} of {}",
        headings.len()
    );
}

#[test]
fn a_satellite_compass_is_gp_by_default() {
    let text = sentences(&scenario("", ""), 5, 0.05);
    let text = String::from_utf8_lossy(&text);
    assert!(text.contains("$GPTHS") && text.contains("$HETHS"));
    let read = readings(&scenario("", ""));
    assert!(
        read.iter()
            .any(|r| matches!(r.satellite, SatelliteReading::Heading(_)))
    );
}
