//! The sentences on the line are those of real instruments.

use crate::support::{scenario, sentences, ship};
use binnacle_compass::angle::wrap_180;
use binnacle_nmea::sentence::Data;
use binnacle_nmea::{Rejected, parse};
use binnacle_simulator::nmea::Talker;
use binnacle_simulator::ship::SatelliteReading;

const CLEAN: &str = "wrong_checksum_rate = 0\ngarbage_rate = 0";

fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let lines = bytes
        .split(|&byte| byte == b'\n')
        .filter(|line| !line.is_empty());
    lines.map(|line| line.strip_suffix(b"\r").unwrap_or(line))
}

#[test]
fn every_sentence_is_read_back_as_it_was_meant() {
    let scenario = scenario(CLEAN, "");
    let mut talker = Talker::new(&scenario, ship(&scenario, 2), 2);
    let mut kinds = std::collections::BTreeSet::new();
    let near = |found: f64, meant: f64| {
        assert!(wrap_180(found - meant).abs() < 0.051, "{found} for {meant}");
    };
    let mut out = Vec::new();
    for _ in 0..50_000 {
        out.clear();
        let meant = talker.write_group(&mut out);
        for line in lines(&out) {
            let text = String::from_utf8_lossy(line);
            let sentence = parse(line).unwrap_or_else(|error| panic!("{text}: {error:?}"));
            kinds.insert((sentence.talker, text[3..6].to_owned()));
            match sentence.data {
                Data::Hdg(hdg) => {
                    near(hdg.reading_deg.unwrap(), meant.compass_deg);
                    assert_eq!(
                        (hdg.deviation_deg_east, hdg.variation_deg_east),
                        (None, None)
                    );
                }
                Data::Ths(ths) if &sentence.talker == b"HE" => {
                    near(ths.valid_heading_deg_true().unwrap(), meant.gyro_deg);
                }
                Data::Ths(ths) => match meant.satellite {
                    SatelliteReading::Heading(degrees) => {
                        near(ths.valid_heading_deg_true().unwrap(), degrees);
                    }
                    _ => assert_eq!(ths.valid_heading_deg_true(), None),
                },
                Data::Rmc(rmc) => {
                    let rmc = rmc.expect("the fix is valid");
                    let at = rmc.position.expect("a fix has a position");
                    assert!((at.lat_deg_north - meant.position.lat_deg()).abs() < 1e-6);
                    assert!((at.lon_deg_east - meant.position.lon_deg()).abs() < 1e-6);
                }
                Data::Rot(rot) => {
                    let rate = rot.rate_deg_min_starboard.unwrap();
                    assert!((rate - meant.rate_deg_min).abs() < 0.051);
                }
                Data::Xdr(_) | Data::Zda(_) => {}
                other => panic!("unexpected {other:?}"),
            }
        }
    }
    assert_eq!(kinds.len(), 7, "{kinds:?}");
}

#[test]
fn damaged_sentences_and_noise_have_the_given_rates_and_are_never_read() {
    let scenario = scenario("wrong_checksum_rate = 0.01\ngarbage_rate = 0.005", "");
    let bytes = sentences(&scenario, 3, 1.0);
    let (mut read, mut checksums, mut other) = (0_u32, 0_u32, 0_u32);
    for line in lines(&bytes) {
        match parse(line) {
            Ok(_) => read += 1,
            Err(Rejected::WrongChecksum) => checksums += 1,
            Err(_) => other += 1,
        }
    }
    let share = |count: u32| f64::from(count) / f64::from(read);
    assert!(
        (0.006..0.014).contains(&share(checksums)),
        "{checksums} of {read}"
    );
    assert!((0.003..0.008).contains(&share(other)), "{other} of {read}");
}

#[test]
fn in_port_the_instruments_speak_once_a_minute() {
    let scenario = scenario(CLEAN, "");
    let mut talker = Talker::new(&scenario, ship(&scenario, 2), 2);
    let mut out = Vec::new();
    let mut steps = std::collections::BTreeSet::new();
    for _ in 0..20_000 {
        let (before, alongside) = (talker.ship().time(), talker.ship().is_alongside());
        talker.write_group(&mut out);
        let step = talker.ship().time().seconds_since(before).round() as u32;
        steps.insert((alongside, step));
    }
    assert!(
        steps.contains(&(false, 2)) && steps.contains(&(true, 60)),
        "{steps:?}"
    );
    assert_eq!(steps.len(), 2, "{steps:?}");
}
