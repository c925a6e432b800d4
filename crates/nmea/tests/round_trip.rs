//! Printed sentences are read back unchanged, and no bytes cause a panic.

use binnacle_nmea::alert::{AlertCommand, AlertId};
use binnacle_nmea::sentence::{
    Acn, Gga, Gll, Hbt, Hdg, Hdm, Hdt, Mta, Position, Rmc, Rot, Ths, ThsMode, Vhw, Vtg, Xdr, Zda,
};
use binnacle_nmea::tag::parse_tagged;
use binnacle_nmea::time::{Date, TimeOfDay};
use binnacle_nmea::{Data, Kind, Lines, Sentence, Tally, lines::Line, parse, write};
use proptest::option::of;
use proptest::prelude::*;

/// Any number on the grid of six decimals.
fn number(least: i64, most: i64) -> impl Strategy<Value = f64> {
    (least * 1_000_000..=most * 1_000_000).prop_map(|micros| micros as f64 / 1e6)
}

fn direction() -> impl Strategy<Value = Option<f64>> {
    of((0..360_000_000_i64).prop_map(|micros| micros as f64 / 1e6))
}

fn position() -> impl Strategy<Value = Option<Position>> {
    let units = |most: i64| -most * 600_000_000..=most * 600_000_000;
    of((units(90), units(180)).prop_map(|(lat, lon)| {
        let lon_deg_east = lon as f64 / 6e8;
        Position {
            lat_deg_north: lat as f64 / 6e8,
            lon_deg_east: if lon_deg_east >= 180.0 {
                -180.0
            } else {
                lon_deg_east
            },
        }
    }))
}

fn time() -> impl Strategy<Value = Option<TimeOfDay>> {
    of((0..24_u8, 0..60_u8, 0..=60_u8, 0..1_000_000_u32)
        .prop_filter_map("not a time", |(h, m, s, micro)| {
            TimeOfDay::new(h, m, s, micro)
        }))
}

fn date(years: std::ops::RangeInclusive<u16>) -> impl Strategy<Value = Option<Date>> {
    of((years, 1..=12_u8, 1..=31_u8).prop_filter_map("not a day", |(y, m, d)| Date::new(y, m, d)))
}

fn command() -> impl Strategy<Value = AlertCommand> {
    prop::sample::select(b"AQOS".to_vec()).prop_filter_map("no command", AlertCommand::from_letter)
}

fn command_to_alert() -> impl Strategy<Value = Data> {
    (
        time(),
        of("[A-Z0-9]{3}"),
        0..10_000_000_u32,
        of(0..1_000_000_u32),
        command(),
    )
        .prop_map(|(time, manufacturer, number, instance, command)| {
            let letters = |text: String| text.into_bytes().try_into().expect("three letters");
            Data::Acn(Acn {
                time,
                alert: AlertId {
                    manufacturer: manufacturer.map(letters),
                    number,
                    instance,
                },
                command,
            })
        })
}

fn data() -> impl Strategy<Value = Data> {
    let any_number = || of(number(-999_999_999, 999_999_999));
    let magnitude = || of(number(0, 999_999_999));
    let difference = || of(number(-180, 180));
    let mode =
        prop::sample::select(b"AEMSV".to_vec()).prop_filter_map("not a mode", ThsMode::from_letter);
    prop_oneof![
        (direction(), difference(), difference()).prop_map(|(reading_deg, d, v)| Data::Hdg(Hdg {
            reading_deg,
            deviation_deg_east: d,
            variation_deg_east: v
        })),
        direction().prop_map(|heading_deg_magnetic| Data::Hdm(Hdm {
            heading_deg_magnetic
        })),
        direction().prop_map(|heading_deg_true| Data::Hdt(Hdt { heading_deg_true })),
        (direction(), mode).prop_map(|(heading_deg_true, mode)| Data::Ths(Ths {
            heading_deg_true,
            mode
        })),
        (direction(), direction(), any_number()).prop_map(|(t, m, s)| Data::Vhw(Vhw {
            heading_deg_true: t,
            heading_deg_magnetic: m,
            water_speed_kn: s
        })),
        any_number().prop_map(|rate| Data::Rot(Rot {
            rate_deg_min_starboard: rate
        })),
        of((
            time(),
            date(1980..=2079),
            position(),
            magnitude(),
            direction(),
            difference()
        )
            .prop_map(
                |(time, date, position, sog_kn, cog_deg_true, variation_deg_east)| Rmc {
                    time,
                    date,
                    position,
                    sog_kn,
                    cog_deg_true,
                    variation_deg_east
                }
            ))
        .prop_map(Data::Rmc),
        of((
            time(),
            position(),
            1..=5_u8,
            of(any::<u8>()),
            magnitude(),
            any_number(),
            any_number()
        )
            .prop_map(
                |(time, position, quality, satellites, hdop, altitude, geoid)| Gga {
                    time,
                    position,
                    quality,
                    satellites,
                    hdop,
                    altitude_m: altitude,
                    geoid_separation_m: geoid
                }
            ))
        .prop_map(Data::Gga),
        of((position(), time()).prop_map(|(position, time)| Gll { position, time }))
            .prop_map(Data::Gll),
        (time(), date(1..=9999)).prop_map(|(time, date)| Data::Zda(Zda { time, date })),
        of(
            (direction(), direction(), magnitude()).prop_map(|(t, m, s)| Vtg {
                cog_deg_true: t,
                cog_deg_magnetic: m,
                sog_kn: s
            })
        )
        .prop_map(Data::Vtg),
        (any_number(), any_number(), any_number()).prop_map(|(roll, pitch, temperature)| {
            Data::Xdr(Xdr {
                roll_deg_starboard_down: roll,
                pitch_deg_bow_up: pitch,
                air_temperature_c: temperature,
            })
        }),
        any_number().prop_map(|air_temperature_c| Data::Mta(Mta { air_temperature_c })),
        (magnitude(), any::<bool>(), of(0..=9_u8)).prop_map(|(interval_s, normal, sequence)| {
            Data::Hbt(Hbt {
                interval_s,
                normal,
                sequence,
            })
        }),
        command_to_alert(),
    ]
}

