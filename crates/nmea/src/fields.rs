//! Reads the fields of one sentence from left to right.
//!
//! An empty field, and one that the sentence ends before, is `None`. Anything
//! else is either wholly understood or refused by name, but for fields on which
//! no other depends: these are `None` where they are not understood.

use crate::rejected::Rejected;
use crate::sentence::{Kind, Position};
use crate::time::{Date, TimeOfDay};

/// Decimals that numbers keep.
pub(crate) const DECIMALS: usize = 6;
/// Decimals that the minutes of a position keep.
pub(crate) const MINUTE_DECIMALS: usize = 7;
/// Ten-millionths of a minute in a degree.
pub(crate) const UNITS_A_DEGREE: i64 = 600_000_000;

/// Digits before the decimal point that are taken for a number.
const MAX_INTEGER_DIGITS: usize = 9;

pub(crate) struct Fields<'a> {
    kind: Kind,
    rest: Option<&'a [u8]>,
}

impl<'a> Fields<'a> {
    /// `rest` is what follows the comma after the address; `None` without one.
    pub(crate) fn new(kind: Kind, rest: Option<&'a [u8]>) -> Fields<'a> {
        Fields { kind, rest }
    }

    pub(crate) fn is_done(&self) -> bool {
        self.rest.is_none()
    }

    pub(crate) fn text(&mut self) -> &'a [u8] {
        let Some(rest) = self.rest else {
            return b"";
        };
        if let Some(comma) = rest.iter().position(|&byte| byte == b',') {
            self.rest = Some(&rest[comma + 1..]);
            &rest[..comma]
        } else {
            self.rest = None;
            rest
        }
    }

    pub(crate) fn skip(&mut self, count: usize) {
        for _ in 0..count {
            self.text();
        }
    }

    pub(crate) fn bad(&self, field: &'static str) -> Rejected {
        Rejected::BadField {
            kind: self.kind,
            field,
        }
    }

    /// Any number.
    pub(crate) fn number(&mut self, field: &'static str) -> Result<Option<f64>, Rejected> {
        let text = self.text();
        if text.is_empty() {
            return Ok(None);
        }
        let micros = decimal(text, DECIMALS).ok_or(self.bad(field))?;
        Ok(Some(micros as f64 / 1e6))
    }

    /// A number that cannot be negative.
    pub(crate) fn magnitude(&mut self, field: &'static str) -> Result<Option<f64>, Rejected> {
        match self.number(field)? {
            Some(value) if value < 0.0 => Err(self.bad(field)),
            value => Ok(value),
        }
    }

    /// A direction from 0 to 360 degrees, as [0, 360).
    pub(crate) fn direction(&mut self, field: &'static str) -> Result<Option<f64>, Rejected> {
        match self.magnitude(field)? {
            Some(value) if value > 360.0 => Err(self.bad(field)),
            Some(value) if value >= 360.0 => Ok(Some(0.0)),
            value => Ok(value),
        }
    }

    /// A magnitude of 0 to 180 degrees followed by E or W, east positive.
    ///
    /// `None` where value and side are not understood: no reading depends on the deviation and
    /// variation that its instrument assumes.
    pub(crate) fn east_west(&mut self) -> Option<f64> {
        let (value, side) = (self.text(), self.text());
        signed(value, side)
    }

    /// The variation, and whether the positioning mode is a fix by satellites.
    ///
    /// Some transponders write an empty variation without its letter, so that the mode stands in
    /// its place.
    pub(crate) fn variation_and_mode(&mut self) -> Result<(Option<f64>, bool), Rejected> {
        let (value, side) = (self.text(), self.text());
        if value.is_empty() && self.is_done() && !matches!(side, b"E" | b"W") {
            return Ok((None, self.is_a_fix(side)?));
        }
        Ok((signed(value, side), self.mode_is_a_fix()?))
    }

    /// A number of metres and its unit; `None` where they are not understood.
    pub(crate) fn metres(&mut self) -> Option<f64> {
        let value = self.number("metres").ok().flatten();
        let unit = self.text();
        value.filter(|_| unit == b"M")
    }

    /// A course from magnetic north and its letter; `None` where they are not understood.
    pub(crate) fn magnetic_course(&mut self) -> Option<f64> {
        let course = self.direction("magnetic course").ok().flatten();
        let letter = self.text();
        course.filter(|_| letter == b"M")
    }

    /// A unit or reference letter that must stand after a given value.
    pub(crate) fn letter_after(
        &mut self,
        value: Option<f64>,
        letter: u8,
        field: &'static str,
    ) -> Result<(), Rejected> {
        match self.text() {
            [found] if *found == letter => Ok(()),
            b"" if value.is_none() => Ok(()),
            _ => Err(self.bad(field)),
        }
    }

