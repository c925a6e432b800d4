//! Hours of a job, from its beginning to its end.
//!
//! Invariant: the end comes after the beginning, within a day.

use crate::firms::named_port;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::time::Time;
use binnacle_schedule::input::JOB_H;
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::{FixedOffset, SecondsFormat};

/// Longest job, hours.
const MAX_HOURS: f64 = 24.0;

/// Hours of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hours {
    /// Beginning.
    pub from: Time,
    /// End.
    pub until: Time,
}

impl Hours {
    /// Hours from a beginning to an end; the usual three without one.
    pub(crate) fn new(from: Time, until: Option<Time>) -> Hours {
        let usual = || Time(from.0.plus_seconds(JOB_H * 3600.0));
        Hours {
            from,
            until: until.unwrap_or_else(usual),
        }
    }

    /// Validates the end.
    ///
    /// # Errors
    /// [`Error::Invalid`] for `planned_until`.
    pub(crate) fn checked(self) -> Result<Hours> {
        let long_h = self.length_h();
        if long_h > 0.0 && long_h <= MAX_HOURS {
            return Ok(self);
        }
        Err(Error::Invalid {
            field: "planned_until",
            detail: format!(
                "{} is not within {MAX_HOURS} hours after the beginning, {}",
                self.until.0, self.from.0
            ),
        })
    }

    /// Length in microseconds.
    pub(crate) fn length_us(self) -> i64 {
        self.until.0.micros() - self.from.0.micros()
    }

    /// Length in hours.
    pub(crate) fn length_h(self) -> f64 {
        self.until.0.seconds_since(self.from.0) / 3600.0
    }

    /// Returns hours of this length from another beginning.
    pub(crate) fn moved_to(self, from: Time) -> Hours {
        let until = Time(from.0.plus_seconds(self.length_h() * 3600.0));
        Hours { from, until }
    }

    /// Describes the hours in the legal time of a port, however it is named; in UTC for an
    /// unknown one.
    pub fn describe(self, port: &str) -> String {
        let zone = named_port(port).map_or_else(Zone::utc, |port| port.zone);
        let [from, until] = [self.from, self.until].map(|at| Instant(at.0).in_zone(zone));
        let ends = if from.date_naive() == until.date_naive() {
            until.format("%H:%M")
        } else {
            until.format("%Y-%m-%d %H:%M")
        };
        let begins = from.format("%Y-%m-%d %H:%M");
        if named_port(port).is_none() {
            return format!("{begins} to {ends} UTC");
        }
        format!(
            "{begins} to {ends}, port's time (UTC{})",
            from.format("%:z")
        )
    }
}

/// Writes an instant in the legal time of a port, with its offset; `None` for an unknown port.
pub(crate) fn local_time(port: &str, at: Time) -> Option<String> {
    let there = Instant(at.0).in_zone(named_port(port)?.zone);
    Some(there.to_rfc3339_opts(SecondsFormat::Secs, false))
}

/// Writes an instant as clocks show it that are so many seconds ahead of UTC; `None` for no
/// possible offset.
pub(crate) fn at_offset(at: Time, ahead_s: i64) -> Option<String> {
    let offset = FixedOffset::east_opt(i32::try_from(ahead_s).ok()?)?;
    let there = at.0.to_chrono().with_timezone(&offset);
    Some(there.to_rfc3339_opts(SecondsFormat::Secs, false))
}

/// Seconds by which a port's legal time is ahead of UTC at an instant; `None` for an unknown port.
pub(crate) fn utc_offset_s(port: &str, at: Time) -> Option<i64> {
    Some(named_port(port)?.zone.ahead_s(Instant(at.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(text: &str) -> Time {
        Time(Instant::parse(text).unwrap().0)
    }

    #[test]
    fn hours_are_described_in_the_ports_time() {
        let job = Hours::new(time("2026-12-08T22:00:00Z"), None);
        assert_eq!(
            job.describe("Rotterdam (NLRTM)"),
            "2026-12-08 23:00 to 2026-12-09 02:00, port's time (UTC+01:00)"
        );
        assert_eq!(
            job.describe("SGSIN"),
            "2026-12-09 06:00 to 09:00, port's time (UTC+08:00)"
        );
        assert_eq!(
            job.describe("the roads"),
            "2026-12-08 22:00 to 2026-12-09 01:00 UTC"
        );
    }

    #[test]
    fn a_job_ends_after_it_begins_within_a_day() {
        let from = time("2026-12-08T22:00:00Z");
        for (until, is_good) in [
            ("2026-12-08T22:00:00Z", false),
            ("2026-12-08T22:01:00Z", true),
            ("2026-12-09T22:00:00Z", true),
            ("2026-12-09T22:01:00Z", false),
        ] {
            let hours = Hours::new(from, Some(time(until)));
            assert_eq!(hours.checked().is_ok(), is_good, "{until}");
        }
    }
}
