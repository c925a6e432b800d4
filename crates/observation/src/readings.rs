//! Readings of each kind of sentence.
//!
//! VHW gives the log's speed alone: it repeats the heading of another instrument without its
//! status. HBT gives no reading. A course over ground is never a heading.

use crate::Reading;
use binnacle_compass::angle::{
    CompassHeading, CourseOverGround, Deviation, MagneticHeading, TrueHeading, Variation,
};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use binnacle_nmea::Data;
use binnacle_nmea::sentence::{self, Hdg, Rmc, Ths, ThsMode, Xdr};

/// Passes each reading of a sentence to `each`: up to three.
pub fn readings(data: &Data, mut each: impl FnMut(Reading)) {
    let reading = match data {
        Data::Hdg(hdg) => compass(hdg),
        Data::Hdm(hdm) => hdm
            .heading_deg_magnetic
            .and_then(MagneticHeading::new)
            .map(|heading| Reading::Magnetic {
                heading,
                deviation: None,
                variation: None,
            }),
        Data::Hdt(hdt) => hdt
            .heading_deg_true
            .and_then(TrueHeading::new)
            .map(Reading::True),
        Data::Ths(ths) => true_heading(ths),
        Data::Rot(rot) => rot
            .rate_deg_min_starboard
            .map(|deg_min| Reading::RateOfTurn { deg_min }),
        Data::Rmc(Some(rmc)) => {
            fix_with_time(rmc).into_iter().for_each(&mut each);
            course(rmc.cog_deg_true)
        }
        Data::Gga(Some(gga)) => gga.position.and_then(fix),
        Data::Gll(Some(gll)) => gll.position.and_then(fix),
        Data::Zda(zda) => zda.unix_micros().and_then(timestamp).map(Reading::Time),
        Data::Vtg(Some(vtg)) => {
            let speed = vtg.sog_kn.map(|sog_kn| Reading::Speed { sog_kn });
            speed.into_iter().for_each(&mut each);
            course(vtg.cog_deg_true)
        }
        Data::Xdr(Xdr {
            roll_deg_starboard_down,
            pitch_deg_bow_up,
            air_temperature_c,
        }) => {
            let pitch = pitch_deg_bow_up.map(|deg| Reading::Pitch { deg });
            let roll = roll_deg_starboard_down.map(|deg| Reading::Roll { deg });
            pitch.into_iter().chain(roll).for_each(&mut each);
            temperature(*air_temperature_c)
        }
        Data::Mta(mta) => temperature(mta.air_temperature_c),
        Data::Acn(acn) => Some(Reading::AlertCommand(*acn)),
        Data::Vhw(vhw) => vhw.water_speed_kn.map(|kn| Reading::WaterSpeed { kn }),
        Data::Rmc(None) | Data::Gga(None) | Data::Gll(None) | Data::Vtg(None) | Data::Hbt(_) => {
            None
        }
    };
    if let Some(reading) = reading {
        each(reading);
    }
}

fn course(degrees: Option<f64>) -> Option<Reading> {
    degrees.and_then(CourseOverGround::new).map(Reading::Course)
}

fn temperature(celsius: Option<f64>) -> Option<Reading> {
    celsius.map(|celsius| Reading::Temperature { celsius })
}

fn compass(hdg: &Hdg) -> Option<Reading> {
    Some(Reading::Compass {
        raw: CompassHeading::new(hdg.reading_deg?)?,
        deviation: hdg.deviation_deg_east.and_then(Deviation::new),
        variation: hdg.variation_deg_east.and_then(Variation::new),
    })
}

/// Mode A without a heading is no reading, but not invalid either.
fn true_heading(ths: &Ths) -> Option<Reading> {
    if ths.mode != ThsMode::Autonomous {
        return Some(Reading::TrueNotValid);
    }
    let heading = ths.valid_heading_deg_true().and_then(TrueHeading::new);
    heading.map(Reading::True)
}

fn fix_with_time(rmc: &Rmc) -> Option<Reading> {
    let time = rmc.unix_micros().and_then(timestamp);
    let Some(position) = rmc.position.and_then(place) else {
        return time.map(Reading::Time);
    };
    Some(Reading::Fix {
        position,
        time,
        sog_kn: rmc.sog_kn,
    })
}

fn fix(position: sentence::Position) -> Option<Reading> {
    Some(Reading::Fix {
        position: place(position)?,
        time: None,
        sog_kn: None,
    })
}

fn place(position: sentence::Position) -> Option<Position> {
    Position::new(position.lat_deg_north, position.lon_deg_east).ok()
}

