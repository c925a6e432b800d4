//! Content of the parameter groups that a compass needs, with units and signs settled.

use super::fields::Fields;
use super::frame::{ADDRESS_CLAIM, Message, REQUEST};
use super::identity::Name;

/// Steps of the fields, in SI units.
pub(super) const ANGLE_RAD: f64 = 1e-4;
const RATE_RAD_S: f64 = 1e-6 / 32.0;
const SPEED_M_S: f64 = 0.01;
const PLACE_DEG: f64 = 1e-7;
const EXACT_PLACE_DEG: f64 = 1e-16;
const TIME_S: f64 = 1e-4;

const KNOTS_A_METRE_PER_SECOND: f64 = 3600.0 / 1852.0;
const DAY_S: f64 = 86_400.0;

/// North that a direction is counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// True north.
    True,
    /// Magnetic north.
    Magnetic,
}

impl Reference {
    fn from_bits(bits: u8) -> Option<Reference> {
        match bits & 0x03 {
            0 => Some(Reference::True),
            1 => Some(Reference::Magnetic),
            _ => None,
        }
    }
}

/// Way in which a position was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixMethod {
    /// By satellites.
    Satellites,
    /// Reckoned, entered by hand, or simulated: no fix.
    Other,
    /// None.
    NoFix,
}

/// Content of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// 127250: heading of a sensor, with its own deviation and variation, degrees east.
    Heading {
        /// Heading in [0, 360).
        deg: f64,
        /// North that it is counted from. A magnetic one is the reading before deviation.
        reference: Reference,
        /// Deviation.
        deviation_deg_east: Option<f64>,
        /// Variation.
        variation_deg_east: Option<f64>,
    },
    /// 127251: rate of turn, degrees a minute, bow to starboard positive.
    RateOfTurn {
        /// The rate.
        deg_min_starboard: f64,
    },
    /// 127257: attitude, degrees.
    Attitude {
        /// Bow up positive.
        pitch_deg_bow_up: Option<f64>,
        /// Starboard side down positive.
        roll_deg_starboard_down: Option<f64>,
    },
    /// 127258: variation, degrees east.
    Variation {
        /// The variation.
        deg_east: f64,
    },
    /// 128259: speed through the water, knots.
    WaterSpeed {
        /// The speed.
        kn: f64,
    },
    /// 129025: position, degrees.
    Position {
        /// North positive.
        lat_deg_north: f64,
        /// East positive.
        lon_deg_east: f64,
    },
    /// 129026: course and speed over the ground.
    CourseSpeed {
        /// Course from true north, degrees in [0, 360); none from magnetic north.
        cog_deg_true: Option<f64>,
        /// Knots.
        sog_kn: Option<f64>,
    },
    /// 129029: position with date and time.
    Fix {
        /// Way in which it was found.
        method: FixMethod,
        /// Degrees, north positive.
        lat_deg_north: Option<f64>,
        /// Degrees, east positive.
        lon_deg_east: Option<f64>,
        /// Microseconds since 1970, UTC.
        unix_micros: Option<i64>,
    },
    /// 126992: date and time by satellites, microseconds since 1970, UTC.
    Time {
        /// The time.
        unix_micros: i64,
    },
    /// 60928: NAME of the device at the source's address.
    AddressClaim {
        /// The NAME.
        name: Name,
    },
    /// 59904: request for a parameter group.
    Request {
        /// Number of the group.
        pgn: u32,
    },
}

impl Data {
    /// Reads a message; `None` for other groups, and where the value itself is not available.
    pub fn parse(message: &Message) -> Option<Data> {
        let mut fields = Fields::new(&message.data);
        match message.header.pgn {
            127_250 => heading(fields),
            127_251 => {
                fields.skip(1);
                let rad_s = fields.i32()? * RATE_RAD_S;
                let deg_min_starboard = rad_s.to_degrees() * 60.0;
                Some(Data::RateOfTurn { deg_min_starboard })
            }
            127_257 => {
                fields.skip(3);
                let mut deg = || Some((fields.i16()? * ANGLE_RAD).to_degrees());
                let (pitch_deg_bow_up, roll_deg_starboard_down) = (deg(), deg());
                pitch_deg_bow_up.or(roll_deg_starboard_down)?;
                Some(Data::Attitude {
                    pitch_deg_bow_up,
                    roll_deg_starboard_down,
                })
            }
            127_258 => {
                fields.skip(4);
                let deg_east = (fields.i16()? * ANGLE_RAD).to_degrees();
                Some(Data::Variation { deg_east })
            }
            128_259 => {
                fields.skip(1);
                let kn = fields.u16()? * SPEED_M_S * KNOTS_A_METRE_PER_SECOND;
                Some(Data::WaterSpeed { kn })
            }
            129_025 => Some(Data::Position {
                lat_deg_north: fields.i32()? * PLACE_DEG,
                lon_deg_east: fields.i32()? * PLACE_DEG,
            }),
            129_026 => course_speed(fields),
            129_029 => Some(fix(fields)),
            126_992 => time(fields),
            ADDRESS_CLAIM => {
                let name = message.data.get(..8)?.try_into().ok()?;
                let name = Name::from_number(u64::from_le_bytes(name));
                Some(Data::AddressClaim { name })
            }
            REQUEST => match *message.data.get(..3)? {
                [low, middle, high] => Some(Data::Request {
                    pgn: u32::from_le_bytes([low, middle, high, 0]),
                }),
                _ => None,
            },
            _ => None,
        }
    }
}

