//! Sources and the roles in which they serve.

use super::*;
use Signal::{Gyro, Satellite, SatelliteInvalid, Time};
use serde::Deserialize;

/// The part of the configuration that is about instruments.
#[derive(Deserialize)]
struct Settings {
    roles: RolesConfig,
    #[serde(default)]
    silence: SilenceConfig,
}

fn roles(toml: &str) -> Roles {
    let settings: Settings = toml::from_str(&format!("[roles]\n{toml}")).unwrap();
    Roles::new(&settings.roles, &settings.silence)
}

fn seen(input: &str, id: &str, reading: Reading) -> Observation {
    let id = id.as_bytes();
    let source = Source::of_sentence(input.into(), [id[0], id[1]], [id[2], id[3], id[4]]);
    Observation::now(source, reading)
}

fn reference(degrees: f64, source: &str) -> ReferenceHeading {
    ReferenceHeading {
        heading: TrueHeading::new(degrees).unwrap(),
        source: SourceId::from_name(source),
    }
}

fn heading(degrees: f64) -> Reading {
    Reading::True(TrueHeading::new(degrees).unwrap())
}

fn fix(seconds: i64) -> Reading {
    Reading::Fix {
        position: Position::new(43.0, -3.0).unwrap(),
        time: Some(at(seconds)),
        sog_kn: Some(12.0),
    }
}

fn at(seconds: i64) -> Timestamp {
    Timestamp::from_micros((1_700_000_000 + seconds) * 1_000_000).unwrap()
}

const TWO_GYROS: &str = r#"
gyro = [{ input = "a", talker = "HE", sentence = "THS" }, { input = "b", sentence = "HDT" }]
satellite = [{ input = "a", talker = "GP" }]
position = [{ input = "a", talker = "GP", sentence = "RMC" }]
"#;

fn first(roles: &mut Roles, observation: &Observation) -> Option<Signal> {
    roles.observe(observation, Instant::now(), Duration::ZERO, Trust::Trusted)[0]
}

#[test]
fn the_second_gyro_serves_while_the_first_is_silent() {
    let mut roles = roles(TWO_GYROS);
    let (main, spare) = (
        seen("a", "HETHS", heading(10.0)),
        seen("b", "HEHDT", heading(11.0)),
    );
    let gyro = |degrees, source| Some(Gyro(reference(degrees, source)));
    first(&mut roles, &seen("a", "GPRMC", fix(0)));
    assert_eq!(first(&mut roles, &main), gyro(10.0, "a HE THS"));
    assert_eq!(first(&mut roles, &spare), None);
    first(&mut roles, &seen("a", "GPRMC", fix(16)));
    // It may be a repeater of the first: once it has moved by itself it is not.
    assert_eq!(first(&mut roles, &spare), None);
    let problems = roles.problems(Instant::now(), Duration::from_mins(1));
    assert!(
        problems[0].starts_with("gyro: b HEHDT has not moved"),
        "{problems:?}"
    );
    for degrees in [11.1, 11.0] {
        let moved = seen("b", "HEHDT", heading(degrees));
        assert_eq!(first(&mut roles, &moved), None);
    }
    let moved = seen("b", "HEHDT", heading(11.1));
    assert_eq!(first(&mut roles, &moved), gyro(11.1, "b HDT"));
    assert_eq!(first(&mut roles, &spare), gyro(11.0, "b HDT"));
    let problems = roles.problems(Instant::now(), Duration::from_mins(1));
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(first(&mut roles, &main), gyro(10.0, "a HE THS"));
    assert_eq!(first(&mut roles, &spare), None);
}

#[test]
fn an_invalid_satellite_compass_is_distinguished_from_a_gyro() {
    let mut roles = roles(TWO_GYROS);
    let valid = seen("a", "GPTHS", heading(10.0));
    assert_eq!(
        first(&mut roles, &valid),
        Some(Satellite(reference(10.0, "a GP")))
    );
    let lost = seen("a", "GPTHS", Reading::TrueNotValid);
    assert_eq!(first(&mut roles, &lost), Some(SatelliteInvalid));
}

