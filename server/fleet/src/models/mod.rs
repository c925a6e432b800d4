//! Models of a vessel's compasses.
//!
//! Invariants: the highest version is current. An earlier one is kept if anyone could notice its
//! difference from the one before, or the ship has it. A compass has no current model after a
//! change has ended its epoch, until the next model.

mod downlink_policy;
mod left_out;
mod missing;
mod model_json;
mod store;

pub use left_out::LeftOut;
pub use missing::{NoModel, NoModelFields};
pub use model_json::ModelJson;
pub use store::{
    StoredModel, card_withdrawn, card_withdrawn_in, current, current_of_fleet, current_of_vessel,
    find_prediction, find_version, insert, insert_analysed, list_in_force, list_recent, note_sent,
};

use crate::compasses::{self, WhichCompass};
use crate::deviation::WorstHeading;
use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_compass::deviation::CoefficientsInDegrees;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params};
use binnacle_platform::ids::{CompassId, ModelId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::messages::CardWithdrawn;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(current_model))
        .routes(routes!(list_models))
}

/// Summary of a model.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ModelSummary {
    /// The model version's id.
    pub id: ModelId,
    /// Counts the compass's models from 1.
    pub version: i64,
    /// The compass.
    pub compass_id: CompassId,
    /// Time at which it was fitted.
    pub created_at: Time,
    /// The time of the last sample in it.
    pub data_until: Time,
    /// Root mean square of the residuals, degrees.
    #[schema(required)]
    pub rms_deg: Option<f64>,
    /// Samples that carried weight.
    pub samples_used: u64,
}

/// A whole model version.
#[derive(Debug, Serialize, ToSchema)]
pub struct ModelVersion {
    /// The model version's id.
    pub id: ModelId,
    /// Counts the compass's models from 1.
    pub version: i64,
    /// The compass.
    pub compass_id: CompassId,
    /// Time from which it holds; none means without limit.
    #[schema(required)]
    pub epoch_from: Option<Time>,
    /// Time until which it holds; none means without limit.
    #[schema(required)]
    pub epoch_to: Option<Time>,
    /// The time of the first sample in it.
    pub data_from: Time,
    /// The time of the last sample in it.
    pub data_until: Time,
    /// Time at which it was fitted.
    pub created_at: Time,
    /// SHA-256 of everything that it was made from.
    pub input_hash: String,
    /// The estimator that made it.
    pub estimator: String,
    /// The work order that predicted it; none for a model that was fitted.
    #[schema(required)]
    pub foretold_by: Option<OrderId>,
    /// The place of the last sample, degrees north.
    pub lat: f64,
    /// The place of the last sample, degrees east.
    pub lon: f64,
    /// Horizontal field there, nT.
    pub h_nt: f64,
    /// Vertical field there, nT, down positive.
    pub z_nt: f64,
    /// The handbook's coefficients there; none where headings are ambiguous.
    #[schema(required)]
    pub handbook: Option<CoefficientsInDegrees>,
    /// The fit.
    #[schema(value_type = Model)]
    pub model: ModelJson,
}

/// A page of model versions.
#[derive(Serialize, ToSchema)]
pub struct ModelVersionList {
    /// The newest first.
    pub items: Vec<ModelVersion>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Find a compass's current model
#[utoipa::path(get, path = "/vessels/{id}/model", tag = "fleet",
    params(("id" = VesselId, Path), WhichCompass),
    responses((status = 200, body = ModelVersion), (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model yet: detail and refusal say what is missing", body = Problem)))]
async fn current_model(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(which): Params<WhichCompass>,
) -> Result<Json<ModelVersion>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, which.compass).await?;
    let model = must_have(&app, id, compass.id).await?;
    Ok(Json(model.into_version()))
}

/// List a compass's model versions
#[utoipa::path(get, path = "/vessels/{id}/models", tag = "fleet",
    params(("id" = VesselId, Path), WhichCompass, Page),
    responses((status = 200, body = ModelVersionList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_models(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(which): Params<WhichCompass>,
    page: Page,
) -> Result<Json<ModelVersionList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, which.compass).await?;
    let before = page.after_number()?;
    let found = store::list(&app.db, id, compass.id, before, page.fetch()).await?;
    let listed = page.cut(found, |model| model.version.to_string());
    Ok(Json(ModelVersionList {
        items: listed
            .items
            .into_iter()
            .map(StoredModel::into_version)
            .collect(),
        next: listed.next,
    }))
}

/// Returns the current model.
///
/// # Errors
/// [`NoModel`], with the reason, when there is none.
pub async fn must_have(app: &App, vessel: VesselId, compass: CompassId) -> Result<StoredModel> {
    if let Some(model) = current(&app.db, vessel, compass).await? {
        return Ok(model);
    }
    let (refusal, left_out) = missing::find_refusal(&app.db, vessel, compass).await?;
    Err(NoModel {
        refusal,
        left_out,
        card_withdrawn: card_withdrawn(&app.db, vessel, compass).await?,
    }
    .into())
}

impl StoredModel {
    /// Summarizes the model in a line.
    pub fn summary(&self) -> ModelSummary {
        ModelSummary {
            id: self.id,
            version: self.version,
            compass_id: self.compass_id,
            created_at: self.created_at,
            data_until: self.data_until,
            rms_deg: self.model.0.rms_deg,
            samples_used: self.model.0.samples_used,
        }
    }

    /// Finds the heading with the greatest deviation, at the last sample's place.
    pub fn worst(&self) -> Option<WorstHeading> {
        crate::deviation::worst(&self.model.0, self.earth())
    }

    /// Returns the change that withdrew cards from before the model's epoch.
    pub fn replaces(&self) -> Option<CardWithdrawn> {
        Some(CardWithdrawn {
            since: self.epoch_from?.0,
            reason: self.epoch_begun_by.clone()?,
        })
    }

    fn earth(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt,
            z_nt: self.z_nt,
        }
    }

    /// Returns the whole version, as the API shows it.
    pub fn into_version(self) -> ModelVersion {
        ModelVersion {
            handbook: crate::deviation::handbook(&self.model.0, self.earth()),
            id: self.id,
            version: self.version,
            compass_id: self.compass_id,
            epoch_from: self.epoch_from,
            epoch_to: self.epoch_to,
            data_from: self.data_from,
            data_until: self.data_until,
            created_at: self.created_at,
            input_hash: self.input_hash,
            estimator: self.estimator,
            foretold_by: self.foretold_by,
            lat: self.lat,
            lon: self.lon,
            h_nt: self.h_nt,
            z_nt: self.z_nt,
            model: self.model,
        }
    }
}
