//! Requests for a new order and for its offer to firms.

use crate::work_orders::request_schema::LimitsSchema;
use binnacle_adjustment::adjust::Limits;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{optional_text, text};
use binnacle_platform::ids::{CompassId, FirmId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// No order is for later.
const MAX_DAYS_AHEAD: f64 = 730.0;

/// An order to be written.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewWorkOrder, example = json!({
    "vessel_id": "0199aa00-0000-7000-8000-000000000001",
    "compass_id": "0199aa00-0000-7000-8000-000000000002",
    "port": "Bilbao", "berth": "A5", "planned_at": "2026-11-22T08:00:00Z",
    "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114", "firm": "Nervión Compass"
}))]
pub struct NewOrder {
    /// The vessel.
    pub vessel_id: VesselId,
    /// One of her compasses.
    pub compass_id: CompassId,
    /// The port.
    #[schema(min_length = 1, max_length = 200)]
    pub port: String,
    /// The berth.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// When it is to be done.
    pub planned_at: Time,
    /// Who is to do it.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_name: Option<String>,
    /// The number of their licence.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_licence: Option<String>,
    /// Their firm.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub firm: Option<String>,
    /// The firms that it is offered to; the order is `planned` without, `offered` with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offer: Option<NewOffer>,
    /// What a plan must keep to, where it is not the usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<LimitsSchema>)]
    pub limits: Option<Limits>,
}

/// An order to be offered to firms.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewOffer, example = json!({
    "firms": ["0199aa00-0000-7000-8000-000000000003"], "answer_within_hours": 48
}))]
pub struct NewOffer {
    /// The firms, in the order in which they are asked: 1 to 20 that you work with.
    pub firms: Vec<FirmId>,
    /// So long each has for an answer, 1 to 720 hours; then the next is asked.
    #[serde(default = "default_answer_hours")]
    #[schema(minimum = 1, maximum = 720)]
    pub answer_within_hours: u32,
    /// Ask all of them at once: the first to accept has it.
    #[serde(default)]
    pub at_once: bool,
    /// What is said to them.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
    /// The fees that a plan has for some of them; for others, what their terms say for a
    /// compass alone.
    #[serde(skip)]
    pub fees_eur: BTreeMap<FirmId, f64>,
}

pub(crate) fn default_answer_hours() -> u32 {
    48
}

/// Refuses a time that nobody plans for.
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
    /// The order, its words trimmed.
    pub fn checked(self, now: Time) -> Result<NewOrder> {
        let past = |grace_h: f64| now.0.seconds_since(self.planned_at.0) > grace_h * 3600.0;
        // Who is on the quay already may write the order afterwards; who is asked for one needs
        // time to answer, but for a page that was open for a while.
        if past(if self.offer.is_some() { 1.0 } else { 24.0 }) {
            return Err(Error::Invalid {
                field: "planned_at",
                detail: format!("{} is over", self.planned_at.0),
            });
        }
        require_near_date(self.planned_at, now)?;
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
            ..self
        })
    }
}
