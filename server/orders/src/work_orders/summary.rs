//! Summary of an order, as lists show it.

use crate::work_orders::offers::{Offer, OfferState};
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::payload::hours::{Hours, at_offset, local_time, utc_offset_s};
use crate::work_orders::payload::port_call::CallFit;
use crate::work_orders::state::State;
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// Summary of an order.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = WorkOrderSummary)]
pub(crate) struct Summary {
    /// The order's id.
    pub id: OrderId,
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// The operator's name.
    pub operator_name: String,
    /// The vessel.
    pub vessel_id: VesselId,
    /// The vessel's name.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// The compass's name.
    pub compass_name: String,
    /// Present state.
    pub state: State,
    /// The port.
    pub port: String,
    /// The berth.
    #[schema(required)]
    pub berth: Option<String>,
    /// Time of the job.
    pub planned_at: Time,
    /// End of the job.
    pub planned_until: Time,
    /// Time of the job in the port's legal time; `null` if the port is unknown.
    #[schema(required, example = "2026-12-08T08:00:00+01:00")]
    #[sqlx(skip)]
    pub planned_at_local: Option<String>,
    /// End of the job in the port's legal time.
    #[schema(required, example = "2026-12-08T11:00:00+01:00")]
    #[sqlx(skip)]
    pub planned_until_local: Option<String>,
    /// Time of the job as the port's clocks would have shown it when it was agreed; `null` unless
    /// its legal time has changed since. The job stays at its instant.
    #[schema(required)]
    #[sqlx(skip)]
    pub agreed_at_local: Option<String>,
    /// Seconds by which the port's legal time was ahead of UTC when the time was agreed.
    #[serde(skip)]
    pub agreed_utc_offset_s: Option<i64>,
    /// Name of the adjuster.
    #[schema(required)]
    pub adjuster_name: Option<String>,
    /// Licence number.
    #[schema(required)]
    pub adjuster_licence: Option<String>,
    /// Firm of the adjuster.
    #[schema(required)]
    pub firm: Option<String>,
    /// Firm that has accepted the order.
    #[schema(required)]
    pub firm_id: Option<FirmId>,
    /// Deadline for an answer: the firm's to an offer or another time, or the operator's to a
    /// proposal.
    #[schema(required)]
    pub answer_by: Option<Time>,
    /// Fit of its time to the port call, if that has moved since the time was agreed.
    #[schema(required)]
    pub call_fit: Option<CallFit>,
    /// Time of creation.
    pub created_at: Time,
    /// Author.
    pub created_by: String,
    /// Time of completion.
    #[schema(required)]
    pub completed_at: Option<Time>,
    /// True if the compass has a binnacle.
    pub has_binnacle: bool,
    /// Number of entries in its log.
    pub last_seq: i64,
    /// SHA-256 of the last entry.
    pub last_sha256: String,
}

/// Page of orders.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderList)]
pub(crate) struct OrderList {
    /// Orders, the newest first.
    pub items: Vec<Summary>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Filter of a list of orders.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Filter {
    /// This vessel only.
    pub vessel: Option<VesselId>,
    /// This state only.
    pub state: Option<State>,
}

impl Summary {
    /// Summary for the firm of an offer.
    pub(crate) fn seen_with(&self, offer: &Offer) -> Summary {
        let state = match offer.state {
            OfferState::Open => State::Offered,
            OfferState::Proposed => State::Proposed,
            OfferState::Declined | OfferState::Lapsed => State::Declined,
            OfferState::Withdrawn => State::Cancelled,
            OfferState::Waiting | OfferState::Accepted => self.state,
        };
        Summary {
            state,
            answer_by: offer.answer_by,
            ..self.clone()
        }
    }

    /// Hours of the job.
    pub(crate) fn hours(&self) -> Hours {
        Hours::new(self.planned_at, Some(self.planned_until))
    }

    /// Brings the local times in step with the hours.
    pub(crate) fn with_local_times(mut self) -> Summary {
        self.update_local_times();
        self
    }

    /// Brings the local times in step with the hours.
    pub(crate) fn update_local_times(&mut self) {
        self.planned_at_local = local_time(&self.port, self.planned_at);
        self.planned_until_local = local_time(&self.port, self.planned_until);
        let now_s = utc_offset_s(&self.port, self.planned_at);
        let agreed_s = self.agreed_utc_offset_s.filter(|_| now_s.is_some());
        let agreed_s = agreed_s.filter(|agreed_s| Some(*agreed_s) != now_s);
        self.agreed_at_local = agreed_s.and_then(|ahead_s| at_offset(self.planned_at, ahead_s));
    }

    /// Takes over the agreed hours and berth.
    pub(crate) fn apply_terms(&mut self, exchange: &Exchange) {
        if let Some(terms) = &exchange.terms {
            let hours = terms.hours();
            if hours != self.hours() {
                self.agreed_utc_offset_s = utc_offset_s(&self.port, hours.from);
            }
            (self.planned_at, self.planned_until) = (hours.from, hours.until);
            self.berth = terms.berth.clone().or(self.berth.take());
        }
    }
}