    /// One letter or digit; `None` when empty.
    pub(crate) fn letter(&mut self, field: &'static str) -> Result<Option<u8>, Rejected> {
        match self.text() {
            [] => Ok(None),
            [letter] => Ok(Some(*letter)),
            _ => Err(self.bad(field)),
        }
    }

    /// A status: true for A, false for V.
    pub(crate) fn status(&mut self) -> Result<bool, Rejected> {
        match self.text() {
            b"A" => Ok(true),
            b"V" => Ok(false),
            _ => Err(self.bad("status")),
        }
    }

    /// True when the positioning mode is a fix by satellites. Older
    /// sentences have no such field.
    pub(crate) fn mode_is_a_fix(&mut self) -> Result<bool, Rejected> {
        let mode = self.text();
        self.is_a_fix(mode)
    }

    fn is_a_fix(&self, mode: &[u8]) -> Result<bool, Rejected> {
        match mode {
            b"" | b"A" | b"D" | b"F" | b"P" | b"R" => Ok(true),
            b"E" | b"M" | b"N" | b"S" => Ok(false),
            _ => Err(self.bad("mode")),
        }
    }

    /// A whole number of at most `most`.
    pub(crate) fn integer(
        &mut self,
        field: &'static str,
        most: u32,
    ) -> Result<Option<u32>, Rejected> {
        let text = self.text();
        if text.is_empty() {
            return Ok(None);
        }
        let value = digits(text).filter(|&value| value <= most);
        Ok(Some(value.ok_or(self.bad(field))?))
    }

    /// `hhmmss` with any fraction; digits beyond microseconds are dropped.
    pub(crate) fn time(&mut self) -> Result<Option<TimeOfDay>, Rejected> {
        let text = self.text();
        if text.is_empty() {
            return Ok(None);
        }
        Ok(Some(time_of_day(text).ok_or(self.bad("time"))?))
    }

    /// `ddmmyy`; years 80 to 99 lie in the 1900s.
    pub(crate) fn short_date(&mut self) -> Result<Option<Date>, Rejected> {
        let text = self.text();
        if text.is_empty() {
            return Ok(None);
        }
        Ok(Some(short_date(text).ok_or(self.bad("date"))?))
    }

    /// Latitude, N or S, longitude, E or W: all four or none.
    pub(crate) fn position(&mut self) -> Result<Option<Position>, Rejected> {
        let (latitude, north_south) = (self.text(), self.text());
        let (longitude, east_west) = (self.text(), self.text());
        if latitude.is_empty() && longitude.is_empty() {
            return Ok(None);
        }
        let lat_deg_north =
            sexagesimal(latitude, north_south, [b'N', b'S'], 90).ok_or(self.bad("latitude"))?;
        let lon_deg_east =
            sexagesimal(longitude, east_west, [b'E', b'W'], 180).ok_or(self.bad("longitude"))?;
        Ok(Some(Position {
            lat_deg_north,
            lon_deg_east: if lon_deg_east >= 180.0 {
                -180.0
            } else {
                lon_deg_east
            },
        }))
    }
}

/// An angle of 0 to 180 degrees with its side, east positive.
fn signed(value: &[u8], side: &[u8]) -> Option<f64> {
    let degrees = decimal(value, DECIMALS)? as f64 / 1e6;
    match side {
        b"E" | b"W" if !(0.0..=180.0).contains(&degrees) => None,
        b"W" if degrees > 0.0 => Some(-degrees),
        b"E" | b"W" => Some(degrees),
        _ => None,
    }
}

/// `[-]ddd[.ddd]` in units of the last decimal kept, rounded to the nearest.
fn decimal(text: &[u8], decimals: usize) -> Option<i64> {
    let (negative, text) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    let point = text
        .iter()
        .position(|&byte| byte == b'.')
        .unwrap_or(text.len());
    let integer = &text[..point];
    let fraction = text.get(point + 1..).unwrap_or(b"");
    if integer.len() > MAX_INTEGER_DIGITS || integer.len() + fraction.len() == 0 {
        return None;
    }
    let mut value = 0_i64;
    for &byte in integer {
        value = value * 10 + digit(byte)?;
    }
    for place in 0..decimals {
        let next = fraction.get(place).copied().unwrap_or(b'0');
        value = value * 10 + digit(next)?;
    }
    for (place, &byte) in fraction.iter().enumerate().skip(decimals) {
        let beyond = digit(byte)?;
        value += i64::from(place == decimals && beyond >= 5);
    }
    Some(if negative { -value } else { value })
}

