//! Azimuths as requests and responses carry them.

use crate::logbook::AuthorKind;
use binnacle_compass::azimuth::{AzimuthForm, AzimuthKind, AzimuthResult, HorizonSight};
use binnacle_compass::time::Timestamp;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::time;
use binnacle_platform::ids::{AzimuthId, CompassId};
use binnacle_platform::time::Time;
use binnacle_wire::azimuth::AzimuthReport;
use binnacle_wire::logbook::ReportError;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// An azimuth to be entered.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(from = "NewAzimuthForm")]
#[schema(example = json!({
    "time": "2026-11-20T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
    "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "observer": "LW"
}))]
pub(super) struct NewAzimuth {
    /// The observation and its observer.
    #[serde(flatten)]
    report: AzimuthReport,
    /// The compass that was observed; only a vessel's single compass need not be named.
    pub(super) compass_id: Option<CompassId>,
}

/// An azimuth to be entered, field by field. One that is not known may be a known one
/// misspelt, and is refused; azimuths from on board, which newer agents write, are not
/// read by this.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an azimuth")]
struct NewAzimuthForm {
    time: Timestamp,
    lat: f64,
    lon: f64,
    kind: AzimuthKind,
    compass_heading_deg: f64,
    compass_bearing_deg: Option<f64>,
    gyro_heading_deg: Option<f64>,
    gyro_bearing_deg: Option<f64>,
    horizon: Option<HorizonSight>,
    height_of_eye_m: Option<f64>,
    name: Option<String>,
    true_bearing_deg: Option<f64>,
    altitude_deg: Option<f64>,
    #[serde(default)]
    confirmed: bool,
    observer: String,
    #[serde(default)]
    remark: String,
    compass_id: Option<CompassId>,
}

impl From<NewAzimuthForm> for NewAzimuth {
    fn from(written: NewAzimuthForm) -> NewAzimuth {
        let observation = AzimuthForm {
            time: written.time,
            lat: written.lat,
            lon: written.lon,
            kind: written.kind,
            compass_heading_deg: written.compass_heading_deg,
            compass_bearing_deg: written.compass_bearing_deg,
            gyro_heading_deg: written.gyro_heading_deg,
            gyro_bearing_deg: written.gyro_bearing_deg,
            horizon: written.horizon,
            height_of_eye_m: written.height_of_eye_m,
            name: written.name,
            true_bearing_deg: written.true_bearing_deg,
            altitude_deg: written.altitude_deg,
            confirmed: written.confirmed,
        };
        NewAzimuth {
            report: AzimuthReport {
                observation,
                observer: written.observer,
                remark: written.remark,
            },
            compass_id: written.compass_id,
        }
    }
}

impl NewAzimuth {
    /// Returns the observation and its observer.
    pub(super) fn report(self) -> AzimuthReport {
        self.report
    }
}

/// An azimuth of a vessel, with its errors.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub(super) struct AzimuthEntry {
    /// The azimuth's id.
    pub(super) id: AzimuthId,
    /// The compass that was observed.
    pub(super) compass_id: CompassId,
    /// The observation and its observer.
    #[serde(flatten)]
    pub(super) report: AzimuthReport,
    /// Compass error and gyro error.
    pub(super) result: AzimuthResult,
    /// Time at which the server received it.
    pub(super) created_at: Time,
    /// Name of the person who entered it; the observer's initials for one from on board.
    pub(super) created_by: String,
    /// Place of its author.
    pub(super) author: AuthorKind,
    /// Time of withdrawal, from which it has no effect.
    #[schema(required)]
    pub(super) withdrawn_at: Option<Time>,
    /// Person who withdrew it.
    #[schema(required)]
    pub(super) withdrawn_by: Option<String>,
    /// Reason for the withdrawal.
    #[schema(required)]
    pub(super) withdrawal_reason: Option<String>,
}

/// A page of a vessel's azimuths.
#[derive(Serialize, ToSchema)]
pub(super) struct AzimuthList {
    /// Azimuths, the latest first.
    pub(super) items: Vec<AzimuthEntry>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// Reason for which an azimuth is withdrawn.
#[derive(Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = AzimuthWithdrawal)]
pub(super) struct Withdrawal {
    /// In a few words.
    #[schema(max_length = 200)]
    pub(super) reason: Option<String>,
}

/// Selection of azimuths.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Of this compass only.
    compass: Option<CompassId>,
    /// Observed at this instant or later, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    from: Option<String>,
    /// Observed before this instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    to: Option<String>,
    /// Includes withdrawn azimuths; true by default.
    withdrawn: Option<bool>,
}

/// Selection of azimuths, parsed and checked.
pub(super) struct CheckedFilter {
    pub(super) compass: Option<CompassId>,
    pub(super) from: Option<Time>,
    pub(super) to: Option<Time>,
    pub(super) withdrawn: bool,
}

impl Filter {
    pub(super) fn checked(self) -> Result<CheckedFilter> {
        Ok(CheckedFilter {
            compass: self.compass,
            from: time("from", self.from.as_deref())?.map(Time),
            to: time("to", self.to.as_deref())?.map(Time),
            withdrawn: self.withdrawn.unwrap_or(true),
        })
    }
}

impl AzimuthEntry {
    /// Returns `after` of the page that begins behind it.
    pub(super) fn cursor(&self) -> String {
        format!("{}.{}", self.report.observation.time.micros(), self.id)
    }
}

/// Returns the refusal of an invalid azimuth.
pub(super) fn invalid_report(error: ReportError) -> Error {
    Error::Invalid {
        field: error.field,
        detail: error.detail,
    }
}