#[test]
fn an_invalid_source_makes_way_at_once() {
    let mut roles = roles(TWO_GYROS);
    first(&mut roles, &seen("a", "GPRMC", fix(0)));
    first(&mut roles, &seen("a", "HETHS", heading(10.0)));
    first(&mut roles, &seen("a", "HETHS", Reading::TrueNotValid));
    let spare = [11.0, 11.1, 11.0, 11.1].map(|degrees| {
        let spare = seen("b", "HEHDT", heading(degrees));
        first(&mut roles, &spare).is_some()
    });
    assert_eq!(spare, [false, false, false, true]);
}

#[test]
fn a_source_without_a_role_means_nothing() {
    let mut roles = roles(TWO_GYROS);
    assert_eq!(first(&mut roles, &seen("b", "GPRMC", fix(0))), None);
    assert_eq!(first(&mut roles, &seen("b", "HETHS", heading(1.0))), None);
    assert_eq!(
        first(&mut roles, &seen("a", "GPZDA", Reading::Time(at(0)))),
        Some(Time(at(0)))
    );
    assert_eq!(
        first(&mut roles, &seen("b", "GPZDA", Reading::Time(at(1)))),
        None
    );
}

#[test]
fn a_course_comes_from_the_receiver_whose_position_is_used() {
    let mut roles = roles(TWO_GYROS);
    let course = CourseOverGround::new(91.0).unwrap();
    first(&mut roles, &seen("a", "GPRMC", fix(0)));
    let of = |input, id| seen(input, id, Reading::Course(course));
    assert_eq!(
        first(&mut roles, &of("a", "GPVTG")),
        Some(Signal::Course(course))
    );
    assert_eq!(first(&mut roles, &of("b", "GPVTG")), None);
}

