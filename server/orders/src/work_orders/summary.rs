//! Summary of an order, as lists show it.

use crate::work_orders::offers::{Offer, OfferState};
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::payload::port_call::CallFit;
use crate::work_orders::state::State;
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// An order in a line.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = WorkOrderSummary)]
pub(crate) struct Summary {
    /// The order's id.
    pub id: OrderId,
    /// Whose vessel it is.
    pub operator_id: OperatorId,
    /// Their name.
    pub operator_name: String,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
    /// How far it has come.
    pub state: State,
    /// The port.
    pub port: String,
    /// The berth.
    #[schema(required)]
    pub berth: Option<String>,
    /// When it is to be done.
    pub planned_at: Time,
    /// Who is to do it, or did.
    #[schema(required)]
    pub adjuster_name: Option<String>,
    /// The number of their licence.
    #[schema(required)]
    pub adjuster_licence: Option<String>,
    /// Their firm.
    #[schema(required)]
    pub firm: Option<String>,
    /// The firm that has accepted the order.
    #[schema(required)]
    pub firm_id: Option<FirmId>,
    /// Until when an answer is waited for: the firm's to an offer or to another time, or the
    /// operator's to a proposal.
    #[schema(required)]
    pub answer_by: Option<Time>,
    /// How its time lies in its port call, where that has moved since the time was agreed.
    #[schema(required)]
    pub call_fit: Option<CallFit>,
    /// When it was written.
    pub created_at: Time,
    /// Who wrote it.
    pub created_by: String,
    /// When it was completed.
    #[schema(required)]
    pub completed_at: Option<Time>,
    /// Whether the compass's binnacle is entered.
    pub has_binnacle: bool,
    /// Entries in its log.
    pub last_seq: i64,
    /// SHA-256 of the last of them.
    pub last_sha256: String,
}

/// A page of orders.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderList)]
pub(crate) struct OrderList {
    /// The newest first.
    pub items: Vec<Summary>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Which orders.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Filter {
    /// Of this vessel only.
    pub vessel: Option<VesselId>,
    /// In this state only.
    pub state: Option<State>,
}

impl Summary {
    /// The order as a firm sees it that this offer is to.
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
    /// Takes over the agreed time and berth.
    pub(crate) fn apply_terms(&mut self, said: &Exchange) {
        if let Some(terms) = &said.terms {
            self.planned_at = terms.planned_at;
            self.berth = terms.berth.clone().or(self.berth.take());
        }
    }
}