/// Converts to a timestamp, if the calendar has it.
pub fn timestamp(unix_micros: i64) -> Option<Timestamp> {
    Timestamp::from_micros(unix_micros).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_nmea::parse;

    fn read(body: &str) -> Vec<Reading> {
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        let sentence = parse(format!("${body}*{sum:02X}").as_bytes()).unwrap();
        let mut out = Vec::new();
        readings(&sentence.data, |reading| out.push(reading));
        out
    }

    #[test]
    fn the_compass_reading_is_kept_apart_from_its_deviation() {
        for (body, raw, deviation, variation) in [
            ("HCHDG,100.0,3.0,E,20.0,W", 100.0, Some(3.0), Some(-20.0)),
            ("HCHDG,359.5,3.0,W,20.0,E", 359.5, Some(-3.0), Some(20.0)),
            ("HCHDG,360.0,0.0,E,180.0,W", 0.0, Some(0.0), Some(180.0)),
            ("HCHDG,0.0,,,,", 0.0, None, None),
        ] {
            let expected = Reading::Compass {
                raw: CompassHeading::new(raw).unwrap(),
                deviation: deviation.and_then(Deviation::new),
                variation: variation.and_then(Variation::new),
            };
            assert_eq!(read(body), [expected], "{body}");
        }
    }

    #[test]
    fn unknown_and_void_values_say_nothing() {
        for body in [
            "HCHDG,,3.0,E,20.0,W",
            "HCHDM,,M",
            "HEHDT,,T",
            "HETHS,,A",
            "HEROT,5.0,V",
            "GPRMC,120000,V,4330.0,N,00515.0,E,5.0,90.0,010126,,",
            "GPGGA,120000,4330.0,N,00515.0,E,0,08,0.9,5.4,M,46.9,M,,",
            "GPGLL,4330.0,N,00515.0,E,120000,V",
            "GPVTG,90.0,T,,M,5.0,N,9.3,K,N",
            "GPZDA,120000,,,,,",
            "HEHBT,30,A,9",
        ] {
            assert_eq!(read(body), [], "{body}");
        }
    }

    #[test]
    fn a_true_heading_is_used_in_mode_a_alone() {
        let heading = TrueHeading::new(77.0).unwrap();
        assert_eq!(read("HETHS,77.0,A"), [Reading::True(heading)]);
        assert_eq!(read("HEHDT,77.0,T"), [Reading::True(heading)]);
        for mode in ["E", "M", "S", "V"] {
            let body = format!("HETHS,77.0,{mode}");
            assert_eq!(read(&body), [Reading::TrueNotValid]);
        }
    }

    #[test]
    fn positions_and_times_come_with_their_signs_and_dates() {
        let time = Timestamp::parse("2026-01-02T12:00:00.5Z").ok();
        let position = Position::new(-43.5, -5.25).unwrap();
        assert_eq!(
            read("GPRMC,120000.5,A,4330.0,S,00515.0,W,5.0,90.0,020126,,"),
            [
                Reading::Fix {
                    position,
                    time,
                    sog_kn: Some(5.0)
                },
                Reading::Course(CourseOverGround::new(90.0).unwrap())
            ]
        );
        assert_eq!(
            read("GPGLL,4330.0,S,00515.0,W,120000,A"),
            [Reading::Fix {
                position,
                time: None,
                sog_kn: None
            }]
        );
        let time = Reading::Time(time.unwrap());
        assert_eq!(read("GPRMC,120000.5,A,,,,,,,020126,,"), [time]);
        assert_eq!(read("GPZDA,120000.5,02,01,2026,,"), [time]);
    }

    #[test]
    fn a_speed_comes_with_its_course() {
        let course = Reading::Course(CourseOverGround::new(90.0).unwrap());
        let speed = Reading::Speed { sog_kn: 5.0 };
        assert_eq!(read("GPVTG,90.0,T,,M,5.0,N,9.3,K,A"), [speed, course]);
        assert_eq!(read("GPVTG,,T,85.0,M,5.0,N,9.3,K,A"), [speed]);
    }

    #[test]
    fn a_log_gives_its_speed_and_no_heading() {
        let speed = Reading::WaterSpeed { kn: 5.0 };
        assert_eq!(read("IIVHW,90.0,T,80.0,M,5.0,N,9.3,K"), [speed]);
        assert_eq!(read("IIVHW,90.0,T,80.0,M,,N,,K"), []);
    }

    #[test]
    fn a_temperature_is_read_from_either_sentence() {
        let air = [Reading::Temperature { celsius: -2.5 }];
        assert_eq!(read("WIMTA,-2.5,C"), air);
        assert_eq!(read("IIXDR,C,-2.5,C,TempAir"), air);
    }

    #[test]
    fn roll_and_pitch_come_as_two() {
        assert_eq!(
            read("IIXDR,A,-1.5,D,ROLL,A,0.5,D,PTCH"),
            [Reading::Pitch { deg: 0.5 }, Reading::Roll { deg: -1.5 }]
        );
    }
}
