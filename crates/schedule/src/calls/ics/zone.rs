//! Time zones as a calendar defines them: one offset, or two with yearly rules.
//!
//! Only the rules of zones in use are read: `FREQ=YEARLY` with `BYMONTH` and
//! `BYDAY` of a weekday, counted from either end of the month. Any other rule
//! is refused, since it could put times off by an hour.

use super::line::Line;
use crate::calls::FileError;
use chrono::{Datelike, Days, NaiveDate, NaiveDateTime, Weekday};
use std::collections::BTreeMap;

/// The most offsets of one zone. Zones in use have two, and far fewer than this
/// with all their past. Each time in the file is compared with every one of
/// them.
const MAX_OFFSETS: usize = 200;

/// A time zone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Zone {
    /// The offsets; at least one.
    observed: Vec<Observance>,
}

/// An offset and its beginning.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Observance {
    begins: NaiveDateTime,
    offset_s: i64,
    /// The rule of its yearly beginning.
    yearly: Option<YearlyRule>,
}

/// A weekday of a month, each year.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct YearlyRule {
    month: u32,
    weekday: Weekday,
    /// Number within the month; counted from its end, if negative.
    which: i32,
}

impl Zone {
    /// Seconds ahead of UTC at a local time, by the observance that began last.
    pub(super) fn offset_s(&self, local: NaiveDateTime) -> i64 {
        let last = self
            .observed
            .iter()
            .filter_map(|own| Some((own.last_before(local)?, own.offset_s)));
        last.max()
            .map_or(self.observed[0].offset_s, |(_, offset_s)| offset_s)
    }
}

impl Observance {
    fn last_before(&self, local: NaiveDateTime) -> Option<NaiveDateTime> {
        let Some(rule) = self.yearly else {
            return (self.begins <= local).then_some(self.begins);
        };
        let years = [local.year(), local.year() - 1];
        let onsets = years
            .iter()
            .filter_map(|year| Some(day_in(*year, rule)?.and_time(self.begins.time())));
        onsets
            .filter(|onset| *onset <= local && *onset >= self.begins)
            .max()
    }
}

/// Returns the day of a rule in a year.
fn day_in(year: i32, rule: YearlyRule) -> Option<NaiveDate> {
    let YearlyRule {
        month,
        weekday,
        which,
    } = rule;
    if which > 0 {
        return NaiveDate::from_weekday_of_month_opt(year, month, weekday, which as u8);
    }
    let next = if month == 12 {
        (year + 1, 1)
    } else {
        (year, month + 1)
    };
    let last = NaiveDate::from_ymd_opt(next.0, next.1, 1)?.pred_opt()?;
    let back = (7 + last.weekday().num_days_from_monday() - weekday.num_days_from_monday()) % 7;
    last.checked_sub_days(Days::new(
        u64::from(back) + 7 * u64::from((-which - 1).unsigned_abs()),
    ))
}

/// Reads the zones that a calendar defines, by name.
pub(super) fn zones(lines: &[Line]) -> Result<BTreeMap<String, Zone>, FileError> {
    let mut zones = BTreeMap::new();
    let mut begun: Option<(usize, String, Vec<Observance>)> = None;
    let mut part: Option<(Option<NaiveDateTime>, Option<i64>, Option<&Line>)> = None;
    for line in lines {
        match (&mut begun, line.name.as_str(), line.value.as_str()) {
            (_, "BEGIN", "VTIMEZONE") => begun = Some((line.number, String::new(), Vec::new())),
            (Some(_), "END", "VTIMEZONE") => {
                let (number, name, observed) = begun.take().unwrap_or_default();
                if observed.is_empty() {
                    return Err(FileError::new(number, "VTIMEZONE", "has no offset"));
                }
                zones.insert(name, Zone { observed });
            }
            (Some((_, name, _)), "TZID", value) => value.clone_into(name),
            (Some(_), "BEGIN", "STANDARD" | "DAYLIGHT") => part = Some((None, None, None)),
            (Some((_, _, observed)), "END", "STANDARD" | "DAYLIGHT") => {
                let (Some(begins), Some(offset_s), rule) = part.take().unwrap_or_default() else {
                    return Err(FileError::new(
                        line.number,
                        &line.value,
                        "has no DTSTART or no TZOFFSETTO",
                    ));
                };
                let yearly = rule.map(yearly).transpose()?;
                if observed.len() == MAX_OFFSETS {
                    let what = format!("more than {MAX_OFFSETS} offsets in one time zone");
                    return Err(FileError::new(line.number, &line.value, what));
                }
                observed.push(Observance {
                    begins,
                    offset_s,
                    yearly,
                });
            }
            (Some(_), name, value) => {
                let Some(part) = &mut part else { continue };
                let wrong =
                    || FileError::new(line.number, name, format!("{value:?} is not understood"));
                match name {
                    "DTSTART" => {
                        let begins = NaiveDateTime::parse_from_str(value, "%Y%m%dT%H%M%S");
                        part.0 = Some(begins.map_err(|_| wrong())?);
                    }
                    "TZOFFSETTO" => part.1 = Some(offset(value).ok_or_else(wrong)?),
                    "RRULE" => part.2 = Some(line),
                    "RDATE" => return Err(wrong()),
                    _ => {}
                }
            }
            _ => {}
        }
    }
    Ok(zones)
}

/// Parses `+0100`, with optional seconds.
fn offset(text: &str) -> Option<i64> {
    let digits = text.strip_prefix(['+', '-'])?;
    if !(digits.len() == 4 || digits.len() == 6)
        || !digits.bytes().all(|byte| byte.is_ascii_digit())
    {
        return None;
    }
    let part = |at: usize| {
        digits
            .get(at..at + 2)
            .map_or(Some(0), |two| two.parse::<i64>().ok())
    };
    let seconds = part(0)? * 3600 + part(2)? * 60 + part(4)?;
    (seconds <= 18 * 3600).then_some(if text.starts_with('-') {
        -seconds
    } else {
        seconds
    })
}

fn yearly(line: &Line) -> Result<YearlyRule, FileError> {
    let wrong = || {
        let what = format!(
            "{:?} is not a yearly rule of a month and a weekday",
            line.value
        );
        FileError::new(line.number, "RRULE", what)
    };
    let (mut month, mut day) = (None, None);
    for part in line.value.split(';') {
        match part.split_once('=').ok_or_else(wrong)? {
            ("FREQ", "YEARLY") | ("INTERVAL", "1") | ("WKST", _) => {}
            ("BYMONTH", text) => month = text.parse().ok().filter(|month| (1..=12).contains(month)),
            ("BYDAY", text) => day = by_day(text),
            _ => return Err(wrong()),
        }
    }
    let (month, (weekday, which)) = month.zip(day).ok_or_else(wrong)?;
    Ok(YearlyRule {
        month,
        weekday,
        which,
    })
}

/// Parses `-1SU` and the like.
fn by_day(text: &str) -> Option<(Weekday, i32)> {
    let (which, day) = text.split_at_checked(text.len().checked_sub(2)?)?;
    let which: i32 = which
        .parse()
        .ok()
        .filter(|which: &i32| (1..=4).contains(&which.abs()))?;
    let weekday = match day {
        "MO" => Weekday::Mon,
        "TU" => Weekday::Tue,
        "WE" => Weekday::Wed,
        "TH" => Weekday::Thu,
        "FR" => Weekday::Fri,
        "SA" => Weekday::Sat,
        "SU" => Weekday::Sun,
        _ => return None,
    };
    Some((weekday, which))
}
