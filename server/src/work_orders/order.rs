//! An order to adjust a compass, as it is asked for and shown.

use super::completion::Completed;
use super::photos::PhotoTaken;
use super::plan::Planned;
use super::reading::{Checked, Given};
use super::schema::{ChosenPlanSchema, StepSchema, VerdictSchema};
use super::standing::Standing;
use super::verification::Verified;
use crate::binnacles::SettingSchema;
use crate::error::Result;
use crate::http::{optional_text, text};
use crate::ids::{CompassId, OrderId, VesselId};
use crate::time::Time;
use binnacle_magnetics::adjust::Step;
use binnacle_magnetics::binnacle::Setting;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// What everything that comes from an order says of itself until the sea has spoken.
pub(super) const NOT_A_CERTIFICATE: &str = "predicted, not a certificate";

/// How far an order has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WorkOrderState)]
pub enum State {
    /// It was written.
    Planned,
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
    /// Not to be done, or no further.
    Cancelled,
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
pub(super) struct Summary {
    /// The order's id.
    pub id: OrderId,
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
    /// When it was written.
    pub created_at: Time,
    /// Who wrote it.
    pub created_by: String,
    /// When it was completed.
    #[schema(required)]
    pub completed_at: Option<Time>,
    /// Entries in its log.
    pub last_seq: i64,
    /// SHA-256 of the last of them.
    pub last_sha256: String,
}

/// A page of orders.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderList)]
pub(super) struct OrderList {
    /// The newest first.
    pub items: Vec<Summary>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Which orders.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Of this vessel only.
    pub vessel: Option<VesselId>,
    /// In this state only.
    pub state: Option<State>,
}

/// An order, and all that the next thing to do depends on.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrder)]
pub(super) struct Order {
    /// In a line.
    #[serde(flatten)]
    pub summary: Summary,
    /// What its figures are: predictions, until headings at sea agree.
    #[schema(example = "predicted, not a certificate")]
    pub standing: &'static str,
    /// What the magnetometer read; the last reading that was taken.
    #[schema(required)]
    pub reading: Option<Given>,
    /// What that told.
    #[schema(required)]
    pub berth: Option<Checked>,
    /// The plan that is followed.
    #[schema(required, value_type = Option<ChosenPlanSchema>)]
    pub plan: Option<Planned>,
    /// How many of its steps are done.
    pub steps_done: usize,
    /// The step to do now; none when all are done, or there is no plan.
    #[schema(required, value_type = Option<StepSchema>)]
    pub next_step: Option<Step>,
    /// What became of the last step.
    #[schema(required, value_type = Option<VerdictSchema>)]
    pub last_step: Option<super::steps::StepSaid>,
    /// How the correctors stand now; none before the first reading.
    #[schema(required, value_type = Option<SettingSchema>)]
    pub setting: Option<Setting>,
    /// What the compass read last at the berth, degrees.
    #[schema(required)]
    pub compass_deg: Option<f64>,
    /// How it was completed.
    #[schema(required)]
    pub completion: Option<Completed>,
    /// What the headings at sea say.
    #[schema(required)]
    pub verification: Option<Verified>,
    /// Photographs, in order.
    pub photos: Vec<PhotoTaken>,
}

impl Order {
    /// The order with what follows from its log.
    pub(super) fn new(summary: Summary, standing: Standing) -> Order {
        Order {
            standing: match summary.state {
                State::Verified => "verified at sea",
                _ if standing.is_verified() => "verified at sea",
                _ => NOT_A_CERTIFICATE,
            },
            next_step: standing.next_step().cloned(),
            setting: standing.setting().cloned(),
            steps_done: standing.steps_done,
            compass_deg: standing.compass_deg,
            last_step: standing.last_step,
            reading: standing.read.as_ref().map(|read| read.given.clone()),
            berth: standing.read.and_then(|read| read.checked),
            plan: standing.plan,
            completion: standing.completed,
            verification: standing.verified,
            photos: standing.photos,
            summary,
        }
    }
}

impl NewOrder {
    /// The order, its words trimmed.
    pub fn checked(self) -> Result<NewOrder> {
        let optional = |field, value: Option<String>| optional_text(field, value.as_deref());
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
