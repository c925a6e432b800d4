//! Calendar dates and times for sentences. A fleet sends so many positions that
//! a calendar library would be too slow.

use binnacle_compass::time::Timestamp;

/// UTC, rounded down to a hundredth of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CalendarTime {
    pub(crate) year: u64,
    pub(crate) month: u64,
    pub(crate) day: u64,
    pub(crate) hour: u64,
    pub(crate) minute: u64,
    /// Hundredths of a second, from 0 to 5999.
    pub(crate) centisecond: u64,
}

impl CalendarTime {
    /// Converts a time; years before 0 are not supported.
    pub(crate) fn from_timestamp(time: Timestamp) -> CalendarTime {
        let micros = time.micros();
        let (year, month, day) = civil(micros.div_euclid(86_400_000_000));
        let centiseconds = micros.rem_euclid(86_400_000_000) as u64 / 10_000;
        CalendarTime {
            year,
            month,
            day,
            hour: centiseconds / 360_000,
            minute: centiseconds / 6_000 % 60,
            centisecond: centiseconds % 6_000,
        }
    }
}

/// The Gregorian date of a number of days since 1970 (Hinnant,
/// "chrono-compatible low-level date algorithms", `civil_from_days`).
fn civil(days: i64) -> (u64, u64, u64) {
    let shifted = (days + 719_468).max(0) as u64;
    let era = shifted / 146_097;
    let day_of_era = shifted % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 {
        shifted_month + 3
    } else {
        shifted_month - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    (year, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_agree_with_rfc_3339_over_two_centuries() {
        for step in 0..20_000_i64 {
            let micros = -2_208_988_800_000_000 + step * 315_569_520_000;
            let time = Timestamp::from_micros(micros).unwrap();
            let at = CalendarTime::from_timestamp(time);
            let seconds = at.centisecond / 100;
            let text = format!(
                "{:04}-{:02}-{:02}T{:02}:{:02}:{seconds:02}",
                at.year, at.month, at.day, at.hour, at.minute
            );
            assert!(time.to_string().starts_with(&text), "{time} {text}");
        }
    }
}