fn heading(mut fields: Fields<'_>) -> Option<Data> {
    fields.skip(1);
    let deg = degrees(fields.u16());
    let mut angle = || Some((fields.i16()? * ANGLE_RAD).to_degrees());
    let (deviation_deg_east, variation_deg_east) = (angle(), angle());
    Some(Data::Heading {
        deg: deg?,
        reference: Reference::from_bits(fields.flags())?,
        deviation_deg_east,
        variation_deg_east,
    })
}

fn course_speed(mut fields: Fields<'_>) -> Option<Data> {
    fields.skip(1);
    let is_true = Reference::from_bits(fields.flags()) == Some(Reference::True);
    let cog_deg_true = degrees(fields.u16()).filter(|_| is_true);
    let sog_kn = fields
        .u16()
        .map(|steps| steps * SPEED_M_S * KNOTS_A_METRE_PER_SECOND);
    cog_deg_true.or(sog_kn)?;
    Some(Data::CourseSpeed {
        cog_deg_true,
        sog_kn,
    })
}

fn fix(mut fields: Fields<'_>) -> Data {
    fields.skip(1);
    let unix_micros = unix_micros(&mut fields);
    let lat_deg_north = fields.i64().map(|steps| steps * EXACT_PLACE_DEG);
    let lon_deg_east = fields.i64().map(|steps| steps * EXACT_PLACE_DEG);
    fields.skip(8);
    let method = match fields.flags() >> 4 {
        0 => FixMethod::NoFix,
        1..=5 => FixMethod::Satellites,
        _ => FixMethod::Other,
    };
    Data::Fix {
        method,
        lat_deg_north,
        lon_deg_east,
        unix_micros,
    }
}

/// Reads the system time. A clock other than satellites' is no GNSS time.
fn time(mut fields: Fields<'_>) -> Option<Data> {
    fields.skip(1);
    let is_by_satellites = fields.flags() & 0x0f <= 1;
    let unix_micros = unix_micros(&mut fields)?;
    is_by_satellites.then_some(Data::Time { unix_micros })
}

/// Reads days since 1970 and seconds of the day.
fn unix_micros(fields: &mut Fields<'_>) -> Option<i64> {
    let (days, seconds) = (fields.u16(), fields.u32());
    let (days, seconds) = (days?, seconds? * TIME_S);
    // A leap second is the last of its day.
    if seconds >= DAY_S + 1.0 {
        return None;
    }
    Some(((days * DAY_S + seconds) * 1e6).round() as i64)
}

