//! Port calls of vessels, with the uncertainty of their times.
//!
//! Invariants:
//!
//! - Calls of one vessel do not overlap, and none is entered after its end. A change of a vessel's
//!   calls locks the vessel's row until the transaction ends.
//! - The work orders of a call that moves are updated in the same transaction. They are locked
//!   before the calls are written.
//! - A call is never deleted and no revision is lost: it is amended, or withdrawn and kept.
//! - A file is stored whole or not at all. Sending it again changes nothing.

mod call;
mod commit;
mod heading;
mod moves;
mod ports;
mod store;
mod subscriber;
mod timestamps;
mod upload;
mod uploaded_file;

pub use call::{CallBerthHeading, CallBerthHeadingSource, Content, PortCall, Source};
pub use heading::{EarlierHeadings, heading_alongside};
pub use store::{StoredCall, upcoming_of_fleet, upcoming_within};
pub use subscriber::note_berth_heading;

use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_fleet::vessels;
use binnacle_orders::dispatch::{announce_call_updates, attach_new_calls};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{
    Id, IfMatch, Json, Page, Params, Valid, ValidOrNone, Version, Versioned, optional_text,
};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{CallId, OperatorId, VesselId};
use binnacle_platform::quotas::Quota;
use binnacle_schedule::calls::find_overlap;
use call::{Amendment, CallList, Filter, NewCall, RevisedCall, Withdrawal};
use commit::commit;
use store::Author;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Quota of the port calls of an operator's vessels, those that are over included.
pub const QUOTA: Quota = Quota::new("port_calls", "port calls", 200_000, store::count);

/// Returns the routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_port_calls))
        .routes(routes!(list_vessel_port_calls, enter_port_call))
        .routes(routes!(find_port_call, amend_port_call))
        .routes(routes!(withdraw_port_call))
        .merge(upload::router())
        .merge(timestamps::router())
        .merge(ports::router())
}

/// List the fleet's port calls
#[utoipa::path(get, path = "/port-calls", tag = "adjusting", params(Filter, Page),
    responses((status = 200, body = CallList), (status = 401, body = Problem),
              (status = 422, body = Problem)))]
