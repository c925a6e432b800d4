//! Reports for the magnetic logbook, from the vessel or from the office.
//!
//! Invariants of a report that [`Report::checked`] returned: it does not begin
//! before GPS time or in the future, and ends no earlier than it begins. Its
//! texts are trimmed, short, and without control characters.

use binnacle_compass::logbook::{Cargo, LogbookEntry, LogbookError, LogbookKind};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// The longest name of a hatch, port or person, in characters.
pub const MAX_NAME: usize = 100;
/// The longest note, in characters.
pub const MAX_NOTE: usize = 1000;

/// The first instant of GPS time, 1980-01-06: the earliest time of a report.
const EARLIEST_MICROS: i64 = 315_964_800_000_000;
/// Tolerance for a reporter's wrong clock or time zone.
const CLOCK_TOLERANCE_S: f64 = 86_400.0;
/// Cargo and docks last for weeks or months: an end further ahead has a wrong
/// year.
const MAX_END_AHEAD_S: f64 = 366.0 * 86_400.0;

/// One event, as its reporter writes it down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = LogbookReport))]
pub struct Report {
    /// The kind of event.
    pub kind: LogbookKind,
    /// Time of the event, or its start.
    pub from: Timestamp,
    /// Its end; none for an instant or an event that lasts.
    #[serde(default)]
    pub to: Option<Timestamp>,
    /// The kind of magnetic cargo.
    #[serde(default)]
    pub cargo: Option<Cargo>,
    /// The hatch in which the magnetic cargo lies.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 100, example = "2"))]
    pub hatch: Option<String>,
    /// The port, if in one.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 100))]
    pub port: Option<String>,
    /// The reporter's own words.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 1000, default = ""))]
    pub note: String,
}

/// The reason for refusing a report.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {detail}")]
pub struct ReportError {
    /// The field at fault.
    pub field: &'static str,
    /// The fault in it.
    pub detail: String,
}

impl Report {
    /// Returns the report with its texts trimmed.
    ///
    /// # Errors
    /// [`ReportError`] with the first bad field.
    pub fn checked(self, now: Timestamp) -> Result<Report, ReportError> {
        check_time("from", self.from, now)?;
        let report = Report {
            hatch: optional("hatch", self.hatch.as_deref())?,
            port: optional("port", self.port.as_deref())?,
            note: trimmed("note", &self.note, MAX_NOTE)?,
            ..self
        };
        if report.hatch.is_some() && report.kind != LogbookKind::MagneticCargo {
            return Err(error("hatch", "is only allowed for magnetic cargo"));
        }
        match report.entry().checked() {
            Ok(_) => Ok(report),
            Err(LogbookError::EndsBeforeItBegins { from, to }) => {
                Err(error("to", format!("{to} is before from, {from}")))
            }
            Err(LogbookError::UnexpectedCargo) => {
                Err(error("cargo", "is only allowed for magnetic cargo"))
            }
        }
    }

    /// Returns the report, unless its end is too far ahead. Only a new report
    /// is checked: one that was stored may still be sent again or withdrawn.
    ///
    /// # Errors
    /// [`ReportError`] when it ends more than a year after `now`.
    pub fn ending_within_a_year(self, now: Timestamp) -> Result<Report, ReportError> {
        let far = self.to.filter(|to| *to > now.plus_seconds(MAX_END_AHEAD_S));
        far.map_or(Ok(self), |to| {
            Err(error("to", format!("{to} is more than a year ahead")))
        })
    }

    /// The entry for the analysis, without the texts.
    pub fn entry(&self) -> LogbookEntry {
        LogbookEntry {
            from: self.from,
            to: self.to,
            kind: self.kind,
            cargo: self.cargo,
            note: String::new(),
        }
    }
}

