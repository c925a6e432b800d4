//! Binnacles: built-in designs, and the binnacle of each compass with its correctors and their
//! setting.
//!
//! Invariants:
//!
//! - A stored binnacle has been checked as a whole. No revision of one is ever changed or deleted.
//! - Requests and responses have the same form (docs/binnacle.md), which `plan --binnacle` reads
//!   too.

mod built_in;
mod fleet;
mod setting_text;
mod store;

pub use setting_text::describe_setting;
pub use store::{Author, StoredRevision, current, current_in, insert, lock};

use crate::compasses;
use crate::vessels;
use axum::extract::{FromRef, State};
use axum::http::header::{CONTENT_DISPOSITION, HeaderName};
use binnacle_adjustment::binnacle::{Binnacle, BinnacleError, BinnacleForm};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::DomainEvent;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{
    Id, IfMatch, Json, Page, Params, Valid, Version, Versioned, optional_text,
};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{BinnacleId, CompassId, VesselId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Announces that a compass's binnacle is about to change.
pub struct BinnacleAmended {
    /// The vessel.
    pub vessel: VesselId,
    /// The compass.
    pub compass: CompassId,
}

impl DomainEvent for BinnacleAmended {}

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .merge(built_in::router())
        .merge(fleet::router())
        .routes(routes!(find_binnacle, put_binnacle))
        .routes(routes!(list_revisions))
        .routes(routes!(export_binnacle))
}

/// A revision of a compass's binnacle.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct BinnacleRevision {
    /// Counts from 1.
    pub revision: i64,
    /// Time of the revision.
    pub at: Time,
    /// Author of the revision.
    pub by: String,
    /// Reason, in a few words.
    #[schema(required)]
    pub reason: Option<String>,
    /// The binnacle, with the correctors on board and their setting.
    #[schema(value_type = BinnacleForm)]
    pub binnacle: Binnacle,
}

/// A page of revisions.
#[derive(Serialize, ToSchema)]
struct BinnacleRevisionList {
    /// The newest first.
    items: Vec<BinnacleRevision>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// Reason for a new revision.
#[derive(Deserialize, Serialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct RevisionReason {
    /// The reason in a few words, such as a purchase or a measurement.
    #[param(max_length = 200)]
    reason: Option<String>,
}

/// See a compass's binnacle
#[utoipa::path(get, path = "/vessels/{id}/compasses/{compass}/binnacle", tag = "adjusting",
    params(("id" = VesselId, Path), ("compass" = CompassId, Path)),
    responses((status = 200, body = BinnacleRevision, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_binnacle(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, compass)): Id<(VesselId, CompassId)>,
) -> Result<Versioned<BinnacleRevision>> {
    must_be_of_fleet(&app, reader.operator, vessel, compass).await?;
    find_current(&app, vessel, compass).await
}

