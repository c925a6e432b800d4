//! HTTP API of vessels, each assembled with its compasses, current model and open alerts.

mod amendment;
mod csv_upload;
mod service;

pub use service::ServiceChanged;

use crate::alerts::{self, OpenCount};
use crate::compasses::{self, Compass};
use crate::deviation::WorstHeading;
use crate::models::{self, ModelSummary, StoredModel};
use crate::vessels::{self, LastPosition, NewVessel, VesselRow};
use amendment::Amendment;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, IfMatch, Json, Page, Params, Valid, Version, Versioned};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{OperatorId, VesselId};
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_vessels, create_vessel))
        .routes(routes!(find_vessel, amend_vessel))
        .merge(csv_upload::router())
}

/// A vessel, with the state of its compass.
#[derive(Debug, Serialize, ToSchema)]
pub struct Vessel {
    /// The vessel's id.
    pub id: VesselId,
    /// Its name.
    pub name: String,
    /// Its IMO number, seven digits.
    #[schema(required)]
    pub imo_number: Option<String>,
    /// Its call sign.
    #[schema(required)]
    pub call_sign: Option<String>,
    /// Its flag state.
    #[schema(required)]
    pub flag: Option<String>,
    /// State of its degaussing coils, in words.
    #[schema(required)]
    pub degaussing: Option<String>,
    /// Name of its class of sister ships.
    #[schema(required)]
    pub sister_class: Option<String>,
    /// Time at which it was entered.
    pub created_at: Time,
    /// Time from which it is out of service.
    #[schema(required)]
    pub out_of_service_at: Option<Time>,
    /// Time of its last batch.
    #[schema(required)]
    pub last_upload_at: Option<Time>,
    /// Place of its latest sample.
    #[schema(required)]
    pub last_position: Option<LastPosition>,
    /// Its compasses, in the order in which they were entered.
    pub compasses: Vec<Compass>,
    /// The current model of its first compass that has one.
    #[schema(required)]
    pub model: Option<ModelSummary>,
    /// The heading with the greatest deviation by that model, at the last position.
    #[schema(required)]
    pub worst: Option<WorstHeading>,
    /// Alerts that nobody has acknowledged.
    pub open_alerts: u32,
    /// Its worst alert that is not cleared.
    #[schema(required)]
    pub worst_alert: Option<Severity>,
}

/// A page of vessels.
#[derive(Serialize, ToSchema)]
pub struct VesselList {
    /// In the order in which they were entered.
    pub items: Vec<Vessel>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Selection of vessels.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Which {
    /// Those in service, which is the default, or those out of it.
    in_service: Option<bool>,
}

/// List the fleet
#[utoipa::path(get, path = "/vessels", tag = "fleet", params(Which, Page),
    responses((status = 200, body = VesselList), (status = 401, body = Problem)))]
async fn list_vessels(
    State(app): State<App>,
    reader: Reader,
    Params(which): Params<Which>,
    page: Page,
) -> Result<Json<VesselList>> {
    let (in_service, after) = (which.in_service.unwrap_or(true), page.after_id()?);
    let found = vessels::list(&app.db, reader.operator, in_service, after, page.fetch()).await?;
    let listed = page.cut(found, |row| row.id.to_string());
    let (Some(first), Some(last)) = (listed.items.first(), listed.items.last()) else {
        return Ok(Json(VesselList {
            items: Vec::new(),
            next: None,
        }));
    };
    let (operator, first, last) = (reader.operator, first.id, last.id);
    let compasses = compasses::of_fleet(&app.db, operator, first, last).await?;
    let models = models::current_of_fleet(&app.db, operator, first, last).await?;
    let open = alerts::count_open(&app.db, operator, first, last).await?;
    let items = listed
        .items
        .into_iter()
        .map(|row| row.with(&compasses, &models, &open))
        .collect();
    Ok(Json(VesselList {
        items,
        next: listed.next,
    }))
}

