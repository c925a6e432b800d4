//! Requests for a new order and for its offer to firms.

use crate::work_orders::payload::hours::Hours;
use binnacle_adjustment::adjust::Limits;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{optional_text, text};
use binnacle_platform::ids::{CompassId, FirmId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Latest time of an order, days ahead.
const MAX_DAYS_AHEAD: f64 = 730.0;

/// Request for a new order.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewWorkOrder, example = json!({
    "vessel_id": "0199aa00-0000-7000-8000-000000000001",
    "compass_id": "0199aa00-0000-7000-8000-000000000002",
    "port": "Bilbao", "berth": "A5", "planned_at": "2026-11-22T08:00:00Z",
    "planned_until": "2026-11-22T11:00:00Z",
    "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114", "firm": "Nervión Compass"
}))]
pub struct NewOrder {
    /// The vessel.
    pub vessel_id: VesselId,
    /// One of its compasses.
    pub compass_id: CompassId,
    /// The port.
    #[schema(min_length = 1, max_length = 200)]
    pub port: String,
    /// The berth.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// Time of the job.
    pub planned_at: Time,
    /// End of the job, within 24 hours; three hours later by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_until: Option<Time>,
    /// Adjuster.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_name: Option<String>,
    /// Licence number.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_licence: Option<String>,
    /// Firm of the adjuster.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub firm: Option<String>,
    /// Offer to firms; the order is `planned` without, `offered` with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offer: Option<NewOffer>,
    /// Limits on plans, if not the usual ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
}

/// Request to offer an order to firms.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewOffer, example = json!({
    "firms": ["0199aa00-0000-7000-8000-000000000003"], "answer_within_hours": 48
}))]
pub struct NewOffer {
    /// Firms in the order of the offers: 1 to 20 that work for you.
    pub firms: Vec<FirmId>,
    /// Time for an answer, 1 to 720 hours; then the next firm follows.
    #[serde(default = "default_answer_hours")]
    #[schema(minimum = 1, maximum = 720)]
    pub answer_within_hours: u32,
    /// Offer to all of them at once: the first to accept gets the order.
    #[serde(default)]
    pub at_once: bool,
    /// Text for the firms.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
    /// Fees from a plan; other firms are offered the fee of their terms for a single compass.
    #[serde(skip)]
    pub fees_eur: BTreeMap<FirmId, f64>,
    /// Teams from a plan; of other firms any suitable team comes.
    #[serde(skip)]
    pub teams: BTreeMap<FirmId, String>,
}

pub(crate) fn default_answer_hours() -> u32 {
    48
}

/// Refuses a time too far ahead.
pub(crate) fn require_near_date(planned_at: Time, now: Time) -> Result<()> {
    if planned_at.0.seconds_since(now.0) <= MAX_DAYS_AHEAD * 86_400.0 {
        return Ok(());
    }
    Err(Error::Invalid {
        field: "planned_at",
        detail: format!("{} is more than {MAX_DAYS_AHEAD} days ahead", planned_at.0),
    })
}

impl NewOrder {
    /// Hours of the job.
    pub(crate) fn hours(&self) -> Hours {
        Hours::new(self.planned_at, self.planned_until)
    }

    /// Validates the request.
    pub fn checked(self, now: Time) -> Result<NewOrder> {
        let past = |grace_h: f64| now.0.seconds_since(self.planned_at.0) > grace_h * 3600.0;
        // An order without an offer may be entered afterwards. Firms need time to answer an
        // offer; one hour covers a form that was open for a while.
        if past(if self.offer.is_some() { 1.0 } else { 24.0 }) {
            return Err(Error::Invalid {
                field: "planned_at",
                detail: format!("{} is over", self.planned_at.0),
            });
        }
        require_near_date(self.planned_at, now)?;
        let hours = self.hours().checked()?;
        let optional = |field, value: Option<String>| optional_text(field, value.as_deref());
        if let Some(limits) = &self.limits {
            limits.check_ranges().map_err(|error| Error::Invalid {
                field: "limits",
                detail: error.to_string(),
            })?;
        }
        Ok(NewOrder {
            port: text("port", &self.port)?,
            berth: optional("berth", self.berth)?,
            adjuster_name: optional("adjuster_name", self.adjuster_name)?,
            adjuster_licence: optional("adjuster_licence", self.adjuster_licence)?,
            firm: optional("firm", self.firm)?,
            planned_until: Some(hours.until),
            ..self
        })
    }
}
