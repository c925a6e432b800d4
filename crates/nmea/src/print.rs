//! Prints fields, each with the comma before it unless it says otherwise.
//!
//! Numbers are rounded to the decimals of [`crate::fields`]. A value that is
//! not finite, or too large to be read back, becomes an empty field.

use crate::fields::{DECIMALS, MINUTE_DECIMALS, UNITS_A_DEGREE};
use crate::sentence::Position;
use crate::time::{Date, TimeOfDay};

/// The first micro-unit that has ten digits before the decimal point.
const TOO_LARGE: f64 = 1e15;

pub(crate) fn text(out: &mut Vec<u8>, text: &[u8]) {
    out.push(b',');
    out.extend_from_slice(text);
}

pub(crate) fn empty(out: &mut Vec<u8>, fields: usize) {
    for _ in 0..fields {
        out.push(b',');
    }
}

/// Any number, with at least one decimal.
pub(crate) fn number(out: &mut Vec<u8>, value: Option<f64>) {
    out.push(b',');
    let Some(micros) = value.and_then(micros) else {
        return;
    };
    if micros < 0 {
        out.push(b'-');
    }
    decimal(out, micros.unsigned_abs(), DECIMALS, 1, 1);
}

/// A direction, wrapped into [0, 360).
pub(crate) fn direction(out: &mut Vec<u8>, degrees: Option<f64>) {
    number(out, degrees.map(|degrees| degrees.rem_euclid(360.0)));
}

/// A direction and the letter of its reference.
pub(crate) fn direction_from(out: &mut Vec<u8>, degrees: Option<f64>, reference: u8) {
    direction(out, degrees);
    text(out, &[reference]);
}

/// A magnitude and E or W.
pub(crate) fn east_west(out: &mut Vec<u8>, degrees_east: Option<f64>) {
    match degrees_east.filter(|degrees| degrees.is_finite()) {
        Some(degrees) => {
            number(out, Some(degrees.abs()));
            text(out, if degrees < 0.0 { b"W" } else { b"E" });
        }
        None => empty(out, 2),
    }
}

/// A whole number of at least `width` digits.
pub(crate) fn integer(out: &mut Vec<u8>, value: Option<u32>, width: usize) {
    out.push(b',');
    if let Some(value) = value {
        digits(out, u64::from(value), width);
    }
}

/// `hhmmss.ss`.
pub(crate) fn time(out: &mut Vec<u8>, time: Option<TimeOfDay>) {
    out.push(b',');
    let Some(time) = time else { return };
    digits(out, u64::from(time.hour()), 2);
    digits(out, u64::from(time.minute()), 2);
    let micros = u64::from(time.second()) * 1_000_000 + u64::from(time.micro());
    decimal(out, micros, DECIMALS, 2, 2);
}

/// `ddmmyy`.
pub(crate) fn short_date(out: &mut Vec<u8>, date: Option<Date>) {
    out.push(b',');
    let Some(date) = date else { return };
    digits(out, u64::from(date.day()), 2);
    digits(out, u64::from(date.month()), 2);
    digits(out, u64::from(date.year() % 100), 2);
}

/// Latitude, N or S, longitude, E or W.
pub(crate) fn position(out: &mut Vec<u8>, position: Option<Position>) {
    let Some(position) = position else {
        return empty(out, 4);
    };
    let (lat, lon) = (position.lat_deg_north, position.lon_deg_east);
    if !(lat.abs() <= 90.0 && lon.abs() <= 180.0) {
        return empty(out, 4);
    }
    sexagesimal(out, lat.abs(), 2);
    text(out, if lat < 0.0 { b"S" } else { b"N" });
    sexagesimal(out, lon.abs(), 3);
    text(out, if lon < 0.0 { b"W" } else { b"E" });
}

fn sexagesimal(out: &mut Vec<u8>, degrees: f64, width: usize) {
    let units = (degrees * UNITS_A_DEGREE as f64).round() as u64;
    out.push(b',');
    digits(out, units / UNITS_A_DEGREE as u64, width);
    decimal(out, units % UNITS_A_DEGREE as u64, MINUTE_DECIMALS, 4, 2);
}

fn micros(value: f64) -> Option<i64> {
    let micros = (value * 1e6).round();
    (micros.abs() < TOO_LARGE).then_some(micros as i64)
}

/// `scaled / 10^decimals` with at least `least` decimals and `width` digits
/// before the point.
fn decimal(out: &mut Vec<u8>, scaled: u64, decimals: usize, least: usize, width: usize) {
    let mut scale = 10_u64.pow(decimals as u32);
    digits(out, scaled / scale, width);
    out.push(b'.');
    let mut fraction = scaled % scale;
    for place in 0..decimals {
        if place >= least && fraction == 0 {
            return;
        }
        scale /= 10;
        out.push(b'0' + (fraction / scale) as u8);
        fraction %= scale;
    }
}

/// A whole number of at least `width` digits, without a comma.
pub(crate) fn digits(out: &mut Vec<u8>, mut value: u64, width: usize) {
    let mut reversed = [b'0'; 20];
    let mut count = 0;
    while value > 0 || count < width {
        reversed[count] = b'0' + (value % 10) as u8;
        value /= 10;
        count += 1;
    }
    out.extend(reversed[..count].iter().rev());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(value: f64) -> String {
        let mut out = Vec::new();
        number(&mut out, Some(value));
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_keep_six_decimals_and_at_least_one() {
        assert_eq!(printed(98.3), ",98.3");
        assert_eq!(printed(0.0), ",0.0");
        assert_eq!(printed(-0.0), ",0.0");
        assert_eq!(printed(-1e-9), ",0.0");
        assert_eq!(printed(-12.000_001), ",-12.000001");
        assert_eq!(printed(999_999_999.0), ",999999999.0");
    }

    #[test]
    fn unreadable_numbers_are_left_empty() {
        for value in [f64::NAN, f64::INFINITY, 1e9, -1e300, 999_999_999.999_999_9] {
            assert_eq!(printed(value), ",");
        }
    }
}
