//! An order to adjust a compass, as it is asked for and shown.

use crate::berth_session::berth_reading::BerthCheck;
use crate::berth_session::photos::Photo;
use crate::berth_session::plan::ChosenPlan;
use crate::berth_session::second_reading_api::SecondReadingResult;
use crate::completion::complete::{Completion, KnownKey, RecordedSignature};
use crate::dispatch::offer_requests::NewOffer;
use crate::dispatch::port_call_changes::{CallChange, CallFit};
use crate::verification::SeaVerification;
use crate::work_orders::offer_state::{Offer, OfferState};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::request_schema::{BerthReadingSchema, LimitsSchema};
use crate::work_orders::schema::{ChosenPlanSchema, StepSchema, VerdictSchema};
use binnacle_adjustment::adjust::{Limits, ReadingForm, Step};
use binnacle_adjustment::binnacle::Setting;
use binnacle_compass::angle::wrap_360;
use binnacle_fleet::binnacles::SettingSchema;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{optional_text, text};
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// What everything that comes from an order says of itself until the sea has spoken.
pub(crate) const NOT_A_CERTIFICATE: &str = "predicted, not a certificate";

/// No order is for later.
const MAX_DAYS_AHEAD: f64 = 730.0;

/// How far an order has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WorkOrderState)]
pub enum State {
    /// It was written, and offered to no firm.
    Planned,
    /// A firm is asked.
    Offered,
    /// A firm would have it on other terms: the operator is asked.
    Proposed,
    /// No firm that was asked has taken it.
    Declined,
    /// A firm has it.
    Accepted,
    /// The adjuster is on board.
    OnBoard,
    /// The magnetometer was read at the berth.
    Measured,
    /// A plan was chosen, and its steps are being done.
    Adjusting,
    /// Done; what the compass will show is foretold.
    Adjusted,
    /// Headings at sea agree with what was foretold.
    Verified,
    /// A heading at sea does not agree with it.
    Failed,
    /// Done with.
    Closed,
    /// Done with, though no headings at sea have spoken for or against it.
    ClosedUnverified,
    /// Not to be done, or no further.
    Cancelled,
}

impl State {
    /// Whether the ship's model and binnacle are a firm's business.
    pub fn is_under_way(self) -> bool {
        matches!(
            self,
            State::Planned
                | State::Offered
                | State::Proposed
                | State::Declined
                | State::Accepted
                | State::OnBoard
                | State::Measured
                | State::Adjusting
        )
    }

    /// Whether nothing is to be done any more.
    pub fn is_over(self) -> bool {
        matches!(
            self,
            State::Closed | State::ClosedUnverified | State::Cancelled
        )
    }
}

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

/// An order as its log's first entry has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Opened {
    /// What was asked for.
    #[serde(flatten)]
    pub order: NewOrder,
    /// The vessel's name then.
    pub vessel_name: String,
    /// The compass's name then.
    pub compass_name: String,
}

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

