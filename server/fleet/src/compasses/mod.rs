//! Compasses of a vessel: the record of each magnetic element.

mod amendment;
mod compass;
mod store;

pub use compass::{Compass, Role};
pub use store::{ids, insert_standard, of_fleet, of_vessel};

use crate::vessels;
use amendment::Amendment;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Db;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Valid, optional_text, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{CompassId, VesselId};
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
        .routes(routes!(list_compasses, create_compass))
        .routes(routes!(amend_compass))
}

/// A compass to be entered.
#[derive(Deserialize, Serialize, ToSchema)]
#[schema(example = json!({ "name": "Steering compass", "role": "steering" }))]
pub struct NewCompass {
    /// Its name.
    #[schema(min_length = 1, max_length = 200)]
    pub name: String,
    /// Its role.
    pub role: Role,
    /// Maker and type.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub make: Option<String>,
    /// Its serial number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub serial_number: Option<String>,
    /// Its binnacle: maker, type and number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub binnacle: Option<String>,
}

/// A page of compasses.
#[derive(Serialize, ToSchema)]
pub struct CompassList {
    /// In the order in which they were entered.
    pub items: Vec<Compass>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Selection of one of the vessel's compasses.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct WhichCompass {
    /// A compass of the vessel; its first one by default.
    pub compass: Option<CompassId>,
}

/// Finds a compass of the vessel, or its first one by default.
///
/// # Errors
/// [`Error::NotFound`] when the vessel has no such compass.
pub async fn find(db: &Db, vessel: VesselId, compass: Option<CompassId>) -> Result<Compass> {
    of_vessel(db, vessel)
        .await?
        .into_iter()
        .find(|found| compass.is_none_or(|id| found.id == id))
        .ok_or(Error::NotFound("compass"))
}

/// List a vessel's compasses
#[utoipa::path(get, path = "/vessels/{id}/compasses", tag = "fleet",
    params(("id" = VesselId, Path), Page),
    responses((status = 200, body = CompassList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_compasses(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    page: Page,
) -> Result<Json<CompassList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let after = page.after_id()?.unwrap_or_default();
    let mut found = of_vessel(&app.db, id).await?;
    found.retain(|compass| compass.id.0 > after);
    let listed = page.cut(found, |compass| compass.id.to_string());
    Ok(Json(CompassList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Enter a compass
#[utoipa::path(post, path = "/vessels/{id}/compasses", tag = "fleet",
    params(("id" = VesselId, Path), Key), request_body = NewCompass,
    responses((status = 201, body = Compass), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn create_compass(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<VesselId>,
    key: Key,
    Valid(new): Valid<NewCompass>,
) -> Result<(StatusCode, Json<Compass>)> {
    vessels::must_be_in_fleet(&app.db, writer.operator, id).await?;
    let request_hash = idempotency::request_hash(&format!("compass of {id}"), &new)?;
    let compass = Compass {
        id: CompassId::new(),
        vessel_id: id,
        name: text("name", &new.name)?,
        role: new.role,
        make: optional_text("make", new.make.as_deref())?,
        serial_number: optional_text("serial_number", new.serial_number.as_deref())?,
        binnacle: optional_text("binnacle", new.binnacle.as_deref())?,
        created_at: app.clock.now().into(),
    };
    let mut tx = request.begin().await?;
    let made = key
        .once(
            &mut tx,
            writer.operator,
            &request_hash,
            compass.id.0,
            compass.created_at,
        )
        .await?;
    if made == compass.id.0 {
        store::insert(&mut tx, &compass).await?;
    }
    tx.commit().await?;
    let compass = find(&app.db, id, Some(CompassId(made))).await?;
    Ok((StatusCode::CREATED, Json(compass)))
}

/// Amend a compass
///
/// Absent fields stay as they are; null removes a value.
#[utoipa::path(patch, path = "/vessels/{id}/compasses/{compass}", tag = "fleet",
    params(("id" = VesselId, Path), ("compass" = CompassId, Path)), request_body = Amendment,
    responses((status = 200, body = Compass), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn amend_compass(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, CompassId)>,
    Valid(amendment): Valid<Amendment>,
) -> Result<Json<Compass>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let mut tx = request.begin().await?;
    let compass = store::lock(&mut tx, vessel, id)
        .await?
        .ok_or(Error::NotFound("compass"))?;
    let amended = amendment.applied_to(compass)?;
    store::update(&mut tx, &amended).await?;
    tx.commit().await?;
    Ok(Json(amended))
}
