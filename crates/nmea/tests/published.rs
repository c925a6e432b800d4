//! Sentences as printed in manuals and handbooks, and the meaning of each
//! letter.

use binnacle_nmea::alert::{AlertCommand, AlertId};
use binnacle_nmea::sentence::{
    Acn, Gga, Hbt, Hdg, Mta, Position, Rot, Ths, ThsMode, Vhw, Vtg, Xdr,
};
use binnacle_nmea::time::{Date, TimeOfDay};
use binnacle_nmea::{Data, Kind, Rejected, Sentence, parse};

/// Adds the checksum to the body between `$` and `*`.
fn line(body: &str) -> Vec<u8> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

fn data(body: &str) -> Data {
    parse(&line(body))
        .unwrap_or_else(|e| panic!("{body}: {e}"))
        .data
}

fn position(lat_deg_north: f64, lon_deg_east: f64) -> Position {
    Position {
        lat_deg_north,
        lon_deg_east,
    }
}

fn near(found: Option<Position>, lat: f64, lon: f64) {
    let found = found.expect("a position");
    assert!((found.lat_deg_north - lat).abs() < 1e-9, "{found:?}");
    assert!((found.lon_deg_east - lon).abs() < 1e-9, "{found:?}");
}

/// The checksums are those printed in the sources (gpsd's "NMEA Revealed",
/// u-blox and Garmin manuals), not computed by this crate.
#[test]
fn printed_sentences_with_their_printed_checksums_are_read() {
    let Data::Rmc(Some(rmc)) =
        parse(b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A")
            .unwrap()
            .data
    else {
        panic!()
    };
    near(rmc.position, 48.0 + 7.038 / 60.0, 11.0 + 31.0 / 60.0);
    assert_eq!(rmc.time, TimeOfDay::new(12, 35, 19, 0));
    assert_eq!(rmc.date, Date::new(1994, 3, 23));
    assert_eq!(rmc.sog_kn, Some(22.4));
    assert_eq!(rmc.cog_deg_true, Some(84.4));
    assert_eq!(rmc.variation_deg_east, Some(-3.1));
    assert_eq!(rmc.unix_micros(), Some(764_426_119_000_000));

    let Data::Gga(Some(gga)) =
        parse(b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47")
            .unwrap()
            .data
    else {
        panic!()
    };
    assert_eq!(
        gga,
        Gga {
            time: TimeOfDay::new(12, 35, 19, 0),
            position: Some(position(48.1173, 11.516_666_666_666_667)),
            quality: 1,
            satellites: Some(8),
            hdop: Some(0.9),
            altitude_m: Some(545.4),
            geoid_separation_m: Some(46.9),
        }
    );

    let Data::Gll(Some(gll)) = parse(b"$GPGLL,4916.45,N,12311.12,W,225444,A,*1D")
        .unwrap()
        .data
    else {
        panic!()
    };
    near(gll.position, 49.0 + 16.45 / 60.0, -(123.0 + 11.12 / 60.0));

    let Data::Zda(zda) = parse(b"$GPZDA,160012.71,11,03,2004,-1,00*7D").unwrap().data else {
        panic!()
    };
    assert_eq!(zda.date, Date::new(2004, 3, 11));
    assert_eq!(zda.time, TimeOfDay::new(16, 0, 12, 710_000));

    let vtg = parse(b"$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48")
        .unwrap()
        .data;
    assert_eq!(
        vtg,
        Data::Vtg(Some(Vtg {
            cog_deg_true: Some(54.7),
            cog_deg_magnetic: Some(34.4),
            sog_kn: Some(5.5)
        }))
    );

    let hdg = parse(b"$HCHDG,98.3,0.0,E,12.6,W*57").unwrap();
    assert_eq!(
        hdg,
        Sentence {
            talker: *b"HC",
            data: Data::Hdg(Hdg {
                reading_deg: Some(98.3),
                deviation_deg_east: Some(0.0),
                variation_deg_east: Some(-12.6)
            })
        }
    );
    assert_eq!(
        parse(b"$HCHDG,101.1,,,7.1,W*3C").unwrap().data,
        Data::Hdg(Hdg {
            reading_deg: Some(101.1),
            deviation_deg_east: None,
            variation_deg_east: Some(-7.1)
        })
    );
    assert!(
        matches!(parse(b"$GPHDT,274.07,T*03").unwrap().data, Data::Hdt(hdt)
        if hdt.heading_deg_true == Some(274.07))
    );
}

#[test]
fn east_is_positive_on_every_heading_sentence() {
    for (letters, deviation, variation) in [
        (["E", "E"], 3.0, 20.0),
        (["E", "W"], 3.0, -20.0),
        (["W", "E"], -3.0, 20.0),
        (["W", "W"], -3.0, -20.0),
    ] {
        for (reading, expected) in [("0", 0.0), ("359.9", 359.9), ("360", 0.0), ("180.0", 180.0)] {
            let [d, v] = letters;
            assert_eq!(
                data(&format!("HCHDG,{reading},3.0,{d},20.0,{v}")),
                Data::Hdg(Hdg {
                    reading_deg: Some(expected),
                    deviation_deg_east: Some(deviation),
                    variation_deg_east: Some(variation),
                })
            );
        }
    }
}

#[test]
fn north_and_east_are_positive_up_to_the_poles_and_the_antimeridian() {
    for (north_south, lat_sign) in [("N", 1.0), ("S", -1.0)] {
        for (east_west, lon_sign) in [("E", 1.0), ("W", -1.0)] {
            for (lat, lat_deg) in [("0000.00", 0.0), ("4330.00", 43.5), ("9000.00", 90.0)] {
                for (lon, lon_deg) in [("00000.00", 0.0), ("00515.00", 5.25), ("17959.40", 179.99)]
                {
                    let body = format!("GPGLL,{lat},{north_south},{lon},{east_west},120000,A,A");
                    let Data::Gll(Some(gll)) = data(&body) else {
                        panic!()
                    };
                    assert_eq!(
                        gll.position,
                        Some(position(lat_sign * lat_deg, lon_sign * lon_deg))
                    );
                }
            }
        }
        for east_west in ["E", "W"] {
            let body = format!("GPGLL,1200.0,{north_south},18000.0,{east_west},120000,A");
            let Data::Gll(Some(gll)) = data(&body) else {
                panic!()
            };
            assert_eq!(gll.position, Some(position(lat_sign * 12.0, -180.0)));
        }
    }
}

#[test]
fn an_empty_field_is_unknown_and_never_zero() {
    assert_eq!(data("HCHDG,,,,,"), Data::Hdg(Hdg::default()));
    assert_eq!(data("HCHDM,238,M"), data("HCHDM,238.0,M,"));
    assert_eq!(data("HCHDG,98.3"), data("HCHDG,98.3,,,,"));
    // A side without a value says nothing.
    assert_eq!(data("HCHDG,98.3,,E,,W"), data("HCHDG,98.3,,,,"));
    assert_eq!(data("IIVHW,,T,,M,,N,,K"), Data::Vhw(Vhw::default()));
    assert_eq!(data("IIVHW,,,,,,,,"), Data::Vhw(Vhw::default()));
    assert_eq!(data("HEROT,,A"), Data::Rot(Rot::default()));
    assert_eq!(data("IIXDR,A,,D,ROLL"), Data::Xdr(Xdr::default()));
    assert_eq!(data("WIMTA,,C"), Data::Mta(Mta::default()));
    let Data::Zda(zda) = data("GPZDA,120000,,,,,") else {
        panic!()
    };
    assert_eq!((zda.date, zda.unix_micros()), (None, None));
    let Data::Rmc(Some(rmc)) = data("GPRMC,,A,,,,,,,,,") else {
        panic!()
    };
    assert_eq!(rmc, binnacle_nmea::sentence::Rmc::default());
}

#[test]
fn a_value_that_its_sentence_declares_void_is_not_handed_out() {
    assert_eq!(
        data("GPRMC,120000,V,4330.0,N,00515.0,E,5.0,90.0,010126,,"),
        Data::Rmc(None)
    );
    for mode in ["E", "M", "N", "S"] {
        let body = format!("GPRMC,120000,A,4330.0,N,00515.0,E,5.0,90.0,010126,,,{mode}");
        assert_eq!(data(&body), Data::Rmc(None));
        assert_eq!(
            data(&format!("GPGLL,4330.0,N,00515.0,E,120000,A,{mode}")),
            Data::Gll(None)
        );
        assert_eq!(
            data(&format!("GPVTG,90.0,T,,M,5.0,N,9.3,K,{mode}")),
            Data::Vtg(None)
        );
    }
    for quality in ["", "0", "6", "7", "8"] {
        let body = format!("GPGGA,120000,4330.0,N,00515.0,E,{quality},08,0.9,5.4,M,46.9,M,,");
        assert_eq!(data(&body), Data::Gga(None));
    }
    assert_eq!(data("GPGLL,4330.0,N,00515.0,E,120000,V"), Data::Gll(None));
    assert_eq!(data("HEROT,-12.5,V"), Data::Rot(Rot::default()));
    for (letter, mode) in [
        ("E", ThsMode::Estimated),
        ("M", ThsMode::Manual),
        ("S", ThsMode::Simulator),
        ("V", ThsMode::NotValid),
    ] {
        let expected = Ths {
            heading_deg_true: Some(77.0),
            mode,
        };
        assert_eq!(data(&format!("HETHS,77.0,{letter}")), Data::Ths(expected));
        assert_eq!(expected.valid_heading_deg_true(), None);
    }
}

#[test]
fn starboard_turns_starboard_heel_and_bow_up_are_positive() {
    for rate in [-12.5, 0.0, 12.5] {
        let expected = Rot {
            rate_deg_min_starboard: Some(rate),
        };
        assert_eq!(data(&format!("HEROT,{rate:.1},A")), Data::Rot(expected));
    }
    let expected = Data::Xdr(Xdr {
        roll_deg_starboard_down: Some(0.4),
        pitch_deg_bow_up: Some(-1.8),
        air_temperature_c: None,
    });
    assert_eq!(data("YXXDR,A,-1.8,D,PTCH,A,0.4,D,ROLL"), expected);
    assert_eq!(
        data("YXXDR,P,1.013,B,BARO,A,0.4,D,Roll,A,-1.8,D,Pitch"),
        expected
    );
    // A displacement that happens to be called roll is not an angle.
    assert_eq!(data("YXXDR,D,0.4,M,ROLL"), Data::Xdr(Xdr::default()));
}

#[test]
fn the_temperature_of_the_air_is_read_and_no_other() {
    let expected = Mta {
        air_temperature_c: Some(-3.5),
    };
    assert_eq!(data("WIMTA,-3.5,C"), Data::Mta(expected));
    let expected = Data::Xdr(Xdr {
        air_temperature_c: Some(21.5),
        ..Xdr::default()
    });
    for name in ["TempAir", "AIRTEMP", "ENV_OUTAIR_T", "ENV_OUTSIDE_T"] {
        assert_eq!(data(&format!("YXXDR,C,21.5,C,{name}")), expected, "{name}");
    }
    assert_eq!(
        data("YXXDR,C,85.0,C,ENGINE1,C,21.5,F,TempAir"),
        Data::Xdr(Xdr::default())
    );
}

#[test]
fn the_heartbeat_is_read() {
    let expected = Hbt {
        interval_s: Some(30.0),
        normal: true,
        sequence: Some(9),
    };
    assert_eq!(data("HEHBT,30,A,9"), Data::Hbt(expected));
}

#[test]
fn a_command_to_an_alert_is_read_and_what_is_no_command_is_not() {
    let expected = Acn {
        time: TimeOfDay::new(8, 19, 50, 100_000),
        alert: AlertId {
            manufacturer: Some(*b"XYZ"),
            number: 10_512,
            instance: Some(1),
        },
        command: AlertCommand::Acknowledge,
    };
    assert_eq!(data("CAACN,081950.10,XYZ,10512,1,A,C"), Data::Acn(expected));
    let of_the_standards = Acn {
        time: None,
        alert: AlertId {
            manufacturer: None,
            number: 192,
            instance: None,
        },
        command: AlertCommand::Silence,
    };
    assert_eq!(data("CAACN,,,192,,S,C"), Data::Acn(of_the_standards));
    for (body, field) in [
        ("CAACN,,XYZ,10512,1,A,R", "status flag"),
        ("CAACN,,XYZ,10512,1,A", "status flag"),
        ("CAACN,,XYZ,10512,1,B,C", "command"),
        ("CAACN,,XYZ,,1,A,C", "alert identifier"),
        ("CAACN,,XY,10512,1,A,C", "manufacturer"),
        ("CAACN,,XYZ,10512,x,A,C", "instance"),
    ] {
        let kind = Kind::Acn;
        assert_eq!(
            parse(&line(body)),
            Err(Rejected::BadField { kind, field }),
            "{body}"
        );
    }
}

#[test]
fn a_field_that_nothing_depends_on_spoils_no_sentence() {
    for tail in [
        "3.0,,,",
        "-3.0,E,,",
        "3.0,N,,",
        ",,180.1,W",
        "x,E,y,W",
        "3.0,,2.0",
    ] {
        let hdg = data(&format!("HCHDG,10,{tail}"));
        assert_eq!(hdg, data("HCHDG,10,,,,"), "{tail}");
    }
    let Data::Hdg(hdg) = data("HCHDG,10,3.0,,2.0,W") else {
        panic!()
    };
    assert_eq!(hdg.variation_deg_east, Some(-2.0));
    for tail in ["99999,x,x,x,x,x", "08,0.9,5.4,F,46.9,F", "-1,-1,5.4,,,"] {
        let gga = data(&format!("GPGGA,120000,4330.0,N,00515.0,E,1,{tail}"));
        assert!(
            matches!(gga, Data::Gga(Some(gga)) if gga.position.is_some()),
            "{tail}"
        );
    }
    let vtg = data("GPVTG,90.0,T,400.0,T,5.0,N,9.3,K,A");
    assert_eq!(vtg, data("GPVTG,90.0,T,,M,5.0,N,9.3,K,A"));
}

#[test]
fn a_variation_without_its_letter_costs_no_position() {
    let start = "GPRMC,120000,A,4330.0,N,00515.0,E,5.0,90.0,010126";
    let whole = data(&format!("{start},,,A"));
    assert!(matches!(whole, Data::Rmc(Some(rmc)) if rmc.position.is_some()));
    for tail in [",,A", ",,D", ",", ",,", "", ",3.0,,A", ",x,E,A"] {
        assert_eq!(data(&format!("{start}{tail}")), whole, "{tail}");
    }
    // The mode in the place of the letter is heeded all the same.
    for tail in [",,N", ",,S", ",3.0,,N"] {
        assert_eq!(data(&format!("{start}{tail}")), Data::Rmc(None), "{tail}");
    }
}

#[test]
fn a_wrong_field_is_refused_by_name() {
    for (body, field) in [
        ("HCHDG,361,,,,", "reading"),
        ("HCHDG,-1,,,,", "reading"),
        ("HCHDG,nan,,,,", "reading"),
        ("HCHDM,10,T", "reference"),
        ("HEHDT,10,M", "reference"),
        ("HEHDT,10", "reference"),
        ("HETHS,10", "mode"),
        ("HETHS,10,X", "mode"),
        ("HEROT,1.0", "status"),
        ("HEROT,1.0,AA", "status"),
        ("GPRMC,250000,A,,,,,,,,,", "time"),
        ("GPRMC,120000,A,9500.0,N,00515.0,E,,,,,", "latitude"),
        ("GPRMC,120000,A,9000.1,N,00515.0,E,,,,,", "latitude"),
        ("GPRMC,120000,A,4360.0,N,00515.0,E,,,,,", "latitude"),
        ("GPRMC,120000,A,4330.0,,00515.0,E,,,,,", "latitude"),
        ("GPRMC,120000,A,4330.0,E,00515.0,E,,,,,", "latitude"),
        ("GPRMC,120000,A,4330.0,N,18000.1,E,,,,,", "longitude"),
        ("GPRMC,120000,A,4330.0,N,,,,,,,", "longitude"),
        ("GPRMC,120000,A,-430.0,N,00515.0,E,,,,,", "latitude"),
        ("GPRMC,120000,A,,,,,-1,,,,", "speed"),
        ("GPRMC,120000,A,,,,,,,310226,,", "date"),
        (
            "GPRMC,120000,A,4330.0,N,00515.0,E,5.0,90.0,010126,,X",
            "mode",
        ),
        ("GPZDA,120000,31,02,2026,,", "date"),
        ("GPGGA,120000,,,,,9,,,,,,,,", "quality"),
        ("IIXDR,A,x,D,ROLL", "roll"),
        ("IIXDR,C,x,C,TempAir", "air temperature"),
        ("WIMTA,12.0,F", "unit"),
    ] {
        let Err(Rejected::BadField { field: found, .. }) = parse(&line(body)) else {
            panic!("{body} was not refused");
        };
        assert_eq!(found, field, "{body}");
    }
}

#[test]
fn each_bad_line_is_refused_with_its_reason() {
    let good = line("HEHDT,10.0,T");
    let mut long = "HEHDT,10.0,T".to_owned();
    while long.len() < 260 {
        long.push(',');
    }
    for (bytes, reason) in [
        (&b""[..], Rejected::NotASentence),
        (b"\r\n", Rejected::NotASentence),
        (b"HEHDT,10.0,T*11", Rejected::NotASentence),
        (b"$HEHDT,10.0,T", Rejected::NoChecksum),
        (b"$HEHDT,10.0,T*", Rejected::NoChecksum),
        (b"$HEHDT,11.0,T*11", Rejected::WrongChecksum),
        (b"$HEHDT,1\x00.0,T*11", Rejected::NotAscii),
        (&line(&long), Rejected::TooLong),
        (&line("AIVDM,1,1,,A,x,0"), Rejected::UnknownSentence),
        (&line("PASHR,1,2"), Rejected::UnknownSentence),
        (&line("HDT,1"), Rejected::UnknownSentence),
        (&line("HEHDTX,1,T"), Rejected::UnknownSentence),
        (&line("heHDT,1,T"), Rejected::UnknownSentence),
    ] {
        assert_eq!(parse(bytes), Err(reason), "{}", bytes.escape_ascii());
    }
    for at in 1..good.len() - 2 {
        let mut spoilt = good.clone();
        spoilt[at] ^= 1;
        assert!(parse(&spoilt).is_err(), "{}", spoilt.escape_ascii());
    }
}