/// An order, and all that the next thing to do depends on.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrder)]
pub(crate) struct Order {
    /// In a line.
    #[serde(flatten)]
    pub summary: Summary,
    /// The fee that was agreed on with the firm that has it, euros, without travel; none
    /// while no firm has it, or where none was said.
    #[schema(required)]
    pub fee_eur: Option<f64>,
    /// What became of its port call since its time was agreed; none where it has not moved.
    #[schema(required)]
    pub call_change: Option<CallChange>,
    /// What its figures are: predictions, until headings at sea agree.
    #[schema(example = "predicted, not a certificate")]
    pub standing: &'static str,
    /// What a plan must keep to.
    #[schema(value_type = LimitsSchema)]
    pub limits: Limits,
    /// What the magnetometer read; the last reading that was taken.
    #[schema(required, value_type = Option<BerthReadingSchema>)]
    pub reading: Option<ReadingForm>,
    /// What that told.
    #[schema(required)]
    pub berth_check: Option<BerthCheck>,
    /// The plan that is followed.
    #[schema(required, value_type = Option<ChosenPlanSchema>)]
    pub plan: Option<ChosenPlan>,
    /// How many of its steps are done.
    pub steps_done: usize,
    /// The step to do now; none when all are done, or there is no plan.
    #[schema(required, value_type = Option<StepSchema>)]
    pub next_step: Option<Step>,
    /// What became of the last step.
    #[schema(required, value_type = Option<VerdictSchema>)]
    pub last_step: Option<crate::berth_session::steps::StepResult>,
    /// What the magnetometer said after the steps, the correctors standing as they stand.
    #[schema(required)]
    pub second_reading: Option<SecondReadingResult>,
    /// Whether someone has said since that reading how the correctors stand.
    pub looked_since: bool,
    /// How the correctors stand now; none before the first reading.
    #[schema(required, value_type = Option<SettingSchema>)]
    pub setting: Option<Setting>,
    /// What the compass read last at the berth, degrees.
    #[schema(required)]
    pub compass_deg: Option<f64>,
    /// How it was completed.
    #[schema(required)]
    pub completion: Option<Completion>,
    /// What the headings at sea say.
    #[schema(required)]
    pub verification: Option<SeaVerification>,
    /// Photographs, in order.
    pub photos: Vec<Photo>,
    /// Signatures over the record by firms' keys, and whose they are.
    pub signatures: Vec<KeySignature>,
    /// What became of its offers, in the order in which firms are asked; a firm sees its
    /// own only.
    pub offers: Vec<Offer>,
}

/// A signature over the record.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderSignature)]
pub(crate) struct KeySignature {
    /// The public key, hexadecimal.
    pub public_key: String,
    /// The signature, hexadecimal.
    pub signature: String,
    /// Whose key it is; none for a key that the order's firm has not registered.
    #[schema(required)]
    pub key: Option<KnownKey>,
}

impl From<RecordedSignature> for KeySignature {
    fn from(by: RecordedSignature) -> KeySignature {
        KeySignature {
            public_key: by.signed.public_key,
            signature: by.signed.signature,
            key: by.key,
        }
    }
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
}

impl Order {
    /// The order with what follows from its log.
    pub(crate) fn new(summary: Summary, standing: OrderState, tenant: Tenant) -> Order {
        let setting = standing.setting().cloned();
        // Held against what the compass reads now, as the next step will be.
        let next_step = standing.next_step().map(|step| Step {
            expected_compass_deg: standing
                .compass_deg
                .map_or(step.expected_compass_deg, |now_deg| {
                    wrap_360(now_deg + step.change_deg)
                }),
            ..step.clone()
        });
        let verified = standing.is_verified();
        let of_firm = tenant.firm();
        let closed = of_firm.is_some() && summary.state.is_over();
        let seen = |offer: &Offer| of_firm.is_none_or(|firm| offer.firm_id == firm);
        let signatures = standing.signatures.into_iter().map(KeySignature::from);
        Order {
            standing: match summary.state {
                State::Verified => "verified at sea",
                _ if verified => "verified at sea",
                _ => NOT_A_CERTIFICATE,
            },
            fee_eur: standing.offers.holder().and_then(Offer::fee),
            call_change: standing.call,
            limits: standing.limits,
            next_step,
            setting,
            steps_done: standing.steps_done,
            compass_deg: standing.compass_deg,
            last_step: standing.last_step,
            looked_since: standing.looked_since && standing.again.is_some(),
            second_reading: standing.again.map(|again| again.said),
            reading: standing.read.as_ref().map(|read| read.given.clone()),
            berth_check: standing.read.and_then(|read| read.checked),
            // The plan is a firm's business while the order is open.
            plan: standing.plan.filter(|_| !closed),
            completion: standing.completed,
            verification: standing.verified,
            photos: standing.photos,
            signatures: signatures.collect(),
            offers: standing.offers.all.into_iter().filter(seen).collect(),
            summary,
        }
    }
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
