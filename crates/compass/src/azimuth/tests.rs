//! Known answers and refusals of azimuths.

use super::horizon::{amplitude, centre_altitude_deg};
use super::*;
use crate::angle::wrap_180;
use crate::position::Position;
use crate::time::Timestamp;
use serde_json::{Value, json};

fn at(time: &str) -> Timestamp {
    Timestamp::parse(time).unwrap()
}

fn place(lat: f64, lon: f64) -> Position {
    Position::new(lat, lon).unwrap()
}

/// Bearing and altitude of a body by its Greenwich hour angle and declination, degrees.
fn by_almanac(gha_deg: f64, declination_deg: f64, position: Position) -> (f64, f64) {
    let hour_angle = (gha_deg + position.lon_deg()).to_radians();
    let (lat, declination) = (
        position.lat_deg().to_radians(),
        declination_deg.to_radians(),
    );
    let east = -declination.cos() * hour_angle.sin();
    let north = lat.cos() * declination.sin() - lat.sin() * declination.cos() * hour_angle.cos();
    let up = lat.sin() * declination.sin() + lat.cos() * declination.cos() * hour_angle.cos();
    (east.atan2(north).to_degrees(), up.asin().to_degrees())
}

fn degrees(whole: f64, minutes: f64) -> f64 {
    whole + minutes / 60.0
}

#[test]
fn the_sun_stands_where_the_report_of_nrel_puts_it() {
    // NREL/TP-560-34302, table A5.1: the place without refraction.
    let sun = sun_at(at("2003-10-17T19:30:30Z"), place(39.742_476, -105.1786)).unwrap();
    assert!(
        (sun.bearing.degrees() - 194.340_241).abs() < 1e-4,
        "{sun:?}"
    );
    assert!((sun.altitude_deg - 39.872_046).abs() < 1e-4, "{sun:?}");
    assert!((sun.declination_deg - -9.314_34).abs() < 1e-4, "{sun:?}");
    assert!((sun.distance_au - 0.996_542).abs() < 1e-6, "{sun:?}");
}

#[test]
fn the_sun_stands_where_the_nautical_almanac_puts_it() {
    // Daily pages of The Nautical Almanac: hour, Greenwich hour angle, declination; and places
    // where the sun is up.
    for (time, gha_deg, declination_deg, places) in [
        (
            "2007-12-20T18:00:00Z",
            degrees(90.0, 36.6),
            -degrees(23.0, 25.9),
            [
                (43.4, -93.1),
                (-55.0, -68.0),
                (8.0, -140.0),
                (-12.35, -40.0),
            ],
        ),
        (
            "2008-09-22T10:00:00Z",
            degrees(331.0, 51.4),
            degrees(0.0, 5.6),
            [(18.333, 85.667), (43.4, -3.1), (-34.0, 18.0), (60.0, 5.0)],
        ),
    ] {
        for (lat, lon) in places {
            let position = place(lat, lon);
            let sun = sun_at(at(time), position).unwrap();
            let (bearing_deg, altitude_deg) = by_almanac(gha_deg, declination_deg, position);
            assert!(
                (sun.declination_deg - declination_deg).abs() < 0.002,
                "{time} {sun:?}"
            );
            assert!(
                (sun.altitude_deg - altitude_deg).abs() < 0.01,
                "{time} {sun:?}"
            );
            let apart = wrap_180(sun.bearing.degrees() - bearing_deg);
            assert!(apart.abs() < 0.02, "{time} {lat} {lon}: {apart}");
        }
    }
    // A cadets' exercise with the same page: latitude 18°20′ N, longitude 85°40′ E, S 79.7° W.
    let sun = sun_at(
        at("2008-09-22T10:09:38Z"),
        place(degrees(18.0, 20.0), degrees(85.0, 40.0)),
    );
    assert_eq!(format!("{:.1}", sun.unwrap().bearing.degrees()), "259.8");
}

