//! Place of the sun in the sky.
//!
//! The algorithm is that of the National Renewable Energy Laboratory (Reda & Andreas,
//! Solar Energy 76 (2004) 577–589), good to 0.0003°, in the crate `solar-positioning`.

use crate::angle::TrueBearing;
use crate::position::Position;
use crate::time::Timestamp;
use solar_positioning::time::JulianDate;
use solar_positioning::{Location, SolarPositions, delta_t};

/// Julian date of 1970-01-01T00:00:00Z.
const JULIAN_1970: f64 = 2_440_587.5;
const MICROS_PER_DAY: f64 = 86_400e6;

/// Place of the sun's centre, seen from sea level, without refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// True bearing.
    pub bearing: TrueBearing,
    /// Altitude above the horizontal, degrees.
    pub altitude_deg: f64,
    /// Declination, degrees, north positive.
    pub declination_deg: f64,
    /// Distance from the earth, astronomical units.
    pub distance_au: f64,
}

/// Computes the place of the sun; `None` outside the years −500 to 3000, for which the
/// earth's rotation is not known.
pub fn sun_at(time: Timestamp, position: Position) -> Option<Sun> {
    // UTC stays within 0.9 s of UT1: 0.004° of the earth's rotation.
    let julian = JULIAN_1970 + time.micros() as f64 / MICROS_PER_DAY;
    let delta_t_s = delta_t::estimate(time.decimal_year()).ok()?;
    let julian = JulianDate::new(julian, delta_t_s).ok()?;
    let sky = SolarPositions::new().for_time_from_julian(julian).ok()?;
    let place = Location {
        latitude: position.lat_deg(),
        longitude: position.lon_deg(),
    };
    let seen = sky.at(place, 0.0, None).ok()?;
    Some(Sun {
        bearing: TrueBearing::new(seen.azimuth())?,
        altitude_deg: seen.elevation_angle(),
        declination_deg: sky.declination(),
        distance_au: sky.earth_radius_vector()?,
    })
}
