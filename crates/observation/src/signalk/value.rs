//! Signal K values in the agent's units.

use crate::Reading;
use binnacle_compass::angle::{CourseOverGround, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use serde::Deserialize;
use serde_json::Value;
use std::f64::consts::{PI, TAU};

const KNOTS_A_METRE_PER_SECOND: f64 = 3600.0 / 1852.0;
/// Highest plausible speed.
const MAX_SPEED_M_S: f64 = 100.0;
const KELVIN_AT_ZERO_CELSIUS: f64 = 273.15;
/// Furthest plausible temperature from freezing.
const MAX_TEMPERATURE_C: f64 = 100.0;
/// Highest plausible rate of turn.
const MAX_TURN_RAD_S: f64 = PI;
/// Rounding tolerance: four decimals of a full circle may exceed it.
const ROUNDING_RAD: f64 = 1e-4;

#[derive(Deserialize)]
struct Attitude {
    roll: Option<f64>,
    pitch: Option<f64>,
}

#[derive(Deserialize)]
struct LatLon {
    latitude: f64,
    longitude: f64,
}

/// A value that its path must not have.
pub(super) struct InvalidValue;

/// Reads a path whose value stands alone.
pub(super) fn read_standalone(
    path: &str,
    value: &Value,
    push: &mut impl FnMut(&[u8; 3], Reading),
) -> Result<(), InvalidValue> {
    if value.is_null() {
        return Ok(());
    }
    match path {
        "navigation.headingTrue" => {
            let heading = direction_deg(value)?.and_then(TrueHeading::new);
            push(b"HDT", Reading::True(heading.ok_or(InvalidValue)?));
        }
        "navigation.rateOfTurn" => {
            let rate = number(value)?;
            if rate.abs() > MAX_TURN_RAD_S {
                return Err(InvalidValue);
            }
            let deg_min = rate.to_degrees() * 60.0;
            push(b"ROT", Reading::RateOfTurn { deg_min });
        }
        "navigation.attitude" => {
            let attitude = Attitude::deserialize(value).map_err(|_| InvalidValue)?;
            if let Some(pitch) = attitude.pitch {
                let deg = tilt_deg(pitch)?;
                push(b"XDR", Reading::Pitch { deg });
            }
            if let Some(roll) = attitude.roll {
                let deg = tilt_deg(roll)?;
                push(b"XDR", Reading::Roll { deg });
            }
        }
        "navigation.position" => {
            let lat_lon = LatLon::deserialize(value).map_err(|_| InvalidValue)?;
            let fix = Reading::Fix {
                position: Position::new(lat_lon.latitude, lat_lon.longitude)
                    .map_err(|_| InvalidValue)?,
                time: None,
                sog_kn: None,
            };
            push(b"RMC", fix);
        }
        "navigation.speedOverGround" => {
            let speed_m_s = number(value)?;
            if !(0.0..=MAX_SPEED_M_S).contains(&speed_m_s) {
                return Err(InvalidValue);
            }
            let sog_kn = speed_m_s * KNOTS_A_METRE_PER_SECOND;
            push(b"VTG", Reading::Speed { sog_kn });
        }
        "navigation.speedThroughWater" => {
            let speed_m_s = number(value)?;
            // Some logs give a speed astern.
            if speed_m_s.abs() > MAX_SPEED_M_S {
                return Err(InvalidValue);
            }
            let kn = speed_m_s * KNOTS_A_METRE_PER_SECOND;
            push(b"VHW", Reading::WaterSpeed { kn });
        }
        "navigation.courseOverGroundTrue" => {
            let course = direction_deg(value)?.and_then(CourseOverGround::new);
            push(b"VTG", Reading::Course(course.ok_or(InvalidValue)?));
        }
        "environment.outside.temperature" => {
            let celsius = number(value)? - KELVIN_AT_ZERO_CELSIUS;
            if celsius.abs() > MAX_TEMPERATURE_C {
                return Err(InvalidValue);
            }
            push(b"MTA", Reading::Temperature { celsius });
        }
        _ => {
            let text = value.as_str().ok_or(InvalidValue)?;
            let at = Timestamp::parse(text).map_err(|_| InvalidValue)?;
            push(b"ZDA", Reading::Time(at));
        }
    }
    Ok(())
}

fn number(value: &Value) -> Result<f64, InvalidValue> {
    value
        .as_f64()
        .filter(|number| number.is_finite())
        .ok_or(InvalidValue)
}

/// Converts radians from 0 to a full circle to degrees; `None` for null.
pub(super) fn direction_deg(value: &Value) -> Result<Option<f64>, InvalidValue> {
    bounded_deg(value, 0.0 - ROUNDING_RAD..=TAU + ROUNDING_RAD)
}

/// Converts radians from −π to π to degrees; `None` for null.
pub(super) fn difference_deg(value: &Value) -> Result<Option<f64>, InvalidValue> {
    bounded_deg(value, -PI - ROUNDING_RAD..=PI + ROUNDING_RAD)
}

fn bounded_deg(
    value: &Value,
    range: std::ops::RangeInclusive<f64>,
) -> Result<Option<f64>, InvalidValue> {
    if value.is_null() {
        return Ok(None);
    }
    let radians = number(value)?;
    if !range.contains(&radians) {
        return Err(InvalidValue);
    }
    Ok(Some(radians.to_degrees()))
}

fn tilt_deg(radians: f64) -> Result<f64, InvalidValue> {
    if radians.abs() > PI {
        return Err(InvalidValue);
    }
    Ok(radians.to_degrees())
}
