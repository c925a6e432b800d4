//! Dates and times of day, UTC, as receivers give them.

/// A time of day with microseconds; second 60 is a leap second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TimeOfDay {
    hour: u8,
    minute: u8,
    second: u8,
    micro: u32,
}

impl TimeOfDay {
    /// `None` unless hour < 24, minute < 60, second ≤ 60 and micro < 1,000,000.
    pub fn new(hour: u8, minute: u8, second: u8, micro: u32) -> Option<TimeOfDay> {
        if hour > 23 || minute > 59 || second > 60 || micro > 999_999 {
            return None;
        }
        Some(TimeOfDay {
            hour,
            minute,
            second,
            micro,
        })
    }

    /// 0 to 23.
    pub fn hour(self) -> u8 {
        self.hour
    }

    /// 0 to 59.
    pub fn minute(self) -> u8 {
        self.minute
    }

    /// 0 to 60.
    pub fn second(self) -> u8 {
        self.second
    }

    /// 0 to 999,999.
    pub fn micro(self) -> u32 {
        self.micro
    }
}

/// A day of the Gregorian calendar, years 1 to 9999.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    year: u16,
    month: u8,
    day: u8,
}

impl Date {
    /// `None` for a day that the calendar does not have.
    pub fn new(year: u16, month: u8, day: u8) -> Option<Date> {
        let in_range = (1..=9999).contains(&year) && (1..=12).contains(&month);
        if !in_range || day == 0 || day > days_in_month(year, month) {
            return None;
        }
        Some(Date { year, month, day })
    }

    /// 1 to 9999.
    pub fn year(self) -> u16 {
        self.year
    }

    /// 1 to 12.
    pub fn month(self) -> u8 {
        self.month
    }

    /// 1 to 31.
    pub fn day(self) -> u8 {
        self.day
    }
}

fn days_in_month(year: u16, month: u8) -> u8 {
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Microseconds since 1970-01-01T00:00:00Z. A leap second falls on the second
/// after it, as in Unix time.
pub fn unix_micros(date: Date, time: TimeOfDay) -> i64 {
    let seconds =
        i64::from(time.hour) * 3600 + i64::from(time.minute) * 60 + i64::from(time.second);
    (days_since_1970(date) * 86_400 + seconds) * 1_000_000 + i64::from(time.micro)
}

/// Date and time of day of an instant; `None` outside the years 1 to 9999.
pub fn from_unix_micros(micros: i64) -> Option<(Date, TimeOfDay)> {
    const MICROS_A_DAY: i64 = 86_400_000_000;
    let date = date_of_day(micros.div_euclid(MICROS_A_DAY))?;
    let within = micros.rem_euclid(MICROS_A_DAY);
    let second_of_day = (within / 1_000_000) as u32;
    let time = TimeOfDay::new(
        (second_of_day / 3600) as u8,
        (second_of_day / 60 % 60) as u8,
        (second_of_day % 60) as u8,
        (within % 1_000_000) as u32,
    )?;
    Some((date, time))
}

/// Days since 1970-01-01, counting years from March so that the leap day is the
/// last of its year (Hinnant, "chrono-Compatible Low-Level Date Algorithms").
fn days_since_1970(date: Date) -> i64 {
    let month = i64::from(date.month);
    let year = i64::from(date.year) - i64::from(month <= 2);
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + i64::from(date.day) - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    era * 146_097 + day_of_era - 719_468
}

/// The inverse of [`days_since_1970`], same source.
fn date_of_day(days: i64) -> Option<Date> {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    Date::new(u16::try_from(year).ok()?, month as u8, day as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_instants_have_their_unix_time() {
        let at = |y, mo, d, h, mi, s| {
            unix_micros(
                Date::new(y, mo, d).unwrap(),
                TimeOfDay::new(h, mi, s, 0).unwrap(),
            )
        };
        assert_eq!(at(1970, 1, 1, 0, 0, 0), 0);
        assert_eq!(at(2000, 2, 29, 12, 0, 0), 951_825_600_000_000);
        assert_eq!(at(2026, 11, 21, 7, 0, 0), 1_795_244_400_000_000);
        assert_eq!(at(1, 1, 1, 0, 0, 0), -62_135_596_800_000_000);
        assert_eq!(at(9999, 12, 31, 23, 59, 59), 253_402_300_799_000_000);
    }

    #[test]
    fn every_day_from_1900_to_2200_comes_back() {
        let mut days = days_since_1970(Date::new(1900, 1, 1).unwrap());
        let last = days_since_1970(Date::new(2200, 1, 1).unwrap());
        while days < last {
            let date = date_of_day(days).unwrap();
            assert_eq!(days_since_1970(date), days);
            days += 1;
        }
    }

    #[test]
    fn a_day_the_calendar_lacks_is_refused() {
        assert!(Date::new(2026, 2, 29).is_none());
        assert!(Date::new(1900, 2, 29).is_none());
        assert!(Date::new(2024, 2, 29).is_some());
        assert!(Date::new(2024, 13, 1).is_none());
        assert!(Date::new(0, 1, 1).is_none());
        assert!(TimeOfDay::new(24, 0, 0, 0).is_none());
        assert!(TimeOfDay::new(23, 59, 60, 0).is_some());
        assert_eq!(from_unix_micros(i64::MIN), None);
    }
}
