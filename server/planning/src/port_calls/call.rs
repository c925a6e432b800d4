//! A port call: requests, content and API types.

use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{Amended, never_null, optional_text, text, time};
use binnacle_platform::ids::{CallId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::calls::{self, BerthHeading, CallError, HeadingSource};
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::time::Instant;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// Port call to enter.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewPortCall, example = json!({
    "port": "NLRTM", "berth": "Maasvlakte 3", "eta": "2026-12-08T06:00:00Z",
    "eta_uncertainty_h": 12, "etd": "2026-12-10T18:00:00Z"
}))]
pub(super) struct NewCall {
    /// Reference in the source system; port and ETA by default.
    #[schema(max_length = 200)]
    pub(super) reference: Option<String>,
    /// UN/LOCODE of the port.
    #[schema(value_type = String, example = "NLRTM")]
    pub(super) port: PortCode,
    /// The berth.
    #[schema(max_length = 200)]
    pub(super) berth: Option<String>,
    /// Expected arrival alongside, with a time zone.
    #[schema(value_type = Time)]
    pub(super) eta: Instant,
    /// Uncertainty of the arrival, hours: 95 % of arrivals lie within it.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 720)]
    pub(super) eta_uncertainty_h: f64,
    /// Expected departure, at most 120 days after arrival.
    #[schema(value_type = Time)]
    pub(super) etd: Instant,
    /// Uncertainty of the departure, hours: 95 % of departures lie within it.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 720)]
    pub(super) etd_uncertainty_h: f64,
    /// True heading of the vessel alongside, where known.
    #[schema(minimum = 0, maximum = 360)]
    pub(super) berth_heading_deg: Option<f64>,
}

/// Changes to a port call. A field that is left out stays; null removes the berth or the heading
/// there.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PortCallAmendment, example = json!({
    "eta": "2026-12-09T02:00:00Z", "etd": "2026-12-11T12:00:00Z"
}))]
pub(super) struct Amendment {
    /// UN/LOCODE of the port.
    #[serde(default, deserialize_with = "never_null")]
    #[schema(value_type = Option<String>, nullable = false)]
    port: Option<PortCode>,
    /// Berth.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200)]
    berth: Amended<String>,
    /// Expected arrival alongside, with a time zone.
    #[serde(default, deserialize_with = "never_null")]
    #[schema(value_type = Option<Time>, nullable = false)]
    eta: Option<Instant>,
    /// Half-width of the 95 % interval of the arrival, hours.
    #[serde(default, deserialize_with = "never_null")]
    #[schema(minimum = 0, maximum = 720, nullable = false)]
    eta_uncertainty_h: Option<f64>,
    /// Expected departure, with a time zone.
    #[serde(default, deserialize_with = "never_null")]
    #[schema(value_type = Option<Time>, nullable = false)]
    etd: Option<Instant>,
    /// Half-width of the 95 % interval of the departure, hours.
    #[serde(default, deserialize_with = "never_null")]
    #[schema(minimum = 0, maximum = 720, nullable = false)]
    etd_uncertainty_h: Option<f64>,
    /// True heading alongside, degrees.
    #[serde(default)]
    #[schema(value_type = Option<f64>, minimum = 0, maximum = 360)]
    berth_heading_deg: Amended<f64>,
}

/// Content of a port call, whatever its source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PortCallContent)]
pub struct Content {
    /// Reference in the source system.
    pub reference: String,
    /// UN/LOCODE of the port.
    #[schema(value_type = String)]
    pub port: PortCode,
    /// The berth.
    #[schema(required)]
    pub berth: Option<String>,
    /// Expected arrival alongside.
    pub eta: Time,
    /// Uncertainty of the arrival, hours: 95 % of arrivals lie within it.
    pub eta_uncertainty_h: f64,
    /// Expected departure.
    pub etd: Time,
    /// Uncertainty of the departure, hours: 95 % of departures lie within it.
    pub etd_uncertainty_h: f64,
    /// True heading of the vessel alongside, as given.
    #[schema(required)]
    pub berth_heading_deg: Option<f64>,
}

/// Source of a port call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = PortCallSource)]
pub enum Source {
    /// A single request.
    Api,
    /// A CSV file.
    Csv,
    /// A calendar.
    Icalendar,
}

