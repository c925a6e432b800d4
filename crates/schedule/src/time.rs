//! Instants and sums of money in their JSON form.
//!
//! Invariants: an [`Instant`] was written with its time zone, and an [`Eur`] is
//! not negative. Money is counted in cents.

use binnacle_compass::time::{Timestamp, TimestampError};
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};
use std::fmt;

/// An instant in RFC 3339.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Instant(pub Timestamp);

impl Instant {
    /// Parses RFC 3339.
    ///
    /// # Errors
    /// Fails when it is something else, with an error of its own for a missing zone.
    pub fn parse(text: &str) -> Result<Instant, TimestampError> {
        Timestamp::parse(text).map(Instant)
    }

    /// Hours since `earlier`, negative when that is later.
    pub fn hours_since(self, earlier: Instant) -> f64 {
        self.0.seconds_since(earlier.0) / 3600.0
    }

    /// Returns the instant `hours` later.
    pub fn plus_hours(self, hours: f64) -> Instant {
        Instant(self.0.plus_seconds(hours * 3600.0))
    }

    /// Returns the date in UTC.
    pub fn utc_date(self) -> NaiveDate {
        self.0.to_chrono().date_naive()
    }
}

impl fmt::Display for Instant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl TryFrom<String> for Instant {
    type Error = TimestampError;
    fn try_from(text: String) -> Result<Instant, TimestampError> {
        Instant::parse(&text)
    }
}

impl From<Instant> for String {
    fn from(instant: Instant) -> String {
        instant.to_string()
    }
}

/// A sum of money, 0 to 1 000 000 euros; euros in JSON, cents inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Eur(i64);

/// The reason why a number is not a sum of money.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{0} is not within 0 to 1000000 euros")]
pub struct EurError(f64);

impl Eur {
    /// Returns an amount of whole euros, up to 65 535.
    pub const fn whole(euros: u16) -> Eur {
        Eur(euros as i64 * 100)
    }

    /// Returns the amount in cents.
    pub fn cents(self) -> i64 {
        self.0
    }
}

impl TryFrom<f64> for Eur {
    type Error = EurError;
    fn try_from(euros: f64) -> Result<Eur, EurError> {
        let valid = (0.0..=1e6).contains(&euros);
        valid
            .then_some(Eur((euros * 100.0).round() as i64))
            .ok_or(EurError(euros))
    }
}

impl From<Eur> for f64 {
    fn from(eur: Eur) -> f64 {
        eur.0 as f64 / 100.0
    }
}

/// Cents as euros, for JSON.
pub(crate) fn euros(cents: i64) -> f64 {
    cents as f64 / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zone::Zone;

    #[test]
    fn a_date_is_that_of_the_zone() {
        let evening = Instant::parse("2026-12-01T20:00:00Z").unwrap();
        let [singapore, houston] =
            ["Asia/Singapore", "America/Chicago"].map(|name| Zone::find(name).unwrap());
        assert_eq!(evening.date(singapore).to_string(), "2026-12-02");
        assert_eq!(evening.date(houston).to_string(), "2026-12-01");
        let morning = Instant::at(evening.date(singapore), 8.0, singapore);
        assert_eq!(morning.to_string(), "2026-12-02T00:00:00Z");
        let there = evening.in_zone(houston).to_rfc3339();
        assert_eq!(there, "2026-12-01T14:00:00-06:00");
    }

    #[test]
    fn a_negative_fee_is_no_fee() {
        assert!(serde_json::from_str::<Eur>("-0.01").is_err());
        assert_eq!(
            serde_json::from_str::<Eur>("1800.5").unwrap().cents(),
            180_050
        );
    }
}
