//! The time that a logger gives a line, wherever it stands in a prefix.

use super::digits::Digits;
use super::moment::{
    DateOrder, compact_time_of_day, date, month_number, since_1970, start_of, time_of_day, year,
    zone,
};

/// Bytes of a prefix that are searched for a time.
const MAX_PREFIX_BYTES: usize = 512;
const MICROS_OF_HALF_A_DAY: i64 = 43_200_000_000;

/// Time of a recorded line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stamp {
    /// Microseconds since 1970 UTC.
    Instant(i64),
    /// Microseconds since midnight UTC of an unknown day. Negative, or more than
    /// a day, where the zone moves it to another one.
    TimeOfDay(i64),
}

/// Finds the time in a prefix: the first date and the first time of day, or a
/// count of seconds, milliseconds, microseconds or nanoseconds since 1970.
pub fn read_stamp(prefix: &[u8], order: DateOrder) -> Option<Stamp> {
    let mut found = Found::default();
    let searched = &prefix[..prefix.len().min(MAX_PREFIX_BYTES)];
    for token in searched.split(|&byte| is_separator(byte)) {
        if let Some(instant) = found.add(token, order) {
            return Some(Stamp::Instant(instant));
        }
    }
    found.stamp()
}

/// Parts of a time among the tokens so far.
#[derive(Debug, Default)]
struct Found {
    day: Option<i64>,
    time: Option<Time>,
    /// Set while the last token was a date, which a compact time may follow.
    is_after_date: bool,
    /// Set while the last token was a time: `AM`, a zone or decimals may follow.
    is_after_time: bool,
    named: NamedDate,
}

#[derive(Clone, Copy, Debug)]
struct Time {
    micros: i64,
    has_fraction: bool,
}

/// Date in words, as `Fri Aug  1 2014` or `1 August 2014`.
#[derive(Debug, Default)]
struct NamedDate {
    month: Option<u64>,
    day: Option<u64>,
    year: Option<u16>,
}

impl Found {
    /// Adds a token. Returns the instant that it states by itself.
    fn add(&mut self, token: &[u8], order: DateOrder) -> Option<i64> {
        if token.is_empty() {
            return None;
        }
        let (was_after_date, was_after_time) = (self.is_after_date, self.is_after_time);
        (self.is_after_date, self.is_after_time) = (false, false);
        if was_after_time && self.refine_time(token) {
            return None;
        }
        if let Some(instant) = since_1970(token) {
            return Some(instant);
        }
        if self.time.is_none()
            && let Some(micros) =
                time_of_day(token).or_else(|| compact_time_of_day(token).filter(|_| was_after_date))
        {
            self.set_time(micros, token);
            return None;
        }
        if self.day.is_none()
            && let Some((day, rest)) = date(after_name(token), order)
        {
            self.day = Some(day);
            self.is_after_date = true;
            if rest.is_done() {
                return None;
            }
            return self.time_joined(day, rest);
        }
        if self.day.is_none() {
            self.day = self.named.add(token);
        }
        None
    }

    /// Reads the time that is joined to a date.
    fn time_joined(&mut self, day: i64, mut rest: Digits<'_>) -> Option<i64> {
        let separator = rest.one_of(b"Tt_:-");
        // The device's name may follow behind a plus sign.
        let text = rest.0.strip_suffix(b"+").unwrap_or(rest.0);
        let time = match separator {
            Some(_) => time_of_day(text).or_else(|| compact_time_of_day(text)),
            None => compact_time_of_day(text),
        };
        let Some(micros) = time else {
            // What looked like a date is none.
            self.day = None;
            return None;
        };
        self.day = Some(day);
        self.set_time(micros, text);
        None
    }

    fn set_time(&mut self, micros: i64, text: &[u8]) {
        self.time = Some(Time {
            micros,
            has_fraction: text.contains(&b'.'),
        });
        self.is_after_time = true;
    }

    /// Applies what may follow a time. Returns whether the token did.
    fn refine_time(&mut self, token: &[u8]) -> bool {
        let Some(time) = &mut self.time else {
            return false;
        };
        if token.eq_ignore_ascii_case(b"AM") || token.eq_ignore_ascii_case(b"PM") {
            // Twelve o'clock is the first hour of either half.
            let hours = time.micros % MICROS_OF_HALF_A_DAY;
            let is_afternoon = token.eq_ignore_ascii_case(b"PM");
            time.micros = hours + i64::from(is_afternoon) * MICROS_OF_HALF_A_DAY;
            return true;
        }
        if let Some(ahead) = zone(token) {
            time.micros -= ahead;
            return true;
        }
        let mut digits = Digits(token);
        let is_decimals = matches!(token.len(), 3 | 6) && digits.leading_digits() == token.len();
        if is_decimals && !time.has_fraction {
            time.micros += i64::from(digits.decimals().unwrap_or_default());
            time.has_fraction = true;
            return true;
        }
        false
    }

    fn stamp(&self) -> Option<Stamp> {
        let time = self.time?.micros;
        Some(match self.day {
            Some(day) => Stamp::Instant(day + time),
            None => Stamp::TimeOfDay(time),
        })
    }
}

impl NamedDate {
    /// Adds a token. Returns the start of the day once it is complete.
    fn add(&mut self, token: &[u8]) -> Option<i64> {
        let mut digits = Digits(token);
        let length = digits.leading_digits();
        if length == 0 {
            let name = token.first_chunk::<3>()?;
            if token.iter().all(u8::is_ascii_alphabetic) {
                self.month = self.month.or(month_number(*name));
            }
        } else if length == token.len() && length == 4 {
            self.year = digits.number(4, 4).and_then(year);
        } else if length == token.len()
            && length <= 2
            && (self.month.is_none() || self.day.is_none())
        {
            self.day = digits.number(1, 2);
        }
        start_of(self.year?, self.month?, self.day?)
    }
}

/// Returns a token without the device's name that a plus sign parts from it.
fn after_name(token: &[u8]) -> &[u8] {
    if !token.first().is_some_and(u8::is_ascii_alphabetic) {
        return token;
    }
    match token.iter().position(|&byte| byte == b'+') {
        Some(plus) => &token[plus + 1..],
        None => token,
    }
}

fn is_separator(byte: u8) -> bool {
    byte.is_ascii_whitespace()
        || matches!(
            byte,
            b',' | b';'
                | b'|'
                | b'"'
                | b'\''
                | b'['
                | b']'
                | b'('
                | b')'
                | b'<'
                | b'>'
                | b'{'
                | b'}'
                | b'='
                | b'#'
        )
}