/// Port call of a vessel.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PortCall {
    /// The call's id.
    pub id: CallId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// Content of the call.
    #[serde(flatten)]
    pub content: Content,
    /// Name of the port.
    pub port_name: &'static str,
    /// Heading of the vessel alongside, given or learnt; `null` when unknown.
    #[schema(required)]
    pub berth_heading: Option<CallBerthHeading>,
    /// Current source of the call.
    pub source: Source,
    /// Number of the revision, from 1.
    pub revision: u32,
    /// Time of entry.
    pub created_at: Time,
    /// Name of its author.
    pub created_by: String,
    /// Time of the last amendment.
    #[schema(required)]
    pub revised_at: Option<Time>,
    /// Author of the last amendment.
    #[schema(required)]
    pub revised_by: Option<String>,
    /// Time of withdrawal, from which the call no longer counts.
    #[schema(required)]
    pub withdrawn_at: Option<Time>,
    /// Name of the person who withdrew it.
    #[schema(required)]
    pub withdrawn_by: Option<String>,
    /// Reason of the withdrawal.
    #[schema(required)]
    pub withdrawal_reason: Option<String>,
}

/// A heading alongside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = CallBerthHeading)]
pub struct CallBerthHeading {
    /// Degrees, true.
    pub heading_deg: f64,
    /// Source of the heading.
    pub source: CallBerthHeadingSource,
}

/// Source of a heading alongside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CallBerthHeadingSource)]
pub enum CallBerthHeadingSource {
    /// Given for this call.
    Given,
    /// Read alongside during this call.
    Read,
    /// From earlier calls of the fleet at the same berth.
    Berth,
    /// From earlier calls of the fleet at the same port.
    Port,
}

/// A page of calls.
#[derive(Serialize, ToSchema)]
#[schema(as = PortCallList)]
pub(super) struct CallList {
    /// Calls, the earliest arrival first.
    pub(super) items: Vec<PortCall>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// Port call with its revisions.
#[derive(Serialize, ToSchema)]
#[schema(as = RevisedPortCall)]
pub(super) struct RevisedCall {
    /// Current call.
    #[serde(flatten)]
    pub(super) call: PortCall,
    /// Revisions, the first one first.
    pub(super) revisions: Vec<Revision>,
}

/// Revision of a call.
#[derive(Serialize, ToSchema)]
#[schema(as = PortCallRevision)]
pub(super) struct Revision {
    /// Number of the revision, from 1.
    pub(super) number: u32,
    /// Time of the revision.
    pub(super) at: Time,
    /// Source of the revision.
    pub(super) source: Source,
    /// Name of its author.
    pub(super) author_name: String,
    /// Content of the call at that revision.
    pub(super) call: Content,
}

/// Reason for withdrawing a call.
#[derive(Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PortCallWithdrawal, example = json!({ "reason": "Charter cancelled" }))]
pub(super) struct Withdrawal {
    /// The reason, in a few words.
    #[schema(max_length = 200)]
    pub(super) reason: Option<String>,
}

/// Filter of a list of port calls.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Only calls that have not ended before this instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    from: Option<String>,
    /// Only calls that begin before this instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    to: Option<String>,
    /// Only calls at this port, UN/LOCODE.
    port: Option<String>,
    /// `true` to list withdrawn calls too; by default they are left out.
    withdrawn: Option<bool>,
}

/// Parsed filter of a list of port calls.
pub(super) struct CheckedFilter {
    pub(super) from: Option<Time>,
    pub(super) to: Option<Time>,
    pub(super) port: Option<PortCode>,
    pub(super) withdrawn: bool,
}

impl NewCall {
    /// Returns the content of the call, if it is valid at this time.
    pub(super) fn checked(self, now: Time) -> Result<Content> {
        let reference = optional_text("reference", self.reference.as_deref())?;
        let content = Content {
            reference: reference.unwrap_or_else(|| format!("{} {}", self.port, self.eta)),
            port: self.port,
            berth: self.berth,
            eta: Time(self.eta.0),
            eta_uncertainty_h: self.eta_uncertainty_h,
            etd: Time(self.etd.0),
            etd_uncertainty_h: self.etd_uncertainty_h,
            berth_heading_deg: self.berth_heading_deg,
        };
        content
            .to_schedule_call("", "")
            .check_horizon(Instant(now.0))
            .map_err(refuse_call)?;
        content.checked(now)
    }
}

