//! Legal time: local time at a place.
//!
//! The rules are those of the IANA time zone database in the crate jiff, never
//! the machine's own: the same input gives the same plan everywhere.
//!
//! Invariants: every local time is one instant. A time that occurs twice, when
//! clocks are put back, is the first of the two. A time that is skipped, when
//! clocks are put forward, is the first instant after it.

use crate::time::Instant;
use binnacle_compass::time::Timestamp;
use chrono::{Datelike, FixedOffset, NaiveDate, NaiveDateTime, NaiveTime, TimeDelta, Timelike};
use jiff::civil::DateTime;
use jiff::tz::{AmbiguousOffset, Offset, TimeZone};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::OnceLock;

/// A zone of the IANA time zone database, as `Europe/Madrid`.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Zone(&'static NamedZone);

/// A name in the database, and the zone's rules, loaded at first use.
struct NamedZone {
    name: String,
    rules: OnceLock<TimeZone>,
}

/// The reason why a text is not a time zone.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a time zone such as Europe/Madrid")]
pub struct ZoneError(String);

/// Returns all zones, in the order of their names.
fn all() -> &'static [NamedZone] {
    static ALL: OnceLock<Vec<NamedZone>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut names: Vec<String> = jiff::tz::db()
            .available()
            .map(|name| name.as_str().to_owned())
            .collect();
        names.sort_unstable();
        names.dedup();
        let zones = names.into_iter().map(|name| NamedZone {
            name,
            rules: OnceLock::new(),
        });
        zones.collect()
    })
}

impl Zone {
    /// Returns universal time.
    #[allow(clippy::missing_panics_doc, reason = "every database has it")]
    pub fn utc() -> Zone {
        Zone::find("UTC").expect("every time zone database has UTC")
    }

    /// Finds the zone of a name.
    ///
    /// # Errors
    /// Fails when the database does not have it.
    pub fn find(name: &str) -> Result<Zone, ZoneError> {
        let found = all().binary_search_by(|zone| zone.name.as_str().cmp(name));
        found
            .map(|at| Zone(&all()[at]))
            .map_err(|_| ZoneError(name.chars().take(40).collect()))
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        &self.0.name
    }

    /// Returns the local time at an instant.
    pub fn local(self, at: Instant) -> NaiveDateTime {
        let utc = at.0.to_chrono().naive_utc();
        utc + TimeDelta::seconds(self.ahead_s(at))
    }

    /// Seconds ahead of UTC at an instant.
    pub fn ahead_s(self, at: Instant) -> i64 {
        i64::from(self.rules().to_offset(stamp(at.0.micros())).seconds())
    }

    /// Returns the instant of a local time: the first of two, or the first
    /// instant after a skipped one. Years before 1 and after 9999 are clamped.
    pub fn instant(self, local: NaiveDateTime) -> Instant {
        let rules = self.rules();
        match rules.to_ambiguous_timestamp(civil(local)).offset() {
            AmbiguousOffset::Unambiguous { offset }
            | AmbiguousOffset::Fold { before: offset, .. } => at_offset(local, offset),
            AmbiguousOffset::Gap { before, .. } => {
                let later = at_offset(local, before);
                let just_after = stamp(later.0.micros() + 1);
                let skip = rules.preceding(just_after).next();
                skip.map_or(later, |skip| {
                    let micros = skip.timestamp().as_microsecond();
                    Timestamp::from_micros(micros).map_or(later, Instant)
                })
            }
        }
    }

    /// Returns the instant at which a day begins, which is not midnight where
    /// clocks skip it.
    pub fn midnight(self, day: NaiveDate) -> Instant {
        self.instant(day.and_time(NaiveTime::MIN))
    }

    fn rules(self) -> &'static TimeZone {
        self.0.rules.get_or_init(|| {
            TimeZone::get(&self.0.name).expect("the database was asked for its own name")
        })
    }
}

/// The conversions between instants and local time.
impl Instant {
    /// Returns the date in a zone.
    pub fn date(self, zone: Zone) -> NaiveDate {
        zone.local(self).date()
    }

    /// Returns the instant of an hour, 0 to 24, of a day in a zone; [`Zone::instant`]
    /// describes hours that occur twice or never.
    pub fn at(day: NaiveDate, hour: f64, zone: Zone) -> Instant {
        let since_midnight = TimeDelta::seconds((hour * 3600.0).round() as i64);
        zone.instant(day.and_time(NaiveTime::MIN) + since_midnight)
    }

    /// Returns the instant with the local time and offset of a zone.
    #[allow(clippy::missing_panics_doc, reason = "no zone is a day from UTC")]
    pub fn in_zone(self, zone: Zone) -> chrono::DateTime<FixedOffset> {
        let ahead = i32::try_from(zone.ahead_s(self)).ok();
        let ahead = ahead.and_then(FixedOffset::east_opt);
        self.0
            .to_chrono()
            .with_timezone(&ahead.expect("no zone is a day from UTC"))
    }
}

/// Returns the instant in jiff, clamped to its years.
fn stamp(micros: i64) -> jiff::Timestamp {
    let end = if micros < 0 {
        jiff::Timestamp::MIN
    } else {
        jiff::Timestamp::MAX
    };
    jiff::Timestamp::from_microsecond(micros).unwrap_or(end)
}

fn civil(local: NaiveDateTime) -> DateTime {
    let (Ok(year), [month, day, hour, minute, second]) = (
        i16::try_from(local.year()),
        [
            local.month(),
            local.day(),
            local.hour(),
            local.minute(),
            local.second(),
        ]
        .map(|part| i8::try_from(part).expect("months to seconds are below 100")),
    ) else {
        return DateTime::MAX;
    };
    let nanos = i32::try_from(local.nanosecond() % 1_000_000_000).unwrap_or(0);
    DateTime::new(year, month, day, hour, minute, second, nanos).unwrap_or(DateTime::MAX)
}

fn at_offset(local: NaiveDateTime, offset: Offset) -> Instant {
    let micros = local.and_utc().timestamp_micros();
    let epoch = Timestamp::from_micros(0).expect("1970 is a year of this calendar");
    // In seconds, so that values outside the calendar are clamped.
    let seconds = micros.div_euclid(1_000_000) - i64::from(offset.seconds());
    let whole = epoch.plus_seconds(seconds as f64);
    Instant(whole.plus_seconds(micros.rem_euclid(1_000_000) as f64 * 1e-6))
}

impl PartialEq for Zone {
    fn eq(&self, other: &Zone) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Zone {}

impl fmt::Debug for Zone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Zone({})", self.name())
    }
}

impl fmt::Display for Zone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl TryFrom<String> for Zone {
    type Error = ZoneError;
    fn try_from(name: String) -> Result<Zone, ZoneError> {
        Zone::find(&name)
    }
}

impl From<Zone> for String {
    fn from(zone: Zone) -> String {
        zone.name().to_owned()
    }
}