fn sentence() -> impl Strategy<Value = Sentence> {
    ("[A-Z0-9]{2}", data()).prop_map(|(talker, data)| Sentence {
        talker: talker
            .as_bytes()
            .try_into()
            .expect("the pattern has two letters"),
        data,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_printed_sentence_is_read_back_unchanged(sentence in sentence()) {
        let mut printed = Vec::new();
        write(&sentence, &mut printed);
        prop_assert_eq!(parse(&printed), Ok(sentence), "{}", printed.escape_ascii());
        prop_assert!(printed.ends_with(b"\r\n"));
    }

    #[test]
    fn one_flipped_bit_is_always_refused(sentence in sentence(), bit in any::<prop::sample::Index>()) {
        let mut printed = Vec::new();
        write(&sentence, &mut printed);
        let bit = bit.index((printed.len() - 2) * 8);
        printed[bit / 8] ^= 1 << (bit % 8);
        // In the checksum itself a flip may change only the case of a digit.
        if let Ok(read) = parse(&printed) {
            prop_assert_eq!(read, sentence);
            prop_assert!(bit / 8 >= printed.len() - 4);
        }
    }

    #[test]
    fn any_numbers_at_all_are_printed_so_that_they_can_be_read(
        a in any::<f64>(), b in any::<f64>(), c in any::<f64>(),
    ) {
        for data in [
            Data::Hdg(Hdg { reading_deg: Some(a), deviation_deg_east: None, variation_deg_east: None }),
            Data::Xdr(Xdr {
                roll_deg_starboard_down: Some(b),
                pitch_deg_bow_up: Some(c),
                air_temperature_c: Some(a),
            }),
            Data::Rmc(Some(Rmc {
                position: Some(Position { lat_deg_north: a, lon_deg_east: b }),
                cog_deg_true: Some(c),
                ..Rmc::default()
            })),
        ] {
            let mut printed = Vec::new();
            write(&Sentence { talker: *b"II", data }, &mut printed);
            prop_assert!(parse(&printed).is_ok(), "{}", printed.escape_ascii());
        }
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse(&bytes);
        let _ = parse_tagged(&bytes);
        let mut lines = Lines::default();
        let mut tally = Tally::default();
        lines.push(&bytes, |line| if let Line::Whole(line) = line { tally.read(line); });
    }

    /// Noise seldom has a right checksum, so this puts one on, and on what is
    /// near to a sentence.
    #[test]
    fn a_read_sentence_is_printed_and_read_back_unchanged(
        kind in prop::sample::select(Kind::ALL.to_vec()),
        fields in prop::collection::vec(
            prop_oneof![
                Just(String::new()), "[AVENSWTMKDP]", "[0-9]{1,6}(\\.[0-9]{0,9})?",
                "-?[0-9]{1,3}\\.[0-9]", "[0-3][0-9][0-5][0-9]\\.[0-9]{2,8}", "ROLL|PTCH|TempAir",
            ],
            0..14,
        ),
    ) {
        let body = format!("II{},{}", kind.name(), fields.join(","));
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        if let Ok(read) = parse(format!("${body}*{sum:02x}").as_bytes()) {
            let mut printed = Vec::new();
            write(&read, &mut printed);
            prop_assert_eq!(parse(&printed), Ok(read), "{} as {}", body, printed.escape_ascii());
        }
    }
}