impl Amendment {
    /// Returns the content with the changes. A past call may be corrected if its times stay.
    pub(super) fn applied_to(self, before: &Content, now: Time) -> Result<Content> {
        let content = Content {
            reference: before.reference.clone(),
            port: self.port.unwrap_or(before.port),
            berth: self.berth.over(before.berth.clone()),
            eta: self.eta.map_or(before.eta, |eta| Time(eta.0)),
            eta_uncertainty_h: self.eta_uncertainty_h.unwrap_or(before.eta_uncertainty_h),
            etd: self.etd.map_or(before.etd, |etd| Time(etd.0)),
            etd_uncertainty_h: self.etd_uncertainty_h.unwrap_or(before.etd_uncertainty_h),
            berth_heading_deg: self.berth_heading_deg.over(before.berth_heading_deg),
        };
        let times_stay = (content.eta, content.etd) == (before.eta, before.etd);
        if !times_stay {
            content
                .to_schedule_call("", "")
                .check_horizon(Instant(now.0))
                .map_err(refuse_call)?;
        }
        content.checked(if times_stay { before.eta } else { now })
    }
}

impl Content {
    /// Returns the call with its texts trimmed, if it is valid at this time.
    pub(super) fn checked(mut self, now: Time) -> Result<Content> {
        self.reference = text("reference", &self.reference)?;
        self.berth = optional_text("berth", self.berth.as_deref())?;
        if ports::find(self.port).is_none() {
            return Err(Error::Invalid {
                field: "port",
                detail: ports::describe_unknown(self.port),
            });
        }
        self.to_schedule_call("", "")
            .checked(Instant(now.0))
            .map_err(refuse_call)?;
        Ok(self)
    }

    /// Returns the call as the schedule represents it.
    pub fn to_schedule_call(&self, id: &str, vessel: &str) -> calls::PortCall {
        calls::PortCall {
            id: id.to_owned(),
            name: None,
            vessel: vessel.to_owned(),
            port: self.port,
            berth: self.berth.clone(),
            eta: Instant(self.eta.0),
            eta_uncertainty_h: self.eta_uncertainty_h,
            etd: Instant(self.etd.0),
            etd_uncertainty_h: self.etd_uncertainty_h,
            berth_heading_deg: self.berth_heading_deg,
        }
    }

    /// Returns the content of a call from a file.
    pub(super) fn from_file(call: calls::PortCall) -> Content {
        Content {
            reference: call.id,
            port: call.port,
            berth: call.berth,
            eta: Time(call.eta.0),
            eta_uncertainty_h: call.eta_uncertainty_h,
            etd: Time(call.etd.0),
            etd_uncertainty_h: call.etd_uncertainty_h,
            berth_heading_deg: call.berth_heading_deg,
        }
    }
}

impl PortCall {
    /// Returns the cursor of the page after this call.
    pub(super) fn cursor(&self) -> String {
        format!("{}.{}", self.content.eta.0.micros(), self.id)
    }
}

impl Filter {
    pub(super) fn checked(self) -> Result<CheckedFilter> {
        let port = self.port.as_deref().map(PortCode::parse).transpose();
        Ok(CheckedFilter {
            from: time("from", self.from.as_deref())?.map(Time),
            to: time("to", self.to.as_deref())?.map(Time),
            port: port.map_err(|error| Error::Invalid {
                field: "port",
                detail: error.to_string(),
            })?,
            withdrawn: self.withdrawn.unwrap_or(false),
        })
    }
}

/// Returns the refusal of an invalid port call.
pub(super) fn refuse_call(error: CallError) -> Error {
    Error::Invalid {
        field: error.field,
        detail: error.detail,
    }
}

impl From<BerthHeading> for CallBerthHeading {
    fn from(learnt: BerthHeading) -> CallBerthHeading {
        CallBerthHeading {
            heading_deg: learnt.heading_deg,
            source: match learnt.source {
                HeadingSource::Given => CallBerthHeadingSource::Given,
                HeadingSource::Berth => CallBerthHeadingSource::Berth,
                HeadingSource::Port => CallBerthHeadingSource::Port,
            },
        }
    }
}