/// Greenwich hour angle and declination by the formula of low precision of The Astronomical
/// Almanac (page C5), good to 0.01° from 1950 to 2050.
fn low_precision(time: Timestamp) -> (f64, f64) {
    let days = time.micros() as f64 / 86_400e6 - 10_957.5;
    let mean = (280.460 + 0.985_647_4 * days).to_radians();
    let anomaly = (357.528 + 0.985_600_3 * days).to_radians();
    let longitude = mean + (1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
    let obliquity = (23.439 - 0.000_000_4 * days).to_radians();
    let ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    let declination = (obliquity.sin() * longitude.sin()).asin();
    let sidereal_deg = 280.460_618_37 + 360.985_647_366_29 * days;
    (
        sidereal_deg - ascension.to_degrees(),
        declination.to_degrees(),
    )
}

#[test]
fn the_sun_agrees_with_a_low_precision_almanac_from_1950_to_2050() {
    let first = at("1950-01-01T00:00:00Z");
    for step in 0..3_000 {
        // Steps that fall on every hour and season.
        let time = first.plus_seconds(f64::from(step) * 1_051_777.0);
        let position = place(f64::from(step % 141) - 70.0, f64::from(step % 359) - 179.0);
        let sun = sun_at(time, position).unwrap();
        let (gha_deg, declination_deg) = low_precision(time);
        let (bearing_deg, altitude_deg) = by_almanac(gha_deg, declination_deg, position);
        assert!(
            (sun.altitude_deg - altitude_deg).abs() < 0.02,
            "{time} {sun:?}"
        );
        // Near the zenith a small angle in the sky is a large bearing.
        let apart = wrap_180(sun.bearing.degrees() - bearing_deg);
        let in_the_sky = apart * sun.altitude_deg.to_radians().cos();
        assert!(in_the_sky.abs() < 0.02, "{time} {position:?}: {apart}");
    }
}

#[test]
fn an_amplitude_is_the_azimuth_of_the_instant_when_the_sun_is_there() {
    for (time, lat) in [
        ("2026-06-21T00:00:00Z", 43.0),
        ("2026-12-21T00:00:00Z", -55.0),
        ("2026-03-20T00:00:00Z", 0.0),
        ("2026-11-21T00:00:00Z", 60.0),
    ] {
        let position = place(lat, 0.0);
        for sight in [
            HorizonSight::Celestial,
            HorizonSight::UpperLimb,
            HorizonSight::LowerLimb,
            HorizonSight::Centre,
        ] {
            let sun = |hours: f64| sun_at(at(time).plus_seconds(3600.0 * hours), position).unwrap();
            let altitude_deg = centre_altitude_deg(sight, 24.0, sun(6.0).distance_au);
            // Bisection on the rising sun, between midnight and noon.
            let (mut low, mut high) = (0.0, 12.0);
            for _ in 0..50 {
                let middle = f64::midpoint(low, high);
                if sun(middle).altitude_deg < altitude_deg {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let sun = sun(low);
            let found = amplitude(lat, sun.declination_deg, altitude_deg).unwrap();
            let apart = found.from_north_deg - sun.bearing.degrees();
            assert!(apart.abs() < 0.01, "{time} {sight:?}: {apart}");
        }
    }
}

#[test]
fn on_the_celestial_horizon_the_sine_of_the_amplitude_is_sin_d_over_cos_lat() {
    for (lat, declination) in [(14.0, 16.68), (-14.0, 16.68), (51.0, -20.0), (0.0, 23.4)] {
        let found = amplitude(lat, declination, 0.0).unwrap();
        let sine = f64::sin(f64::to_radians(declination)) / f64::cos(f64::to_radians(lat));
        let expected = 90.0 - sine.asin().to_degrees();
        assert!((found.from_north_deg - expected).abs() < 1e-9);
    }
    assert_eq!(amplitude(90.0, 10.0, 0.0), None);
    assert_eq!(amplitude(70.0, 23.4, 0.0), None);
}

#[test]
fn the_visible_horizon_lies_below_by_dip_refraction_and_half_the_sun() {
    // 1.76′ √25 = 8.8′, 34′ and 16.0′.
    let arc_minutes = |sight| 60.0 * centre_altitude_deg(sight, 25.0, 1.0);
    assert!((arc_minutes(HorizonSight::Centre) - -42.8).abs() < 0.01);
    assert!((arc_minutes(HorizonSight::UpperLimb) - -58.79).abs() < 0.01);
    assert!((arc_minutes(HorizonSight::LowerLimb) - -26.81).abs() < 0.01);
    assert!(arc_minutes(HorizonSight::Celestial).abs() < 1e-12);
}

/// Sun by azimuth on the Bay of Biscay, in the forenoon.
fn sun() -> Value {
    json!({
        "time": "2026-11-21T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
        "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "gyro_heading_deg": 94.0,
    })
}

fn changed(base: &Value, changes: &Value) -> Value {
    let mut form = base.clone();
    for (name, value) in changes.as_object().unwrap() {
        form[name] = value.clone();
    }
    form
}

fn read(base: &Value, changes: &Value) -> Result<Azimuth, AzimuthError> {
    let form: AzimuthForm = serde_json::from_value(changed(base, changes)).unwrap();
    Azimuth::new(form)
}

#[test]
fn compass_error_and_gyro_error_follow_from_one_bearing_of_the_sun() {
    let azimuth = read(&sun(), &json!({})).unwrap();
    let result = azimuth.result();
    let expected = sun_at(azimuth.time(), azimuth.position()).unwrap();
    assert_eq!(result.true_bearing_deg, expected.bearing);
    let error = result.compass_error_deg.degrees_east();
    assert!((error - (expected.bearing.degrees() - 150.0)).abs() < 1e-9);
    let deviation = result.deviation_deg.degrees_east();
    assert!((deviation + result.variation_deg.degrees_east() - error).abs() < 1e-9);
    let gyro = result.gyro_error_deg.unwrap().degrees_east();
    assert!((gyro - (92.0 + error - 94.0)).abs() < 1e-9);
    assert!((result.true_heading_deg.degrees() - (92.0 + error)).abs() < 1e-9);
    assert!(result.cautions.is_empty());
    assert_eq!(
        read(&sun(), &json!({ "gyro_heading_deg": null }))
            .unwrap()
            .result()
            .gyro_error_deg,
        None
    );
}

#[test]
fn a_bearing_by_gyro_finds_the_compass_error_by_the_heading() {
    // Amplitude worked on a navigators' list: 6 May 2008, 08:30 UTC, latitude 14° N, declination
    // 16°41′ N, the setting sun 288.0° by gyro; gyro heading 208°, compass heading 207°.
    // The bearing is 287.2°: gyro error 0.8° W, compass error 0.2° E.
    let form = json!({
        "time": "2008-05-06T08:30:00Z", "lat": 14.0, "lon": 146.5, "kind": "sun_amplitude",
        "horizon": "celestial", "compass_heading_deg": 207.0,
        "gyro_heading_deg": 208.0, "gyro_bearing_deg": 288.0,
    });
    let azimuth = read(&form, &json!({})).unwrap();
    let result = azimuth.result();
    assert_eq!(format!("{:.1}", result.true_bearing_deg.degrees()), "287.2");
    assert_eq!(result.gyro_error_deg.unwrap().to_string(), "0.8° W");
    assert_eq!(result.compass_error_deg.to_string(), "0.2° E");
}

#[test]
fn the_gyros_own_bearing_decides_its_error() {
    let both = json!({ "gyro_bearing_deg": 151.5 });
    let result = read(&sun(), &both).unwrap().result().clone();
    let expected = result.true_bearing_deg.degrees() - 151.5;
    assert!((result.gyro_error_deg.unwrap().degrees_east() - expected).abs() < 1e-9);
}

fn vega() -> Value {
    json!({
        "time": "2026-11-21T20:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "body", "name": "Vega",
        "true_bearing_deg": 300.0, "altitude_deg": 35.0, "compass_heading_deg": 92.0,
        "compass_bearing_deg": 298.0,
    })
}

fn quay() -> Value {
    json!({
        "time": "2026-11-21T20:00:00Z", "lat": 43.35, "lon": -3.05, "kind": "quay",
        "name": "Muelle A3", "true_bearing_deg": 95.0, "compass_heading_deg": 93.0,
        "gyro_heading_deg": 94.2,
    })
}

#[test]
fn a_quay_checks_the_gyro_and_warns_of_the_compass() {
    let azimuth = read(&quay(), &json!({})).unwrap();
    let result = azimuth.result();
    assert!((result.compass_error_deg.degrees_east() - 2.0).abs() < 1e-9);
    assert!((result.gyro_error_deg.unwrap().degrees_east() - 0.8).abs() < 1e-9);
    assert_eq!(result.cautions, [AzimuthCaution::Alongside]);
}

#[test]
fn a_high_body_has_a_larger_error_and_a_caution() {
    let at_altitude = |altitude_deg: f64| {
        let changes = json!({ "altitude_deg": altitude_deg });
        read(&vega(), &changes).unwrap().result().clone()
    };
    assert!(at_altitude(40.0).cautions.is_empty());
    assert_eq!(at_altitude(50.0).cautions, [AzimuthCaution::HighAltitude]);
    assert!(at_altitude(70.0).standard_error_deg > 2.0 * at_altitude(10.0).standard_error_deg);
}

#[test]
fn the_sun_in_high_latitudes_depends_on_the_refraction() {
    let amplitude = |lat: f64, time: &str| {
        let form = json!({
            "time": time, "lat": lat, "lon": 0.0, "kind": "sun_amplitude",
            "horizon": "upper_limb", "height_of_eye_m": 20.0, "compass_heading_deg": 10.0,
            "compass_bearing_deg": 10.0, "confirmed": true,
        });
        read(&form, &json!({})).map(|azimuth| azimuth.result().clone())
    };
    let high = amplitude(64.0, "2026-06-21T01:00:00Z").unwrap();
    assert_eq!(high.cautions, [AzimuthCaution::GrazingHorizon]);
    let never = amplitude(75.0, "2026-06-21T00:00:00Z").unwrap_err();
    assert_eq!(
        (never.field, never.problem),
        ("lat", AzimuthProblem::NeverOnHorizon)
    );
}

#[test]
fn an_impossible_observation_is_refused_by_field() {
    for (field, base, changes) in [
        ("time", sun(), json!({ "time": "2026-11-21T22:00:00Z" })),
        ("time", sun(), json!({ "time": "1810-11-21T10:00:00Z" })),
        (
            "time",
            sun(),
            json!({ "kind": "sun_amplitude", "horizon": "celestial" }),
        ),
        ("lat", sun(), json!({ "lat": 95.0 })),
        ("lon", sun(), json!({ "lon": 185.0 })),
        (
            "compass_heading_deg",
            sun(),
            json!({ "compass_heading_deg": 361.0 }),
        ),
        (
            "compass_bearing_deg",
            sun(),
            json!({ "compass_bearing_deg": -1.0 }),
        ),
        (
            "compass_bearing_deg",
            sun(),
            json!({ "compass_bearing_deg": null }),
        ),
        (
            "gyro_heading_deg",
            sun(),
            json!({ "gyro_heading_deg": 400.0 }),
        ),
        (
            "gyro_heading_deg",
            sun(),
            json!({ "compass_bearing_deg": null, "gyro_heading_deg": null, "gyro_bearing_deg": 9.0 }),
        ),
        ("horizon", sun(), json!({ "horizon": "centre" })),
        ("horizon", sun(), json!({ "kind": "sun_amplitude" })),
        (
            "height_of_eye_m",
            sun(),
            json!({ "kind": "sun_amplitude", "horizon": "upper_limb" }),
        ),
        (
            "height_of_eye_m",
            sun(),
            json!({ "kind": "sun_amplitude", "horizon": "centre", "height_of_eye_m": 101.0 }),
        ),
        (
            "true_bearing_deg",
            sun(),
            json!({ "true_bearing_deg": 152.0 }),
        ),
        (
            "true_bearing_deg",
            vega(),
            json!({ "true_bearing_deg": null }),
        ),
        (
            "true_bearing_deg",
            vega(),
            json!({ "true_bearing_deg": 360.5 }),
        ),
        ("name", vega(), json!({ "name": " " })),
        ("altitude_deg", vega(), json!({ "altitude_deg": 91.0 })),
        ("altitude_deg", quay(), json!({ "altitude_deg": 5.0 })),
        (
            "compass_bearing_deg",
            quay(),
            json!({ "compass_bearing_deg": 93.0 }),
        ),
    ] {
        let confirmed = changed(&changes, &json!({ "confirmed": true }));
        let error = read(&base, &confirmed).unwrap_err();
        assert_eq!(error.field, field, "{changes}: {error}");
        assert!(!error.is_question());
    }
}

#[test]
fn an_unlikely_observation_is_questioned_and_accepted_once_confirmed() {
    for (base, changes, part) in [
        // The compass's own bearing typed as the true one.
        (
            vega(),
            json!({ "true_bearing_deg": 298.0 }),
            "the compass's own, 298.0°, to the last digit",
        ),
        // The gyro's, beside that of the compass and alone.
        (
            vega(),
            json!({ "gyro_bearing_deg": 301.3, "true_bearing_deg": 301.3 }),
            "the gyro's own, 301.3°, to the last digit",
        ),
        (
            vega(),
            json!({
                "compass_bearing_deg": null, "gyro_bearing_deg": 301.3, "gyro_heading_deg": 95.0,
                "true_bearing_deg": 301.3,
            }),
            "the gyro's own, 301.3°, to the last digit",
        ),
        (
            quay(),
            json!({ "true_bearing_deg": 93.0 }),
            "to the last digit",
        ),
        // A slip of the pen, or a longitude of the wrong side.
        (vega(), json!({ "true_bearing_deg": 200.0 }), "deviation of"),
        (sun(), json!({ "lon": 43.1 }), "deviation of"),
        (sun(), json!({ "gyro_heading_deg": 120.0 }), "gyro error of"),
        (
            sun(),
            json!({ "gyro_bearing_deg": 157.0 }),
            "angle from the bow",
        ),
    ] {
        let error = read(&base, &changes).unwrap_err();
        assert!(error.is_question() && error.field == "confirmed", "{error}");
        assert!(error.to_string().contains(part), "{error}");
        let confirmed = changed(&changes, &json!({ "confirmed": true }));
        assert!(read(&base, &confirmed).is_ok(), "{changes}");
    }
}

#[test]
fn the_sun_is_seen_a_little_below_the_horizon_and_no_further() {
    let position = place(43.4, -3.1);
    let rise = (0..1440)
        .map(|minute| at("2026-11-21T00:00:00Z").plus_seconds(60.0 * f64::from(minute)))
        .find(|time| sun_at(*time, position).unwrap().altitude_deg > -1.5)
        .unwrap();
    let seen =
        |time: Timestamp| read(&sun(), &json!({ "time": time, "confirmed": true })).map(|_| ());
    assert_eq!(seen(rise), Ok(()));
    assert_eq!(seen(rise.plus_seconds(-60.0)).unwrap_err().field, "time");
}

#[test]
fn a_checked_observation_is_its_form_in_json() {
    let azimuth = read(&sun(), &json!({})).unwrap();
    let text = serde_json::to_string(&azimuth).unwrap();
    assert_eq!(serde_json::from_str::<Azimuth>(&text).unwrap(), azimuth);
    let wrong = changed(&sun(), &json!({ "lat": 95.0 }));
    let error = serde_json::from_value::<Azimuth>(wrong).unwrap_err();
    assert!(error.to_string().starts_with("lat: "), "{error}");
    let undated = changed(&sun(), &json!({ "time": "2026-11-21" }));
    let error = serde_json::from_value::<AzimuthForm>(undated).unwrap_err();
    assert!(error.to_string().contains("has no time of day"), "{error}");
}
