//! The duration of an event without an end (RFC 5545, section 3.3.6).

use super::line::Line;
use crate::calls::FileError;

/// Parses hours from `P2DT12H`, `PT90M`, `P1W` and the like.
///
/// # Errors
/// Fails when it is something else, negative, or more than [`MAX_HOURS`].
pub(super) fn hours(line: &Line) -> Result<f64, FileError> {
    let hours = read(&line.value).filter(|hours| *hours <= MAX_HOURS);
    hours.ok_or_else(|| {
        let what = format!(
            "{:?} is not a duration of a year at most, as P2DT12H",
            line.value
        );
        FileError::new(line.number, &line.name, what)
    })
}

/// The longest call, a year.
const MAX_HOURS: f64 = 366.0 * 24.0;

fn read(text: &str) -> Option<f64> {
    let text = text.strip_prefix('+').unwrap_or(text).strip_prefix('P')?;
    let (days, times) = match text.split_once('T') {
        Some((days, times)) if !times.is_empty() => (days, times),
        Some(_) => return None,
        None => (text, ""),
    };
    if days.is_empty() && times.is_empty() {
        return None;
    }
    let units = |of: &str, units: &[(char, f64)]| {
        let (mut rest, mut sum, mut units) = (of, 0.0, units.iter());
        while !rest.is_empty() {
            let end = rest.find(|c: char| !c.is_ascii_digit())?;
            let (digits, unit) = rest.split_at(end);
            // Larger units come first, each at most once.
            let (letter, hours) = units.find(|(letter, _)| unit.starts_with(*letter))?;
            sum += f64::from(digits.parse::<u32>().ok()?) * hours;
            rest = &unit[letter.len_utf8()..];
        }
        Some(sum)
    };
    let days = match days.strip_suffix('W') {
        Some(_) if !times.is_empty() => return None,
        Some(_) => units(days, &[('W', 7.0 * 24.0)]),
        None => units(days, &[('D', 24.0)]),
    };
    Some(days? + units(times, &[('H', 1.0), ('M', 1.0 / 60.0), ('S', 1.0 / 3600.0)])?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_is_weeks_or_days_and_a_time() {
        for (text, hours) in [
            ("P1W", 168.0),
            ("P2DT12H", 60.0),
            ("PT90M", 1.5),
            ("+PT1H30M36S", 1.51),
            ("P15DT5H0M20S", 365.0 + 20.0 / 3600.0),
        ] {
            let read = read(text).unwrap();
            assert!((read - hours).abs() < 1e-9, "{text}: {read}");
        }
        for wrong in [
            "",
            "P",
            "PT",
            "P1",
            "1D",
            "-P1D",
            "P1DT",
            "PT1M1H",
            "P1H",
            "P1W1D",
            "P1WT1H",
            "PxD",
            "PT1H1H",
            "P99999999999D",
            "P€",
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