fn digit(byte: u8) -> Option<i64> {
    byte.is_ascii_digit().then(|| i64::from(byte - b'0'))
}

/// One to nine digits.
fn digits(text: &[u8]) -> Option<u32> {
    if text.is_empty() || text.len() > MAX_INTEGER_DIGITS {
        return None;
    }
    text.iter()
        .try_fold(0, |value, &byte| Some(value * 10 + digit(byte)? as u32))
}

fn two_digits(text: &[u8]) -> Option<u8> {
    let [tens, ones] = text else { return None };
    Some((digit(*tens)? * 10 + digit(*ones)?) as u8)
}

fn time_of_day(text: &[u8]) -> Option<TimeOfDay> {
    let (whole, fraction) = text.split_at_checked(6)?;
    let micro = match fraction {
        [] => 0,
        [b'.', digits @ ..] => {
            let mut micro = 0;
            for place in 0..digits.len().max(6) {
                let next = digit(digits.get(place).copied().unwrap_or(b'0'))?;
                if place < 6 {
                    micro = micro * 10 + next as u32;
                }
            }
            micro
        }
        _ => return None,
    };
    TimeOfDay::new(
        two_digits(&whole[..2])?,
        two_digits(&whole[2..4])?,
        two_digits(&whole[4..])?,
        micro,
    )
}

fn short_date(text: &[u8]) -> Option<Date> {
    if text.len() != 6 {
        return None;
    }
    let short_year = u16::from(two_digits(&text[4..])?);
    let century = if short_year >= 80 { 1900 } else { 2000 };
    Date::new(
        century + short_year,
        two_digits(&text[2..4])?,
        two_digits(&text[..2])?,
    )
}

/// `dddmm.mmmm` with its side, as degrees, the first of `sides` positive.
fn sexagesimal(text: &[u8], side: &[u8], sides: [u8; 2], most_deg: i64) -> Option<f64> {
    let [side] = side else { return None };
    if !text.first()?.is_ascii_digit() {
        return None;
    }
    let value = decimal(text, MINUTE_DECIMALS)?;
    let one_minute = 10_i64.pow(MINUTE_DECIMALS as u32);
    let degrees = value / (100 * one_minute);
    let minute_units = value % (100 * one_minute);
    let units = degrees * UNITS_A_DEGREE + minute_units;
    if minute_units >= 60 * one_minute || units > most_deg * UNITS_A_DEGREE {
        return None;
    }
    let magnitude_deg = units as f64 / UNITS_A_DEGREE as f64;
    if *side == sides[0] || (*side == sides[1] && units == 0) {
        Some(magnitude_deg)
    } else if *side == sides[1] {
        Some(-magnitude_deg)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_exactly_or_not_at_all() {
        assert_eq!(decimal(b"98.3", 6), Some(98_300_000));
        assert_eq!(decimal(b"-.5", 6), Some(-500_000));
        assert_eq!(decimal(b"7.", 6), Some(7_000_000));
        assert_eq!(decimal(b"0.0000005", 6), Some(1));
        assert_eq!(decimal(b"0.00000049", 6), Some(0));
        for wrong in [
            &b""[..],
            b"-",
            b".",
            b"1e3",
            b"nan",
            b"1.2.3",
            b" 1",
            b"--1",
            b"1234567890",
            b"1.000000x",
        ] {
            assert_eq!(decimal(wrong, 6), None, "{}", wrong.escape_ascii());
        }
    }

    #[test]
    fn two_digit_years_lie_between_1980_and_2079() {
        assert_eq!(short_date(b"010180").unwrap().year(), 1980);
        assert_eq!(short_date(b"311299").unwrap().year(), 1999);
        assert_eq!(short_date(b"010100").unwrap().year(), 2000);
        assert_eq!(short_date(b"311279").unwrap().year(), 2079);
        assert_eq!(short_date(b"310226"), None);
    }

    #[test]
    fn times_need_six_digits() {
        assert_eq!(
            time_of_day(b"235960.5"),
            TimeOfDay::new(23, 59, 60, 500_000)
        );
        assert_eq!(time_of_day(b"000001."), TimeOfDay::new(0, 0, 1, 0));
        assert_eq!(
            time_of_day(b"000001.1234569"),
            TimeOfDay::new(0, 0, 1, 123_456)
        );
        for wrong in [
            &b"12345"[..],
            b"1234567",
            b"240000",
            b"126000",
            b"12345a",
            b"123456.1x",
        ] {
            assert_eq!(time_of_day(wrong), None, "{}", wrong.escape_ascii());
        }
    }
}