#[test]
fn a_temperature_comes_from_its_role_alone() {
    let warm = |id| seen("a", id, Reading::Temperature { celsius: 21.5 });
    assert_eq!(first(&mut roles(TWO_GYROS), &warm("WIMTA")), None);
    let mut roles = roles(r#"temperature = [{ input = "a", sentence = "MTA" }]"#);
    assert_eq!(
        first(&mut roles, &warm("WIMTA")),
        Some(Signal::Temperature(21.5))
    );
    assert_eq!(first(&mut roles, &warm("WIXDR")), None);
}

#[test]
fn the_agents_own_output_is_no_compass_and_no_gyro() {
    let mut roles = roles(
        r#"
compass = [{ input = "a", sentence = "HDG" }]
gyro = [{ input = "a" }]
"#,
    );
    let compass = |id| {
        let raw = CompassHeading::new(7.0).unwrap();
        let (deviation, variation) = (None, None);
        let reading = Reading::Compass {
            raw,
            deviation,
            variation,
        };
        seen("a", id, reading)
    };
    assert!(first(&mut roles, &compass("HCHDG")).is_some());
    assert!(first(&mut roles, &seen("a", "HETHS", heading(7.0))).is_some());
    assert_eq!(first(&mut roles, &compass("IIHDG")), None);
    let echo = seen("a", "IITHS", Reading::TrueNotValid);
    assert_eq!(first(&mut roles, &echo), None);
    let mut roles = super::tests::roles("gyro = [{ input = \"a\" }]");
    assert!(first(&mut roles, &seen("a", "IIHDT", heading(7.0))).is_some());
}

#[test]
fn a_magnetic_heading_is_the_compass_only_when_it_is_raw() {
    let hdm = seen(
        "a",
        "HCHDM",
        Reading::Magnetic {
            heading: binnacle_compass::angle::MagneticHeading::new(7.0).unwrap(),
            deviation: None,
            variation: None,
        },
    );
    let mut plain = roles(r#"compass = [{ input = "a", talker = "HC" }]"#);
    assert_eq!(first(&mut plain, &hdm), None);
    let mut raw = roles(r#"compass = [{ input = "a", sentence = "HDM", raw = true }]"#);
    assert!(first(&mut raw, &hdm).is_some());
}

/// An observation of a Signal K source.
fn signalk(source: &str, sentence: [u8; 3], reading: Reading) -> Observation {
    let mut from = Source::of_sentence("a".into(), *b"SK", sentence);
    from.signalk = Some(source.into());
    Observation::now(from, reading)
}

fn raw(degrees: f64) -> Reading {
    Reading::Compass {
        raw: CompassHeading::new(degrees).unwrap(),
        deviation: None,
        variation: None,
    }
}

#[test]
fn a_source_is_selected_by_any_of_its_names() {
    let named = |change: fn(&mut Source)| {
        let mut source = Source::of_sentence("a".into(), *b"HE", *b"HDT");
        change(&mut source);
        Observation::now(source, heading(7.0))
    };
    for (key, change) in [
        (
            "source = \"n2k.4\"",
            (|s| s.signalk = Some("n2k.4".into())) as fn(&mut Source),
        ),
        ("sfi = \"HE0001\"", |s| s.sfi = Some("HE0001".into())),
        ("sender = \"10.0.0.2\"", |s| {
            s.sender = Some("10.0.0.2".parse().unwrap());
        }),
        ("n2k_address = 4", |s| {
            s.n2k_address = binnacle_nmea::n2k::Address::new(4);
        }),
        ("n2k_name = \"c0788c00e7e04312\"", |s| {
            s.n2k_name = binnacle_nmea::n2k::Name::parse("c0788c00e7e04312");
        }),
    ] {
        let mut roles = roles(&format!("gyro = [{{ {key} }}]"));
        assert_eq!(first(&mut roles, &named(|_| {})), None, "{key}");
        let found = first(&mut roles, &named(change));
        assert!(matches!(found, Some(Gyro(_))), "{key}: {found:?}");
    }
}

#[test]
fn a_true_heading_of_the_compasss_own_device_is_no_reference() {
    let mut roles = roles(
        r#"
compass = [{ source = "n2k.4" }]
satellite = [{ input = "a", sentence = "HDT" }]
"#,
    );
    assert!(first(&mut roles, &signalk("n2k.4", *b"HDG", raw(7.0))).is_some());
    let own = first(&mut roles, &signalk("n2k.4", *b"HDT", heading(5.0)));
    let refused = Signal::Refused(Instrument::Satellite, Refusal::NotIndependent);
    assert_eq!(own, Some(refused));
    let problems = roles.problems(Instant::now(), Duration::from_mins(1));
    assert!(
        problems[0].starts_with("satellite: a n2k.4 HDT"),
        "{problems:?}"
    );
    // Another device serves in its place.
    let other = signalk("n2k.9", *b"HDT", heading(6.0));
    assert!(matches!(first(&mut roles, &other), Some(Satellite(_))));
    let own = first(&mut roles, &signalk("n2k.4", *b"HDT", heading(5.0)));
    assert_eq!(own, None);
}

#[test]
fn of_two_devices_under_one_selection_one_serves_and_both_are_named() {
    let mut roles = roles(r#"compass = [{ input = "a", sentence = "HDG" }]"#);
    first(&mut roles, &seen("a", "GPRMC", fix(0)));
    assert!(first(&mut roles, &seen("a", "HCHDG", raw(205.5))).is_some());
    assert_eq!(first(&mut roles, &seen("a", "HNHDG", raw(207.0))), None);
    assert!(first(&mut roles, &seen("a", "HCHDG", raw(205.5))).is_some());
    let problems = roles.problems(Instant::now(), Duration::from_mins(1));
    assert_eq!(
        problems,
        ["compass: both a HCHDG and a HNHDG match one selection: a HCHDG is used"]
    );
}

#[test]
fn a_device_in_use_that_stands_still_once_the_other_one_is_silent_may_be_its_repeater() {
    let mut roles = roles(
        r#"
compass = [{ input = "a", sentence = "HDG" }]
position = [{ input = "a" }]
"#,
    );
    let mut hear = |second, id, degrees| {
        first(&mut roles, &seen("a", "GPRMC", fix(second)));
        first(&mut roles, &seen("a", id, raw(degrees)))
    };
    hear(0, "SDHDG", 205.5);
    assert!(hear(0, "ECHDG", 205.5).is_some());
    // It comes late, and settles.
    for (second, degrees) in [(1, 205.6), (2, 205.5), (3, 205.6), (8, 205.7), (15, 205.7)] {
        assert!(hear(second, "ECHDG", degrees).is_some(), "{second}");
    }
    assert_eq!(hear(16, "ECHDG", 205.7), None);
    assert_eq!(hear(17, "ECHDG", 205.6), None);
    assert_eq!(hear(18, "ECHDG", 205.7), None);
    assert!(hear(19, "ECHDG", 205.6).is_some());
    assert!(hear(40, "ECHDG", 205.7).is_some());
}

#[test]
fn of_all_devices_the_one_with_the_talker_of_a_compass_is_used() {
    let mut roles = roles(r#"compass = [{ input = "a", sentence = "HDG" }]"#);
    first(&mut roles, &seen("a", "ECHDG", raw(205.5)));
    first(&mut roles, &seen("a", "HCHDG", raw(205.5)));
    let used = first(&mut roles, &seen("a", "HCHDG", raw(205.5)));
    assert!(matches!(used, Some(Signal::Compass(_))));
    assert_eq!(first(&mut roles, &seen("a", "ECHDG", raw(205.5))), None);
}

#[test]
fn the_device_in_use_does_not_depend_on_which_is_heard_first() {
    let mut roles = roles(r#"compass = [{ input = "a", sentence = "HDG" }]"#);
    assert!(first(&mut roles, &seen("a", "HNHDG", raw(207.0))).is_some());
    // The change spoils its window: two compasses do not mix.
    let change = Signal::Refused(Instrument::Compass, Refusal::TwoSensors);
    let taken = first(&mut roles, &seen("a", "HCHDG", raw(205.5)));
    assert_eq!(taken, Some(change));
    assert_eq!(first(&mut roles, &seen("a", "HNHDG", raw(207.0))), None);
    let used = first(&mut roles, &seen("a", "HCHDG", raw(205.5)));
    assert!(matches!(used, Some(Signal::Compass(_))));
}

#[test]
fn two_sensors_behind_one_talker_are_named_and_neither_is_used() {
    let mut roles = roles(r#"compass = [{ input = "a", sentence = "HDG" }]"#);
    let mut last = None;
    for reading in 0..200 {
        let degrees = if reading % 2 == 0 { 205.48 } else { 207.0 };
        last = first(&mut roles, &seen("a", "HCHDG", raw(degrees)));
    }
    let refused = Signal::Refused(Instrument::Compass, Refusal::TwoSensors);
    assert_eq!(last, Some(refused));
    let problems = roles.problems(Instant::now(), Duration::from_mins(1));
    assert_eq!(
        problems,
        ["compass: two sensors 1.5° apart send as a HCHDG: neither is used"]
    );
}

#[test]
fn an_old_reading_does_not_serve() {
    let mut roles = roles(r#"compass = [{ input = "a", sentence = "HDG" }]"#);
    let compass = seen("a", "HCHDG", raw(205.5));
    let mut at_age = |seconds| {
        let age = Duration::from_secs(seconds);
        roles.observe(&compass, Instant::now(), age, Trust::Trusted)[0]
    };
    assert_eq!(at_age(16), None);
    assert!(at_age(14).is_some());
}

#[test]
fn a_raw_heading_that_a_server_calls_magnetic_is_the_compass_in_one_line() {
    let line = r#"compass = [{ source = "serial.HC", sentence = "HDM", raw = true }]"#;
    let mut roles = roles(line);
    let magnetic = Reading::Magnetic {
        heading: binnacle_compass::angle::MagneticHeading::new(7.0).unwrap(),
        deviation: None,
        variation: None,
    };
    let found = first(&mut roles, &signalk("serial.HC", *b"HDM", magnetic));
    assert_eq!(found, CompassHeading::new(7.0).map(Signal::Compass));
    assert_eq!(
        first(&mut roles, &signalk("n2k.4", *b"HDM", magnetic)),
        None
    );
}
