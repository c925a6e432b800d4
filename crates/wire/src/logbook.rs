//! What people report for the magnetic logbook, on board or ashore.
//!
//! What always holds: a report that [`Report::checked`] gave back is one line of a
//! logbook: it lies in this era and does not begin in the future, ends no earlier than it
//! begins, and its words are trimmed, few, and without control characters.

use binnacle_compass::logbook::{Cargo, LogbookEntry, LogbookError, LogbookKind};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Longest name of a hatch or a port, and of a person, in characters.
pub const MAX_NAME: usize = 100;
/// Longest note, in characters.
pub const MAX_NOTE: usize = 1000;

/// The first instant of GPS time, 1980-01-06: nothing here is older.
const EARLIEST_MICROS: i64 = 315_964_800_000_000;
/// A reporter's clock, or the time zone in mind, may be wrong by so much.
const AHEAD_S: f64 = 86_400.0;
/// Cargo and docks last for weeks or months: an end further ahead is of a year mistaken.
const LONGEST_AHEAD_S: f64 = 366.0 * 86_400.0;

/// One event, as its reporter writes it down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// What happened.
    pub kind: LogbookKind,
    /// When it happened, or began.
    pub from: Timestamp,
    /// When it ended; none for an event or for what still goes on.
    #[serde(default)]
    pub to: Option<Timestamp>,
    /// What the magnetic cargo was.
    #[serde(default)]
    pub cargo: Option<Cargo>,
    /// Where the magnetic cargo lies.
    #[serde(default)]
    pub hatch: Option<String>,
    /// The port, where there is one.
    #[serde(default)]
    pub port: Option<String>,
    /// In the reporter's own words.
    #[serde(default)]
    pub note: String,
}

/// What is wrong with a report.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {detail}")]
pub struct ReportError {
    /// The field at fault.
    pub field: &'static str,
    /// What is wrong with it.
    pub detail: String,
}

impl Report {
    /// The report with its words trimmed, if it can be one.
    ///
    /// # Errors
    /// [`ReportError`] with the first field that cannot be.
    pub fn checked(self, now: Timestamp) -> Result<Report, ReportError> {
        let latest = now.plus_seconds(AHEAD_S);
        if self.from.micros() < EARLIEST_MICROS {
            return Err(error("from", format!("{} is before 1980-01-06", self.from)));
        }
        if self.from > latest {
            return Err(error("from", format!("{} is yet to come", self.from)));
        }
        let report = Report {
            hatch: optional("hatch", self.hatch.as_deref())?,
            port: optional("port", self.port.as_deref())?,
            note: words("note", &self.note, MAX_NOTE)?,
            ..self
        };
        if report.hatch.is_some() && report.kind != LogbookKind::MagneticCargo {
            return Err(error("hatch", "only magnetic cargo lies in one"));
        }
        match report.entry().checked() {
            Ok(_) => Ok(report),
            Err(LogbookError::EndsBeforeItBegins { from, to }) => {
                Err(error("to", format!("{to} is before from, {from}")))
            }
            Err(LogbookError::UnexpectedCargo) => Err(error("cargo", "only magnetic cargo is one")),
        }
    }

    /// The report, if its end is none of a year mistaken. Asked of who writes it down: what was
    /// kept once is carried on, and may be taken back.
    ///
    /// # Errors
    /// [`ReportError`] when it ends more than a year after `now`.
    pub fn ending_within_a_year(self, now: Timestamp) -> Result<Report, ReportError> {
        let far = self.to.filter(|to| *to > now.plus_seconds(LONGEST_AHEAD_S));
        far.map_or(Ok(self), |to| {
            Err(error("to", format!("{to} is more than a year ahead")))
        })
    }

    /// What an analysis makes of it: everything but the words.
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

/// The name of a person who reports, trimmed; empty when none is given.
///
/// # Errors
/// [`ReportError`] when it is too long or has control characters.
pub fn reporter(name: &str) -> Result<String, ReportError> {
    let name = words("reporter", name, MAX_NAME)?;
    if name.contains('\n') {
        return Err(error("reporter", "is more than one line"));
    }
    Ok(name)
}

/// A name on one line; none when nothing is in it.
fn optional(field: &'static str, name: Option<&str>) -> Result<Option<String>, ReportError> {
    let name = words(field, name.unwrap_or_default(), MAX_NAME)?;
    if name.contains('\n') {
        return Err(error(field, "is more than one line"));
    }
    Ok(Some(name).filter(|name| !name.is_empty()))
}

fn words(field: &'static str, text: &str, most: usize) -> Result<String, ReportError> {
    let text = text.trim().replace("\r\n", "\n");
    if text.chars().count() > most {
        return Err(error(field, format!("is longer than {most} characters")));
    }
    if text.chars().any(|c| c.is_control() && c != '\n') {
        return Err(error(field, "has control characters"));
    }
    Ok(text)
}

fn error(field: &'static str, detail: impl Into<String>) -> ReportError {
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
    fn words_are_trimmed_and_empty_ones_are_none() {
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
    fn an_end_may_be_foreseen_for_a_year() {
        let end = Timestamp::parse("2027-11-22T07:00:00Z").unwrap();
        assert_eq!(read(&json!({ "to": end })).unwrap().to, Some(end));
    }

    #[test]
    fn a_reporters_name_stands_on_one_line() {
        assert_eq!(reporter(" Li, 2nd officer ").unwrap(), "Li, 2nd officer");
        assert!(reporter("a\nb").is_err());
    }
}
