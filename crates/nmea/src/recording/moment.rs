//! Dates and times of day, as a logger may write them in one token.

use super::digits::Digits;
use crate::time::{Date, TimeOfDay, unix_micros};

pub(super) const MICROS_A_SECOND: i64 = 1_000_000;
pub(super) const MICROS_A_DAY: i64 = 86_400 * MICROS_A_SECOND;

/// Years of a recording: from the start of GPS time.
const YEARS: std::ops::RangeInclusive<u64> = 1980..=2099;
const MONTHS: [&[u8; 3]; 12] = [
    b"jan", b"feb", b"mar", b"apr", b"may", b"jun", b"jul", b"aug", b"sep", b"oct", b"nov", b"dec",
];

/// Order of day and month in dates such as `08/01/2014`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DateOrder {
    /// Month, day, year: the ship logs of NOAA (SCS) and others.
    #[default]
    MonthFirst,
    /// Day, month, year.
    DayFirst,
}

/// Start of a day, and whatever stands behind the date.
type DayAndRest<'a> = (i64, Digits<'a>);

/// Reads a date at the beginning of a token. Returns microseconds since 1970.
pub(super) fn date(token: &[u8], order: DateOrder) -> Option<DayAndRest<'_>> {
    let digits = Digits(token);
    match digits.leading_digits() {
        4 => year_first(digits),
        1 | 2 => year_last(digits, order).or_else(|| short_year_and_day(digits)),
        8 => compact(digits),
        _ => None,
    }
}

