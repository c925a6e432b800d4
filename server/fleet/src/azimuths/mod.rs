//! Azimuths: compass errors that people observed, on board and ashore.
//!
//! Invariants:
//!
//! - An azimuth never changes. A wrong one is withdrawn: it stays in its place, marked, and no
//!   longer counts. Its errors are worked out from what was observed whenever it is read.
//! - One transaction stores a change, a job to analyse the vessel, and an event for the dashboards.
//! - An azimuth from on board has the id that it was given there. It is stored once, however often
//!   it arrives.

mod agent_reports;
mod entry;
mod store;

pub use agent_reports::router as agent_router;
pub use store::{StoredAzimuth, of_compass};

use crate::compasses;
use crate::logbook::Change;
use crate::vessels;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Db;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params, Valid, ValidOrNone, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{AzimuthId, CompassId, VesselId};
use entry::{AzimuthEntry, AzimuthList, Filter, NewAzimuth, Withdrawal, invalid_report};
use store::{Author, NewRow};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_azimuths, observe_azimuth))
        .routes(routes!(find_azimuth))
        .routes(routes!(withdraw_azimuth))
}

/// List a vessel's azimuths
///
/// The latest first. Withdrawn ones stay in the list, marked.
#[utoipa::path(get, path = "/vessels/{id}/azimuths", tag = "fleet",
    params(("id" = VesselId, Path), Filter, Page),
    responses((status = 200, body = AzimuthList), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn list_azimuths(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<AzimuthList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let found = store::list(&app.db, id, &filter.checked()?, &page).await?;
    let listed = page.cut(found, AzimuthEntry::cursor);
    Ok(Json(AzimuthList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Enter an azimuth
///
/// The response has the compass error and the gyro error. An observation that is possible and
/// unlikely is refused with a problem that begins with `confirmed:`; with `confirmed` true it is
/// accepted.
#[utoipa::path(post, path = "/vessels/{id}/azimuths", tag = "fleet",
    params(("id" = VesselId, Path), Key), request_body = NewAzimuth,
    responses((status = 201, body = AzimuthEntry), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn observe_azimuth(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    key: Key,
    Valid(new): Valid<NewAzimuth>,
) -> Result<(StatusCode, Json<AzimuthEntry>)> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let request_hash = idempotency::request_hash(&format!("azimuth of {vessel}"), &new)?;
    let now = app.clock.now();
    let compass = named_compass(&app.db, vessel, new.compass_id).await?;
    let report = new.report().checked(now).map_err(invalid_report)?;
    let new_id = AzimuthId::new();
    let mut change = Change::begin(&app, &request, vessel, now.into()).await?;
    let tx = change.tx();
    let made = key
        .once(tx, writer.operator, &request_hash, new_id.0, now.into())
        .await?;
    if made == new_id.0 {
        let row = NewRow {
            vessel,
            id: new_id,
            compass,
            report: &report,
        };
        let author = Author::user(tx, writer.user, now.into()).await?;
        store::insert(tx, &row, &author).await?;
        change.commit().await?;
    }
    let entry = store::must_find(&app.db, vessel, AzimuthId(made)).await?;
    Ok((StatusCode::CREATED, Json(entry)))
}

/// See an azimuth
#[utoipa::path(get, path = "/vessels/{id}/azimuths/{azimuth}", tag = "fleet",
    params(("id" = VesselId, Path), ("azimuth" = AzimuthId, Path)),
    responses((status = 200, body = AzimuthEntry), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_azimuth(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, id)): Id<(VesselId, AzimuthId)>,
) -> Result<Json<AzimuthEntry>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    Ok(Json(store::must_find(&app.db, vessel, id).await?))
}

/// Withdraw an azimuth
///
/// It stays in the list, marked, and no longer counts. Withdrawing it again changes nothing.
#[utoipa::path(post, path = "/vessels/{id}/azimuths/{azimuth}/withdraw", tag = "fleet",
    params(("id" = VesselId, Path), ("azimuth" = AzimuthId, Path)),
    request_body = Option<Withdrawal>,
    responses((status = 200, body = AzimuthEntry), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn withdraw_azimuth(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, AzimuthId)>,
    ValidOrNone(withdrawal): ValidOrNone<Withdrawal>,
) -> Result<Json<AzimuthEntry>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let given = withdrawal.reason.filter(|reason| !reason.trim().is_empty());
    let reason = given.map(|reason| text("reason", &reason)).transpose()?;
    let now = app.clock.now().into();
    let mut change = Change::begin(&app, &request, vessel, now).await?;
    let author = Author::user(change.tx(), writer.user, now).await?;
    let tx = change.tx();
    if store::withdraw(tx, vessel, id, reason.as_deref(), &author).await? {
        change.commit().await?;
    }
    Ok(Json(store::must_find(&app.db, vessel, id).await?))
}

/// Returns the compass that was named. Only a vessel's single compass need not be.
async fn named_compass(db: &Db, vessel: VesselId, named: Option<CompassId>) -> Result<CompassId> {
    let compasses = compasses::of_vessel(db, vessel).await?;
    let ids: Vec<CompassId> = compasses.iter().map(|compass| compass.id).collect();
    let detail = match (named, ids.as_slice()) {
        (None, [single]) => return Ok(*single),
        (Some(id), ids) if ids.contains(&id) => return Ok(id),
        (None, _) => "name the compass: the vessel has several",
        (Some(_), _) => "the vessel has no such compass",
    };
    Err(Error::Invalid {
        field: "compass_id",
        detail: detail.to_owned(),
    })
}