/// Enter a vessel
///
/// It comes with one compass, its standard compass.
#[utoipa::path(post, path = "/vessels", tag = "fleet", params(Key), request_body = NewVessel,
    responses((status = 201, body = Vessel), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn create_vessel(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    key: Key,
    Valid(new): Valid<NewVessel>,
) -> Result<(StatusCode, Versioned<Vessel>)> {
    let request_hash = idempotency::request_hash("vessel", &new)?;
    let new = new.checked()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let new_id = VesselId::new();
    let id = key
        .once(&mut tx, writer.operator, &request_hash, new_id.0, now)
        .await?;
    if id == new_id.0 {
        request.concerns_vessel(new_id, None);
        vessels::lock_entries(&mut tx, writer.operator).await?;
        enter(&mut tx, writer.operator, new_id, &new, now).await?;
    }
    tx.commit().await?;
    let vessel = assemble(&app, writer.operator, VesselId(id)).await?;
    Ok((StatusCode::CREATED, vessel))
}

/// Stores a vessel with its standard compass, after [`vessels::lock_entries`].
async fn enter(
    tx: &mut Tx,
    operator: OperatorId,
    id: VesselId,
    new: &NewVessel,
    now: Time,
) -> Result<()> {
    vessels::require_free_imo(tx, operator, new.imo_number.as_deref(), id).await?;
    vessels::insert(tx, operator, id, new, now).await?;
    compasses::insert_standard(tx, id, now).await?;
    Ok(())
}

/// Find a vessel
#[utoipa::path(get, path = "/vessels/{id}", tag = "fleet", params(("id" = VesselId, Path)),
    responses((status = 200, body = Vessel, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_vessel(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
) -> Result<Versioned<Vessel>> {
    assemble(&app, reader.operator, id).await
}

/// Amend a vessel
///
/// Absent fields stay as they are; null removes a value. A vessel with a work order under way
/// cannot go out of service.
#[utoipa::path(patch, path = "/vessels/{id}", tag = "fleet",
    params(("id" = VesselId, Path), IfMatch), request_body = Amendment,
    responses((status = 200, body = Vessel, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "A work order of the vessel is under way", body = Problem),
              (status = 422, body = Problem)))]
async fn amend_vessel(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<VesselId>,
    if_match: IfMatch,
    Valid(amendment): Valid<Amendment>,
) -> Result<Versioned<Vessel>> {
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let vessel = vessels::lock(&mut tx, writer.operator, id).await?;
    if_match.check(&vessel.version()?)?;
    let events_out = match amendment.in_service {
        Some(in_service) => {
            service::set(&mut tx, writer.operator, &vessel, in_service, now).await?
        }
        None => Vec::new(),
    };
    let former = vessel.imo_number.clone();
    let amended = amendment.applied_to(vessel)?;
    if amended.imo_number != former {
        let number = amended.imo_number.as_deref();
        vessels::lock_entries(&mut tx, writer.operator).await?;
        vessels::require_free_imo(&mut tx, writer.operator, number, id).await?;
    }
    vessels::update(&mut tx, id, &amended).await?;
    tx.commit().await?;
    app.work.notify_one();
    for event in events_out {
        app.publish(event);
    }
    assemble(&app, writer.operator, id).await
}

async fn assemble(app: &App, operator: OperatorId, id: VesselId) -> Result<Versioned<Vessel>> {
    let row = vessels::must_be_in_fleet(&app.db, operator, id).await?;
    let compasses = compasses::of_vessel(&app.db, id).await?;
    let models = models::current_of_vessel(&app.db, id).await?;
    let open = alerts::count_open(&app.db, operator, id, id).await?;
    let version = row.version()?;
    Ok(Versioned(row.with(&compasses, &models, &open), version))
}

impl VesselRow {
    /// Returns the version of what people may edit.
    fn version(&self) -> Result<Version> {
        Version::of(&(
            &self.name,
            &self.imo_number,
            &self.call_sign,
            &self.flag,
            &self.degaussing,
            &self.sister_class,
            self.out_of_service_at,
        ))
    }

    /// Assembles a vessel from its share of compasses, current models and alert counts.
    fn with(self, compasses: &[Compass], models: &[StoredModel], open: &[OpenCount]) -> Vessel {
        let own = open.iter().filter(|alerts| alerts.vessel_id == self.id);
        let (open_alerts, worst_alert) = alerts::summarize(own);
        let compasses: Vec<Compass> = compasses
            .iter()
            .filter(|compass| compass.vessel_id == self.id)
            .cloned()
            .collect();
        let model = compasses.iter().find_map(|compass| {
            models
                .iter()
                .find(|model| model.vessel_id == self.id && model.compass_id == compass.id)
        });
        Vessel {
            last_position: self.last_position(),
            id: self.id,
            name: self.name,
            imo_number: self.imo_number,
            call_sign: self.call_sign,
            flag: self.flag,
            degaussing: self.degaussing,
            sister_class: self.sister_class,
            created_at: self.created_at,
            out_of_service_at: self.out_of_service_at,
            last_upload_at: self.last_upload_at,
            model: model.map(StoredModel::summary),
            worst: model.and_then(StoredModel::worst),
            compasses,
            open_alerts,
            worst_alert,
        }
    }
}