/// `2014-08-01`, `2014/08/01`, and the day of the year as `2014:213`.
fn year_first(mut digits: Digits<'_>) -> Option<DayAndRest<'_>> {
    let year = year(digits.number(4, 4)?)?;
    let separator = digits.one_of(b"-/.:")?;
    if digits.leading_digits() == 3 {
        return Some((day_of_year(year, digits.number(3, 3)?)?, digits));
    }
    let month = digits.number(1, 2)?;
    digits.one_of(&[separator])?;
    let day = digits.number(1, 2)?;
    Some((start_of(year, month, day)?, digits))
}

/// `08/01/2014` in either order, `01.08.2014`, `01-Aug-2014`.
fn year_last(mut digits: Digits<'_>, order: DateOrder) -> Option<DayAndRest<'_>> {
    let first = digits.number(1, 2)?;
    let separator = digits.one_of(b"-/.")?;
    if let Some(month) = digits.0.first_chunk::<3>().copied().and_then(month_number) {
        digits.0 = &digits.0[3..];
        digits.one_of(&[separator])?;
        let year = year(digits.number(4, 4)?)?;
        return Some((start_of(year, month, first)?, digits));
    }
    let second = digits.number(1, 2)?;
    digits.one_of(&[separator])?;
    let year = year(digits.number(4, 4)?)?;
    let start = if separator == b'/' && order == DateOrder::MonthFirst {
        start_of(year, first, second)
    } else {
        start_of(year, second, first)
    };
    Some((start?, digits))
}

/// The year and its day as `14+213`.
fn short_year_and_day(mut digits: Digits<'_>) -> Option<DayAndRest<'_>> {
    let short = digits.number(2, 2)?;
    digits.one_of(b"+")?;
    let day = digits.number(3, 3)?;
    let year = if short < 80 {
        2000 + short
    } else {
        1900 + short
    };
    Some((day_of_year(year as u16, day)?, digits))
}

/// `20140801`.
fn compact(mut digits: Digits<'_>) -> Option<DayAndRest<'_>> {
    let year = year(digits.take(4)?)?;
    let (month, day) = (digits.take(2)?, digits.take(2)?);
    Some((start_of(year, month, day)?, digits))
}

/// Reads a whole token as a time of day with its zone. Returns microseconds since
/// midnight, UTC, which may be of the day before or after.
pub(super) fn time_of_day(token: &[u8]) -> Option<i64> {
    let mut digits = Digits(token);
    let hour = digits.number(1, 2)?;
    digits.one_of(b":")?;
    let minute = digits.number(1, 2)?;
    digits.one_of(b":")?;
    time_from_seconds(digits, hour, minute)
}

/// Reads a whole token as `000000.183`, which is a time behind a date only.
pub(super) fn compact_time_of_day(token: &[u8]) -> Option<i64> {
    let mut digits = Digits(token);
    if digits.leading_digits() != 6 {
        return None;
    }
    let (hour, minute) = (digits.take(2)?, digits.take(2)?);
    time_from_seconds(digits, hour, minute)
}

fn time_from_seconds(mut digits: Digits<'_>, hour: u64, minute: u64) -> Option<i64> {
    let second = digits.number(1, 2)?;
    // Milliseconds may stand behind a colon.
    let micros = match digits.one_of(b".,:") {
        Some(_) => digits.decimals()?,
        None => 0,
    };
    let time = TimeOfDay::new(
        u8::try_from(hour).ok()?,
        u8::try_from(minute).ok()?,
        u8::try_from(second).ok()?,
        micros,
    )?;
    let zone = if digits.is_done() { 0 } else { zone(digits.0)? };
    let seconds =
        i64::from(time.hour()) * 3_600 + i64::from(time.minute()) * 60 + i64::from(time.second());
    Some(seconds * MICROS_A_SECOND + i64::from(time.micro()) - zone)
}

/// Reads a whole token as a zone: microseconds by which its clocks are ahead.
pub(super) fn zone(token: &[u8]) -> Option<i64> {
    if [&b"Z"[..], b"UTC", b"GMT"]
        .iter()
        .any(|name| token.eq_ignore_ascii_case(name))
    {
        return Some(0);
    }
    let mut digits = Digits(token);
    let sign = if digits.one_of(b"+-")? == b'+' { 1 } else { -1 };
    let hours = digits.take(2)?;
    digits.one_of(b":");
    let minutes = if digits.is_done() {
        0
    } else {
        digits.number(2, 2)?
    };
    if !digits.is_done() || hours > 14 || minutes > 59 {
        return None;
    }
    let ahead_minutes = i64::try_from(hours * 60 + minutes).ok()?;
    Some(sign * ahead_minutes * 60 * MICROS_A_SECOND)
}

/// Reads a whole token as seconds, milliseconds, microseconds or nanoseconds
/// since 1970, which their digits distinguish.
pub(super) fn since_1970(token: &[u8]) -> Option<i64> {
    let mut digits = Digits(token);
    let length = digits.leading_digits();
    let number = i64::try_from(digits.number(9, 19)?).ok()?;
    let fraction = match digits.one_of(b".") {
        Some(_) => i64::from(digits.decimals()?),
        None => 0,
    };
    if !digits.is_done() {
        return None;
    }
    let micros = match length {
        9 | 10 => number * MICROS_A_SECOND + fraction,
        12 | 13 => number * 1_000 + fraction / 1_000,
        15 | 16 => number,
        18 | 19 => number / 1_000,
        _ => return None,
    };
    let first = start_of(1980, 1, 6)?;
    let end = start_of(2100, 1, 1)?;
    (first..end).contains(&micros).then_some(micros)
}

/// Returns the number of a month from the first letters of its name.
pub(super) fn month_number(name: [u8; 3]) -> Option<u64> {
    let lower = name.map(|letter| letter.to_ascii_lowercase());
    let place = MONTHS.iter().position(|month| **month == lower)?;
    Some(place as u64 + 1)
}

/// Returns a year that a recording may have.
pub(super) fn year(number: u64) -> Option<u16> {
    YEARS.contains(&number).then_some(number as u16)
}

/// Returns the start of a day of the calendar, if there is such a day.
pub(super) fn start_of(year: u16, month: u64, day: u64) -> Option<i64> {
    let date = Date::new(year, u8::try_from(month).ok()?, u8::try_from(day).ok()?)?;
    Some(unix_micros(date, TimeOfDay::new(0, 0, 0, 0)?))
}

fn day_of_year(year: u16, day: u64) -> Option<i64> {
    let first = start_of(year, 1, 1)?;
    let start = first + (i64::try_from(day).ok()? - 1) * MICROS_A_DAY;
    let next = start_of(year + 1, 1, 1)?;
    (first..next).contains(&start).then_some(start)
}