async fn find_current(
    app: &App,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Versioned<BinnacleRevision>> {
    let found = store::current(&app.db, vessel, compass).await?;
    let found = found.ok_or(Error::NotFound("binnacle"))?;
    let version = Version::of(&found.revision)?;
    Ok(Versioned(found.into_revision(), version))
}

/// Write a compass's binnacle
///
/// The whole of it: its type, the correctors on board and how they stand. What was
/// written before stays among its revisions; the same again makes no new one.
#[utoipa::path(put, path = "/vessels/{id}/compasses/{compass}/binnacle", tag = "adjusting",
    params(("id" = VesselId, Path), ("compass" = CompassId, Path), RevisionReason, IfMatch, Key),
    request_body = BinnacleForm,
    responses((status = 200, body = BinnacleRevision, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
#[allow(clippy::too_many_arguments, reason = "each is a part of the request")]
async fn put_binnacle(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, compass)): Id<(VesselId, CompassId)>,
    Params(why): Params<RevisionReason>,
    if_match: IfMatch,
    key: Key,
    Valid(form): Valid<BinnacleForm>,
) -> Result<Versioned<BinnacleRevision>> {
    must_be_of_fleet(&app, writer.operator, vessel, compass).await?;
    let request_hash = idempotency::request_hash(&format!("binnacle of {compass}"), &form)?;
    let reason = optional_text("reason", why.reason.as_deref())?;
    let binnacle = Binnacle::try_from(form).map_err(invalid_binnacle)?;
    binnacle.check_tested_moments().map_err(invalid_binnacle)?;
    let now = app.clock.now().into();
    let new_id = BinnacleId::new();
    let mut tx = request.begin().await?;
    let made = key
        .once(&mut tx, writer.operator, &request_hash, new_id.0, now)
        .await?;
    if made == new_id.0 {
        vessels::lock(&mut tx, writer.operator, vessel).await?;
        if_match.check(&store::current_version(&mut tx, vessel, compass).await?)?;
        tx.publish(&BinnacleAmended { vessel, compass }).await?;
        let author = Author {
            id: writer.user.0,
            name: session::name_of(&mut tx, writer.user).await?,
            at: now,
        };
        let why = reason.as_deref();
        store::insert(&mut tx, vessel, compass, new_id, &binnacle, why, &author).await?;
        tx.commit().await?;
    }
    find_current(&app, vessel, compass).await
}

/// List the revisions of a compass's binnacle
#[utoipa::path(get, path = "/vessels/{id}/compasses/{compass}/binnacle/revisions",
    tag = "adjusting",
    params(("id" = VesselId, Path), ("compass" = CompassId, Path), Page),
    responses((status = 200, body = BinnacleRevisionList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_revisions(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, compass)): Id<(VesselId, CompassId)>,
    page: Page,
) -> Result<Json<BinnacleRevisionList>> {
    must_be_of_fleet(&app, reader.operator, vessel, compass).await?;
    let before = page.after_number()?;
    let found = store::list(&app.db, vessel, compass, before, page.fetch()).await?;
    let listed = page.cut(found, |revised| revised.revision.to_string());
    Ok(Json(BinnacleRevisionList {
        items: listed
            .items
            .into_iter()
            .map(StoredRevision::into_revision)
            .collect(),
        next: listed.next,
    }))
}

/// Export a compass's binnacle as a file
///
/// As `binnacle-server plan --binnacle` reads it, and as it can be written again.
#[utoipa::path(get, path = "/vessels/{id}/compasses/{compass}/binnacle.json", tag = "adjusting",
    params(("id" = VesselId, Path), ("compass" = CompassId, Path)),
    responses((status = 200, body = BinnacleForm), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn export_binnacle(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, compass)): Id<(VesselId, CompassId)>,
) -> Result<([(HeaderName, &'static str); 1], Json<Binnacle>)> {
    must_be_of_fleet(&app, reader.operator, vessel, compass).await?;
    let found = store::current(&app.db, vessel, compass).await?;
    let binnacle = found.ok_or(Error::NotFound("binnacle"))?.binnacle.0;
    let as_file = (
        CONTENT_DISPOSITION,
        "attachment; filename=\"binnacle.json\"",
    );
    Ok(([as_file], Json(binnacle)))
}

async fn must_be_of_fleet(
    app: &App,
    operator: binnacle_platform::ids::OperatorId,
    vessel: VesselId,
    compass: CompassId,
) -> Result<()> {
    vessels::must_be_in_fleet(&app.db, operator, vessel).await?;
    compasses::find(&app.db, vessel, Some(compass)).await?;
    Ok(())
}

impl StoredRevision {
    /// Returns the revision as the API shows it.
    pub fn into_revision(self) -> BinnacleRevision {
        BinnacleRevision {
            revision: self.revision,
            at: self.at,
            by: self.author_name,
            reason: self.reason,
            binnacle: self.binnacle.0,
        }
    }
}

/// Returns the refusal of an invalid binnacle.
#[allow(
    clippy::needless_pass_by_value,
    reason = "it is what map_err hands over"
)]
pub fn invalid_binnacle(error: BinnacleError) -> Error {
    Error::Invalid {
        field: "binnacle",
        detail: error.to_string(),
    }
}