async fn list_port_calls(
    State(app): State<App>,
    reader: Reader,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<CallList>> {
    list_page(&app, reader.operator, None, filter, &page).await
}

/// List a vessel's port calls
#[utoipa::path(get, path = "/vessels/{id}/port-calls", tag = "adjusting",
    params(("id" = VesselId, Path), Filter, Page),
    responses((status = 200, body = CallList), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn list_vessel_port_calls(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<CallList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    list_page(&app, reader.operator, Some(id), filter, &page).await
}

async fn list_page(
    app: &App,
    operator: OperatorId,
    vessel: Option<VesselId>,
    filter: Filter,
    page: &Page,
) -> Result<Json<CallList>> {
    let filter = filter.checked()?;
    let (after, after_id) = page.after_time()?.unwrap_or((i64::MIN, Uuid::nil()));
    let found = store::list(
        &app.db,
        operator,
        vessel,
        &filter,
        after,
        after_id,
        page.fetch(),
    )
    .await?;
    let earlier = EarlierHeadings::of_fleet(&app.db, operator, app.clock.now().into()).await?;
    let calls: Result<Vec<PortCall>> = found
        .into_iter()
        .map(|row| row.into_call(&earlier))
        .collect();
    let listed = page.cut(calls?, PortCall::cursor);
    Ok(Json(CallList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Enter a port call
#[utoipa::path(post, path = "/vessels/{id}/port-calls", tag = "adjusting",
    params(("id" = VesselId, Path), Key), request_body = NewCall,
    responses((status = 201, body = PortCall), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It overlaps another call, or its reference is in use", body = Problem),
              (status = 422, body = Problem)))]
async fn enter_port_call(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    key: Key,
    Valid(new): Valid<NewCall>,
) -> Result<(StatusCode, Json<PortCall>)> {
    let request_hash = idempotency::request_hash(&format!("port call of {vessel}"), &new)?;
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let now = app.clock.now().into();
    let has_reference = new.reference.is_some();
    let mut call = new.checked(now)?;
    let id = CallId::new();
    let mut tx = request.begin().await?;
    let known = store::lock(&mut tx, writer.operator, vessel).await?;
    let stored = key
        .once(&mut tx, writer.operator, &request_hash, id.0, now)
        .await?;
    if stored == id.0 {
        if !has_reference {
            call.reference = free_reference(&known, call.reference);
        }
        check_reference(&known, &call)?;
        check_overlap(&known, None, &call)?;
        QUOTA.must_have_room(&mut tx, writer.operator, now).await?;
        let author = Author::from_user(&mut tx, writer.user, now).await?;
        store::insert(&mut tx, vessel, id, &call, Source::Api, &author).await?;
        let new = [moves::new_call(id, &call)];
        let pending = attach_new_calls(&mut tx, vessel, &new, &author.name, now).await?;
        commit(&app, tx, &[vessel], pending, now).await?;
    }
    let call = find_call(&app, writer.operator, vessel, CallId(stored)).await?;
    Ok((StatusCode::CREATED, Json(call)))
}

/// See a port call with all its revisions
#[utoipa::path(get, path = "/vessels/{id}/port-calls/{call}", tag = "adjusting",
    params(("id" = VesselId, Path), ("call" = CallId, Path)),
    responses((status = 200, body = RevisedCall, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_port_call(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, id)): Id<(VesselId, CallId)>,
) -> Result<Versioned<RevisedCall>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    let call = find_call(&app, reader.operator, vessel, id).await?;
    let version = Version::of(&call.revision)?;
    let revisions = store::revisions(&app.db, vessel, id).await?;
    Ok(Versioned(RevisedCall { call, revisions }, version))
}

/// Amend a port call
///
/// A field that is left out stays; null removes a value. The earlier content is kept among the
/// revisions.
#[utoipa::path(patch, path = "/vessels/{id}/port-calls/{call}", tag = "adjusting",
    params(("id" = VesselId, Path), ("call" = CallId, Path), IfMatch), request_body = Amendment,
    responses((status = 200, body = PortCall, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It would overlap another call", body = Problem),
              (status = 410, description = "The call is withdrawn", body = Problem),
              (status = 422, body = Problem)))]
async fn amend_port_call(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, CallId)>,
    if_match: IfMatch,
    Valid(amendment): Valid<Amendment>,
) -> Result<Versioned<PortCall>> {
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let known = store::lock(&mut tx, writer.operator, vessel).await?;
    let current = known.iter().find(|row| row.id == id);
    let current = current.ok_or(Error::NotFound("port call"))?;
    if current.withdrawn_at.is_some() {
        return Err(Error::Gone("this port call is withdrawn"));
    }
    if_match.check(&Version::of(&current.revision)?)?;
    let before = current.content()?;
    let amended = amendment.applied_to(&before, now)?;
    if amended == before {
        drop(tx);
        return versioned_call(&app, writer.operator, vessel, id).await;
    }
    check_overlap(&known, Some(id), &amended)?;
    let author = Author::from_user(&mut tx, writer.user, now).await?;
    let moving = moves::amended(current, &amended)?;
    let mut pending =
        announce_call_updates(&mut tx, vessel, moving.as_slice(), &author.name, now).await?;
    store::revise(&mut tx, current, &amended, Source::Api, &author).await?;
    let new = [moves::new_call(id, &amended)];
    pending.extend(attach_new_calls(&mut tx, vessel, &new, &author.name, now).await?);
    commit(&app, tx, &[vessel], pending, now).await?;
    versioned_call(&app, writer.operator, vessel, id).await
}

