//! Azimuths with their observer, from the vessel or from the office.
//!
//! Invariants of a report that [`AzimuthReport::checked`] returned: its observation makes an
//! [`Azimuth`], is not in the future, and has an observer. Its texts are trimmed, short, and
//! without control characters.

use crate::logbook::{MAX_NOTE, ReportError, check_time, error, line, optional, trimmed};
use binnacle_compass::azimuth::{Azimuth, AzimuthError, AzimuthForm};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// The longest initials, in characters.
pub const MAX_INITIALS: usize = 10;

/// An observation of the compass error, and its observer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct AzimuthReport {
    /// The observation.
    #[serde(flatten)]
    pub observation: AzimuthForm,
    /// The observer's initials.
    #[cfg_attr(
        feature = "openapi",
        schema(min_length = 1, max_length = 10, example = "LW")
    )]
    pub observer: String,
    /// The observer's own words.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 1000, default = ""))]
    pub remark: String,
}

impl AzimuthReport {
    /// Returns the report with its texts trimmed.
    ///
    /// # Errors
    /// [`ReportError`] with the first bad field; with the field `confirmed`, a question that
    /// the observer answers by confirming the observation.
    pub fn checked(self, now: Timestamp) -> Result<AzimuthReport, ReportError> {
        check_time("time", self.observation.time, now)?;
        let observer = line("observer", &self.observer, MAX_INITIALS)?;
        if observer.is_empty() {
            return Err(error("observer", "the observer's initials are missing"));
        }
        let name = optional("name", self.observation.name.as_deref())?;
        let report = AzimuthReport {
            observation: AzimuthForm {
                name,
                ..self.observation
            },
            observer,
            remark: trimmed("remark", &self.remark, MAX_NOTE)?,
        };
        Azimuth::new(report.observation.clone()).map_err(|fault| refusal(&fault))?;
        Ok(report)
    }

    /// Returns the azimuth of a report that was checked before. Its questions, if any, were
    /// answered then.
    ///
    /// # Errors
    /// [`ReportError`] when the observation is impossible all the same.
    pub fn azimuth(&self) -> Result<Azimuth, ReportError> {
        let observation = AzimuthForm {
            confirmed: true,
            ..self.observation.clone()
        };
        Azimuth::new(observation).map_err(|fault| refusal(&fault))
    }
}

fn refusal(fault: &AzimuthError) -> ReportError {
    error(fault.field, fault.problem.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn read(changes: &Value) -> Result<AzimuthReport, ReportError> {
        let mut report = json!({
            "time": "2026-11-21T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
            "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "observer": " LW ",
            "remark": " hazy\r\n",
        });
        for (name, value) in changes.as_object().unwrap() {
            report[name] = value.clone();
        }
        let report: AzimuthReport = serde_json::from_value(report).unwrap();
        report.checked(Timestamp::parse("2026-11-21T12:00:00Z").unwrap())
    }

    #[test]
    fn texts_are_trimmed_and_the_azimuth_is_worked_out() {
        let report = read(&json!({})).unwrap();
        assert_eq!((&*report.observer, &*report.remark), ("LW", "hazy"));
        assert!(report.azimuth().unwrap().result().gyro_error_deg.is_none());
    }

    #[test]
    fn each_field_is_refused_by_its_name() {
        for (field, changes) in [
            ("time", json!({ "time": "2026-11-23T10:00:00Z" })),
            ("time", json!({ "time": "2026-11-21T22:00:00Z" })),
            ("time", json!({ "time": "1979-11-21T10:00:00Z" })),
            ("observer", json!({ "observer": "  " })),
            ("observer", json!({ "observer": "L\nW" })),
            ("observer", json!({ "observer": "Second officer" })),
            ("remark", json!({ "remark": "x".repeat(1001) })),
            ("lat", json!({ "lat": 95.0 })),
            ("name", json!({ "name": "Vega" })),
            ("confirmed", json!({ "compass_bearing_deg": 15.0 })),
        ] {
            assert_eq!(read(&changes).unwrap_err().field, field, "{changes}");
        }
    }

    #[test]
    fn a_stored_report_needs_no_second_confirmation() {
        let question = json!({ "compass_bearing_deg": 15.0, "confirmed": true });
        let mut report = read(&question).unwrap();
        report.observation.confirmed = false;
        assert!(report.azimuth().is_ok());
    }
}