/// Checks that an event is neither before GPS time nor in the future.
pub(crate) fn check_time(
    field: &'static str,
    time: Timestamp,
    now: Timestamp,
) -> Result<(), ReportError> {
    if time.micros() < EARLIEST_MICROS {
        return Err(error(field, format!("{time} is before 1980-01-06")));
    }
    if time > now.plus_seconds(CLOCK_TOLERANCE_S) {
        return Err(error(field, format!("{time} is in the future")));
    }
    Ok(())
}

/// Returns the reporter's name, trimmed; empty when none is given.
///
/// # Errors
/// [`ReportError`] when it is too long or has control characters.
pub fn reporter(name: &str) -> Result<String, ReportError> {
    line("reporter", name, MAX_NAME)
}

/// Returns a name on one line; `None` when it is empty.
pub(crate) fn optional(
    field: &'static str,
    name: Option<&str>,
) -> Result<Option<String>, ReportError> {
    let name = line(field, name.unwrap_or_default(), MAX_NAME)?;
    Ok(Some(name).filter(|name| !name.is_empty()))
}

/// Returns a text on one line, trimmed.
pub(crate) fn line(field: &'static str, text: &str, most: usize) -> Result<String, ReportError> {
    let text = trimmed(field, text, most)?;
    if text.contains('\n') {
        return Err(error(field, "must be a single line"));
    }
    Ok(text)
}

pub(crate) fn trimmed(field: &'static str, text: &str, most: usize) -> Result<String, ReportError> {
    let text = text.trim().replace("\r\n", "\n");
    if text.chars().count() > most {
        return Err(error(field, format!("is longer than {most} characters")));
    }
    if text.chars().any(|c| c.is_control() && c != '\n') {
        return Err(error(field, "has control characters"));
    }
    Ok(text)
}

pub(crate) fn error(field: &'static str, detail: impl Into<String>) -> ReportError {
    ReportError {
        field,
        detail: detail.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn read(changes: &Value) -> Result<Report, ReportError> {
        let mut report = json!({
            "kind": "magnetic_cargo", "from": "2026-11-20T00:00:00Z", "cargo": "steel",
        });
        for (name, value) in changes.as_object().unwrap() {
            report[name] = value.clone();
        }
        let report: Report = serde_json::from_value(report).unwrap();
        let now = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        report.checked(now)?.ending_within_a_year(now)
    }

    #[test]
    fn texts_are_trimmed_and_empty_ones_are_none() {
        let changes = json!({ "hatch": " 2 ", "port": "  ", "note": " coils\r\nin the hold " });
        let report = read(&changes).unwrap();
        assert_eq!(report.hatch.as_deref(), Some("2"));
        assert_eq!(report.port, None);
        assert_eq!(report.note, "coils\nin the hold");
    }

    #[test]
    fn each_field_is_refused_by_its_name() {
        for (field, changes) in [
            ("from", json!({ "from": "2026-11-23T00:00:00Z" })),
            ("from", json!({ "from": "0026-11-20T00:00:00Z" })),
            ("to", json!({ "to": "2026-11-19T23:59:59Z" })),
            ("to", json!({ "to": "2027-11-22T07:00:01Z" })),
            ("cargo", json!({ "kind": "lightning" })),
            (
                "hatch",
                json!({ "kind": "berth", "cargo": null, "hatch": "2" }),
            ),
            ("hatch", json!({ "hatch": "2\n3" })),
            ("port", json!({ "port": "x".repeat(101) })),
            ("note", json!({ "note": "x".repeat(1001) })),
            ("note", json!({ "note": "a\u{0}b" })),
        ] {
            assert_eq!(read(&changes).unwrap_err().field, field, "{changes}");
        }
    }

    #[test]
    fn an_end_may_lie_a_year_ahead() {
        let end = Timestamp::parse("2027-11-22T07:00:00Z").unwrap();
        assert_eq!(read(&json!({ "to": end })).unwrap().to, Some(end));
    }

    #[test]
    fn a_reporters_name_stands_on_one_line() {
        assert_eq!(reporter(" Li, 2nd officer ").unwrap(), "Li, 2nd officer");
        assert!(reporter("a\nb").is_err());
    }
}