/// Withdraw a port call
///
/// The call is kept, marked as withdrawn, and no longer counts. Withdrawing it again changes nothing.
#[utoipa::path(post, path = "/vessels/{id}/port-calls/{call}/withdraw", tag = "adjusting",
    params(("id" = VesselId, Path), ("call" = CallId, Path)), request_body = Option<Withdrawal>,
    responses((status = 200, body = PortCall), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn withdraw_port_call(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, CallId)>,
    ValidOrNone(withdrawal): ValidOrNone<Withdrawal>,
) -> Result<Json<PortCall>> {
    let reason = optional_text("reason", withdrawal.reason.as_deref())?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let known = store::lock(&mut tx, writer.operator, vessel).await?;
    let current = known.iter().find(|row| row.id == id);
    let current = current.ok_or(Error::NotFound("port call"))?;
    if current.withdrawn_at.is_none() {
        let author = Author::from_user(&mut tx, writer.user, now).await?;
        let moving = [moves::withdrawn(current)?];
        let pending = announce_call_updates(&mut tx, vessel, &moving, &author.name, now).await?;
        store::withdraw(&mut tx, current, reason.as_deref(), &author).await?;
        commit(&app, tx, &[vessel], pending, now).await?;
    } else {
        drop(tx);
    }
    Ok(Json(find_call(&app, writer.operator, vessel, id).await?))
}

async fn versioned_call(
    app: &App,
    operator: OperatorId,
    vessel: VesselId,
    id: CallId,
) -> Result<Versioned<PortCall>> {
    let call = find_call(app, operator, vessel, id).await?;
    let version = Version::of(&call.revision)?;
    Ok(Versioned(call, version))
}

async fn find_call(
    app: &App,
    operator: OperatorId,
    vessel: VesselId,
    id: CallId,
) -> Result<PortCall> {
    let row = store::must_find(&app.db, vessel, id).await?;
    let earlier = EarlierHeadings::of_fleet(&app.db, operator, app.clock.now().into()).await?;
    row.into_call(&earlier)
}

/// Returns a reference that no withdrawn call has: the vessel may call at that port then after all.
fn free_reference(known: &[StoredCall], reference: String) -> String {
    let is_used = |reference: &str| {
        let mut withdrawn = known.iter().filter(|row| row.withdrawn_at.is_some());
        withdrawn.any(|row| row.reference == reference)
    };
    let numbered = (2..).map(|n| format!("{reference} ({n})"));
    let mut candidates = std::iter::once(reference.clone()).chain(numbered);
    candidates.find(|one| !is_used(one)).unwrap_or(reference)
}

/// Checks that no other call of the vessel has the reference.
fn check_reference(known: &[StoredCall], call: &Content) -> Result<()> {
    match known.iter().find(|row| row.reference == call.reference) {
        None => Ok(()),
        Some(there) if there.withdrawn_at.is_some() => Err(Error::WrongState(format!(
            "reference {:?} belongs to a withdrawn call: use another reference",
            call.reference
        ))),
        Some(there) => Err(Error::WrongState(format!(
            "reference {:?} belongs to call {}: amend that call",
            call.reference, there.id
        ))),
    }
}

/// Checks that a call, new or in place of `replaced`, overlaps no other.
fn check_overlap(known: &[StoredCall], replaced: Option<CallId>, call: &Content) -> Result<()> {
    let others = known
        .iter()
        .filter(|row| row.withdrawn_at.is_none() && Some(row.id) != replaced);
    let mut calls = vec![call.to_schedule_call(&call.reference, "")];
    for other in others {
        calls.push(other.content()?.to_schedule_call(&other.reference, ""));
    }
    // Stored calls do not overlap one another.
    let Some((later, earlier)) = find_overlap(&calls) else {
        return Ok(());
    };
    let other = &calls[later.max(earlier)];
    Err(Error::WrongState(format!(
        "eta and etd overlap call {:?} of the same vessel, from {} to {}",
        other.id, other.eta, other.etd
    )))
}
