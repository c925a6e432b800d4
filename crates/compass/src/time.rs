//! Instants in UTC, to the microsecond.

use chrono::{DateTime, Datelike, NaiveDate, NaiveDateTime, SecondsFormat, TimeZone, Utc};
use serde::{Deserialize, Serialize};
use std::fmt;

/// An instant as microseconds since 1970-01-01T00:00:00Z, between the years
/// 1 and 9999; RFC 3339 in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(
    feature = "openapi",
    schema(as = Time, description = "An instant, RFC 3339.", value_type = String, format = DateTime, example = "2026-11-21T07:00:00Z")
)]
#[serde(try_from = "String", into = "String")]
pub struct Timestamp(i64);

/// Error of a value that is not an instant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TimestampError {
    /// The text has no time zone and is valid otherwise.
    #[error("{0:?} has no time zone; write Z for UTC or an offset such as +01:00")]
    NoZone(String),
    /// The text is a date alone.
    #[error("{0:?} has no time of day; write it as in 2026-12-01T08:00:00Z")]
    NoTimeOfDay(String),
    /// The text is not RFC 3339.
    #[error("{0:?} is not an RFC 3339 time such as 2026-12-01T08:00:00Z")]
    NotRfc3339(String),
    /// The instant lies outside the years 1 to 9999.
    #[error("{0} microseconds since 1970 lies outside the years 1 to 9999")]
    OutOfRange(i64),
}

/// 0001-01-01T00:00:00Z.
const FIRST_MICROS: i64 = -62_135_596_800_000_000;
/// Characters of an invalid text that the error quotes.
const QUOTED_CHARS: usize = 40;
/// 9999-12-31T23:59:59.999999Z.
const LAST_MICROS: i64 = 253_402_300_799_999_999;

impl Timestamp {
    /// Makes an instant from microseconds since 1970-01-01T00:00:00Z.
    ///
    /// # Errors
    /// Fails when it lies outside the years 1 to 9999.
    pub fn from_micros(micros: i64) -> Result<Timestamp, TimestampError> {
        if (FIRST_MICROS..=LAST_MICROS).contains(&micros) {
            Ok(Timestamp(micros))
        } else {
            Err(TimestampError::OutOfRange(micros))
        }
    }

    /// Reads RFC 3339 with any offset.
    ///
    /// # Errors
    /// Fails when the text is not RFC 3339; a missing time zone or time of day has an error
    /// of its own.
    pub fn parse(text: &str) -> Result<Timestamp, TimestampError> {
        let given = text.trim();
        if let Ok(parsed) = DateTime::parse_from_rfc3339(given) {
            return Timestamp::from_micros(parsed.timestamp_micros());
        }
        let without = given.replace(' ', "T");
        let lacks_zone = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%dT%H:%M"]
            .iter()
            .any(|format| NaiveDateTime::parse_from_str(&without, format).is_ok());
        let short = text.chars().take(QUOTED_CHARS).collect();
        Err(if lacks_zone {
            TimestampError::NoZone(short)
        } else if given.parse::<NaiveDate>().is_ok() {
            TimestampError::NoTimeOfDay(short)
        } else {
            TimestampError::NotRfc3339(short)
        })
    }

    /// Microseconds since 1970-01-01T00:00:00Z.
    #[inline]
    pub fn micros(self) -> i64 {
        self.0
    }

    /// Seconds since `earlier`, negative when that is later.
    #[inline]
    pub fn seconds_since(self, earlier: Timestamp) -> f64 {
        (self.0 - earlier.0) as f64 * 1e-6
    }

    /// The instant `seconds` later, held within the years 1 to 9999.
    pub fn plus_seconds(self, seconds: f64) -> Timestamp {
        let moved = self.0.saturating_add((seconds * 1e6).round() as i64);
        Timestamp(moved.clamp(FIRST_MICROS, LAST_MICROS))
    }

    /// Year with its elapsed fraction, the time scale of field models.
    pub fn decimal_year(self) -> f64 {
        let year = self.to_chrono().year();
        let start = year_start_micros(year);
        let length = year_start_micros(year + 1) - start;
        f64::from(year) + (self.0 - start) as f64 / length as f64
    }

    /// Converts the instant to chrono's type.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
    pub fn to_chrono(self) -> DateTime<Utc> {
        DateTime::from_timestamp_micros(self.0).expect("the range was checked when it was made")
    }
}

fn year_start_micros(year: i32) -> i64 {
    Utc.with_ymd_and_hms(year, 1, 1, 0, 0, 0)
        .single()
        .expect("the first of January exists in every year")
        .timestamp_micros()
}

impl fmt::Display for Timestamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            &self
                .to_chrono()
                .to_rfc3339_opts(SecondsFormat::AutoSi, true),
        )
    }
}

impl TryFrom<String> for Timestamp {
    type Error = TimestampError;
    fn try_from(text: String) -> Result<Timestamp, TimestampError> {
        Timestamp::parse(&text)
    }
}

impl From<Timestamp> for String {
    fn from(time: Timestamp) -> String {
        time.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rfc_3339_comes_back_as_it_went() {
        for text in [
            "2026-11-21T07:00:00Z",
            "1999-12-31T23:59:59.999999Z",
            "0001-01-01T00:00:00Z",
        ] {
            assert_eq!(Timestamp::parse(text).unwrap().to_string(), text);
        }
        assert!(Timestamp::parse("21.11.2026").is_err());
    }

    #[test]
    fn a_time_without_a_zone_is_refused_as_such() {
        for text in [
            "2026-12-01T08:00:00",
            "2026-12-01 08:00",
            "2026-12-01T08:00",
        ] {
            let refused = Timestamp::parse(text);
            assert_eq!(refused, Err(TimestampError::NoZone(text.to_owned())));
        }
        let date = "2026-12-01";
        let refused = Timestamp::parse(date);
        assert_eq!(refused, Err(TimestampError::NoTimeOfDay(date.to_owned())));
        for text in ["tomorrow", "2026-13-01", ""] {
            let refused = Timestamp::parse(text);
            assert_eq!(refused, Err(TimestampError::NotRfc3339(text.to_owned())));
        }
    }

    #[test]
    fn the_middle_of_a_leap_year_is_its_half() {
        let noon = Timestamp::parse("2024-07-02T00:00:00Z").unwrap();
        assert!((noon.decimal_year() - 2024.5).abs() < 1e-12);
    }

    #[test]
    fn instants_beyond_the_calendar_are_refused() {
        assert!(Timestamp::from_micros(i64::MAX).is_err());
        assert!(Timestamp::from_micros(i64::MIN).is_err());
    }
}
