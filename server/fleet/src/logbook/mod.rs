//! Magnetic logbook: reports of operators and officers about a vessel.
//!
//! Invariants:
//!
//! - An entry is never deleted, and every revision of it is kept. A wrong entry is withdrawn: it
//!   stays in its place, marked, and no longer counts.
//! - One transaction stores a change with its revision, a job to analyse the vessel, and an event
//!   for the dashboards.
//! - A report from on board has the id that it was given there. The same report again, or an older
//!   revision that arrives late, changes nothing.

mod agent_reports;
mod amendment;
mod entry;
mod store;

pub use agent_reports::router as agent_router;
pub(crate) use entry::AuthorKind;
pub(crate) use store::Change;
pub use store::{CompassWork, of_compass, write_compass_work};

use crate::vessels;
use amendment::Amendment;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{
    Id, IfMatch, Json, Page, Params, Valid, ValidOrNone, Version, Versioned, text,
};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{EntryId, VesselId};
use entry::{Filter, LogbookEntry, LogbookList, NewEntry, RevisedEntry, Withdrawal};
use store::Author;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_logbook, report_entry))
        .routes(routes!(find_entry, amend_entry))
        .routes(routes!(withdraw_entry))
}

/// Read a vessel's logbook
///
/// Withdrawn entries stay in it, marked.
#[utoipa::path(get, path = "/vessels/{id}/logbook", tag = "fleet",
    params(("id" = VesselId, Path), Filter, Page),
    responses((status = 200, body = LogbookList), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn list_logbook(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<LogbookList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let filter = filter.checked()?;
    let found = store::list(&app.db, id, &filter, &page).await?;
    let listed = page.cut(found, LogbookEntry::cursor);
    Ok(Json(LogbookList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Report an event that affects a vessel's magnetism
#[utoipa::path(post, path = "/vessels/{id}/logbook", tag = "fleet",
    params(("id" = VesselId, Path), Key), request_body = NewEntry,
    responses((status = 201, body = LogbookEntry), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn report_entry(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    key: Key,
    Valid(new): Valid<NewEntry>,
) -> Result<(StatusCode, Json<LogbookEntry>)> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let request_hash = idempotency::request_hash(&format!("logbook entry of {vessel}"), &new)?;
    let now = app.clock.now();
    let new = new.checked(now)?;
    let new_id = EntryId::new();
    let mut change = Change::begin(&app, &request, vessel, now.into()).await?;
    let tx = change.tx();
    let made = key
        .once(tx, writer.operator, &request_hash, new_id.0, now.into())
        .await?;
    if made == new_id.0 {
        let author = Author::user(tx, writer.user, now.into()).await?;
        store::insert(tx, vessel, new_id, &new, &author).await?;
        change.commit().await?;
    }
    let entry = store::must_find(&app.db, vessel, EntryId(made)).await?;
    Ok((StatusCode::CREATED, Json(entry)))
}

/// See an entry with all its revisions
#[utoipa::path(get, path = "/vessels/{id}/logbook/{entry}", tag = "fleet",
    params(("id" = VesselId, Path), ("entry" = EntryId, Path)),
    responses((status = 200, body = RevisedEntry, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_entry(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, id)): Id<(VesselId, EntryId)>,
) -> Result<Versioned<RevisedEntry>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    let entry = store::must_find(&app.db, vessel, id).await?;
    let version = Version::of(&entry.revision)?;
    let revisions = store::revisions(&app.db, vessel, id).await?;
    Ok(Versioned(RevisedEntry { entry, revisions }, version))
}

/// Amend an entry
///
/// Absent fields stay as they are; null removes a value. The earlier revision is kept.
#[utoipa::path(patch, path = "/vessels/{id}/logbook/{entry}", tag = "fleet",
    params(("id" = VesselId, Path), ("entry" = EntryId, Path), IfMatch), request_body = Amendment,
    responses((status = 200, body = LogbookEntry, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 410, description = "The entry is withdrawn", body = Problem),
              (status = 422, body = Problem)))]
async fn amend_entry(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, EntryId)>,
    if_match: IfMatch,
    Valid(amendment): Valid<Amendment>,
) -> Result<Versioned<LogbookEntry>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let now = app.clock.now();
    let mut change = Change::begin(&app, &request, vessel, now.into()).await?;
    let current = store::lock(change.tx(), vessel, id).await?;
    if current.withdrawn_at.is_some() {
        return Err(Error::Gone("this entry is withdrawn"));
    }
    if_match.check(&Version::of(&current.revision)?)?;
    let amended = amendment.applied_to(current.content.clone()).checked(now)?;
    if amended != current.content {
        let author = Author::user(change.tx(), writer.user, now.into()).await?;
        store::revise(change.tx(), &current, &amended, &author).await?;
        change.commit().await?;
    }
    let entry = store::must_find(&app.db, vessel, id).await?;
    let version = Version::of(&entry.revision)?;
    Ok(Versioned(entry, version))
}

/// Withdraw an entry
///
/// It stays in the logbook, marked, and no longer counts. Withdrawing it again changes nothing.
#[utoipa::path(post, path = "/vessels/{id}/logbook/{entry}/withdraw", tag = "fleet",
    params(("id" = VesselId, Path), ("entry" = EntryId, Path)), request_body = Option<Withdrawal>,
    responses((status = 200, body = LogbookEntry), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn withdraw_entry(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, EntryId)>,
    ValidOrNone(withdrawal): ValidOrNone<Withdrawal>,
) -> Result<Json<LogbookEntry>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let given = withdrawal.reason.filter(|reason| !reason.trim().is_empty());
    let reason = given.map(|reason| text("reason", &reason)).transpose()?;
    let now = app.clock.now().into();
    let mut change = Change::begin(&app, &request, vessel, now).await?;
    let current = store::lock(change.tx(), vessel, id).await?;
    if current.withdrawn_at.is_none() {
        let author = Author::user(change.tx(), writer.user, now).await?;
        store::withdraw(change.tx(), &current, reason.as_deref(), &author).await?;
        change.commit().await?;
    }
    Ok(Json(store::must_find(&app.db, vessel, id).await?))
}