/// Converts steps of a direction to degrees in [0, 360); `None` beyond a full circle.
fn degrees(steps: Option<f64>) -> Option<f64> {
    let degrees = (steps? * ANGLE_RAD).to_degrees();
    // A full circle may be rounded up.
    (degrees < 360.01).then(|| degrees.rem_euclid(360.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::n2k::frame::{ALL, Header};

    fn parse(pgn: u32, data: &[u8]) -> Option<Data> {
        Data::parse(&Message {
            header: Header {
                priority: 2,
                pgn,
                source: 4,
                destination: ALL,
            },
            data: data.to_vec(),
        })
    }

    #[test]
    fn a_heading_comes_with_its_reference_and_signs() {
        let magnetic = [0, 0x10, 0x27, 0x9c, 0xff, 0xff, 0x7f, 0xfd];
        let Some(Data::Heading {
            deg,
            reference,
            deviation_deg_east,
            variation_deg_east,
        }) = parse(127_250, &magnetic)
        else {
            panic!("no heading");
        };
        assert!((deg - 57.2958).abs() < 1e-4);
        assert_eq!(reference, Reference::Magnetic);
        assert!((deviation_deg_east.unwrap() + 0.573).abs() < 1e-3);
        assert_eq!(variation_deg_east, None);
        for nothing in [
            [0, 0xff, 0xff, 0, 0, 0, 0, 0xfd],
            [0, 0x10, 0x27, 0, 0, 0, 0, 0xff],
            [0, 0xf0, 0xff, 0, 0, 0, 0, 0xfd],
        ] {
            assert_eq!(parse(127_250, &nothing), None);
        }
        assert_eq!(parse(127_250, &[]), None);
    }

    #[test]
    fn turns_and_tilt_have_starboard_positive() {
        let Some(Data::RateOfTurn { deg_min_starboard }) =
            parse(127_251, &[0, 0x80, 0x38, 0x01, 0x00, 0xff, 0xff, 0xff])
        else {
            panic!("no rate");
        };
        assert!(
            (deg_min_starboard - 8.594).abs() < 0.01,
            "{deg_min_starboard}"
        );
        let Some(Data::Attitude {
            pitch_deg_bow_up,
            roll_deg_starboard_down,
        }) = parse(127_257, &[0, 0xff, 0x7f, 0x57, 0x00, 0xa9, 0xff, 0xff])
        else {
            panic!("no attitude");
        };
        assert!((pitch_deg_bow_up.unwrap() - 0.498).abs() < 1e-3);
        assert!((roll_deg_starboard_down.unwrap() + 0.498).abs() < 1e-3);
    }

    #[test]
    fn positions_have_their_signs_and_methods() {
        let place = parse(129_025, &[0x00, 0xca, 0x9a, 0x3b, 0x00, 0x36, 0x65, 0xc4]);
        assert_eq!(
            place,
            Some(Data::Position {
                lat_deg_north: 100.0,
                lon_deg_east: -100.0
            })
        );
        let mut fix = vec![1];
        fix.extend(20_000_u16.to_le_bytes());
        fix.extend(432_000_000_u32.to_le_bytes());
        fix.extend(434_000_000_000_000_000_i64.to_le_bytes());
        fix.extend((-30_000_000_000_000_000_i64).to_le_bytes());
        fix.extend(0_i64.to_le_bytes());
        for (method_bits, method) in [
            (0x00, FixMethod::NoFix),
            (0x10, FixMethod::Satellites),
            (0x60, FixMethod::Other),
            (0x80, FixMethod::Other),
        ] {
            let mut bytes = fix.clone();
            bytes.push(method_bits);
            let Some(Data::Fix {
                method: read,
                lat_deg_north,
                lon_deg_east,
                unix_micros,
            }) = parse(129_029, &bytes)
            else {
                panic!("no fix");
            };
            assert_eq!(read, method);
            assert!((lat_deg_north.unwrap() - 43.4).abs() < 1e-9);
            assert!((lon_deg_east.unwrap() + 3.0).abs() < 1e-9);
            // Noon of day 20,000.
            assert_eq!(unix_micros, Some((20_000 * 86_400 + 43_200) * 1_000_000));
        }
    }

    #[test]
    fn a_time_counts_if_satellites_gave_it() {
        let with_source = |source| parse(126_992, &[0, source, 0x20, 0x4e, 0, 0, 0, 0]);
        let unix_micros = 20_000 * 86_400 * 1_000_000;
        assert_eq!(with_source(0xf0), Some(Data::Time { unix_micros }));
        assert_eq!(with_source(0xf5), None);
    }

    #[test]
    fn course_and_speed_are_true_and_in_knots() {
        let Some(Data::CourseSpeed {
            cog_deg_true,
            sog_kn,
        }) = parse(129_026, &[0, 0xfc, 0x5c, 0x3d, 0x03, 0x02, 0xff, 0xff])
        else {
            panic!("nothing");
        };
        assert!((cog_deg_true.unwrap() - 90.0).abs() < 0.01);
        assert!((sog_kn.unwrap() - 10.01).abs() < 0.01);
        let magnetic = parse(129_026, &[0, 0xfd, 0x5c, 0x3d, 0xff, 0xff, 0xff, 0xff]);
        assert_eq!(magnetic, None);
    }

    #[test]
    fn a_name_and_a_request_are_read() {
        let name = Name::parse("c0788c00e7e04312").unwrap();
        assert_eq!(
            parse(
                ADDRESS_CLAIM,
                &[0x12, 0x43, 0xe0, 0xe7, 0x00, 0x8c, 0x78, 0xc0]
            ),
            Some(Data::AddressClaim { name })
        );
        assert_eq!(
            parse(REQUEST, &[0x00, 0xee, 0x00]),
            Some(Data::Request { pgn: ADDRESS_CLAIM })
        );
    }
}
