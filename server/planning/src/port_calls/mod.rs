//! Port calls: when a vessel is where, and how sure that is.
//!
//! What always holds:
//!
//! - Calls of one vessel do not overlap, and none is entered when it is over. Whoever
//!   changes a vessel's calls holds her row until the transaction ends.
//! - Who is to come to a call that moves is told in the same transaction; the orders are
//!   held before the calls are written.
//! - A call is never removed and no revision of it is lost: it is amended, or withdrawn
//!   and kept.
//! - A file is taken whole or not at all, and the same file again changes nothing.

mod call;
mod file;
mod heading;
mod moving;
mod ports;
mod store;
mod subscriber;
mod upload;

pub use call::{Content, LearntFrom, LearntHeading, PortCall, Source};
pub use heading::{Earlier, heading};
pub use store::{Row, ahead};
pub use subscriber::note_berth_heading;

use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_fleet::vessels;
use binnacle_orders::dispatch::{announce_call_updates, attach_new_calls};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::events::{self, Event};
use binnacle_platform::http::{Id, Json, Page, Params, Valid, ValidOrNone, optional_text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{CallId, OperatorId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::calls::overlap;
use call::{Amendment, AmendmentSchema, CallList, Filter, NewCall, RevisedCall, Withdrawal};
use store::Author;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
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
    listed(&app, reader.operator, None, filter, &page).await
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
    listed(&app, reader.operator, Some(id), filter, &page).await
}

async fn listed(
    app: &App,
    operator: OperatorId,
    vessel: Option<VesselId>,
    filter: Filter,
    page: &Page,
) -> Result<Json<CallList>> {
    let (filter, after) = (filter.checked()?, page.after_time()?);
    let found = store::list(&app.db, operator, vessel, &filter, after, page.fetch()).await?;
    let earlier = Earlier::of_fleet(&app.db, operator, app.clock.now().into()).await?;
    let shown: Result<Vec<PortCall>> = found.into_iter().map(|row| row.shown(&earlier)).collect();
    let listed = page.cut(shown?, PortCall::cursor);
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
              (status = 409, description = "It overlaps another call, or there is one of this \
                             reference", body = Problem),
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
    let is_named = new.reference.is_some();
    let mut call = new.checked(now)?;
    let wanted = CallId::new();
    let mut tx = request.begin().await?;
    let known = store::lock(&mut tx, writer.operator, vessel).await?;
    let made = key
        .once(&mut tx, writer.operator, &request_hash, wanted.0, now)
        .await?;
    if made == wanted.0 {
        if !is_named {
            call.reference = free_name(&known, call.reference);
        }
        must_be_new(&known, &call)?;
        must_fit(&known, None, &call)?;
        let author = Author::of(&mut tx, writer.user, now).await?;
        store::insert(&mut tx, vessel, wanted, &call, Source::Api, &author).await?;
        let came = [(wanted, moving::alongside(&call))];
        let told = attach_new_calls(&mut tx, vessel, &came, &author.name, now).await?;
        commit(&app, tx, &[vessel], told, now).await?;
    }
    let shown = shown(&app, writer.operator, vessel, CallId(made)).await?;
    Ok((StatusCode::CREATED, Json(shown)))
}

/// See a port call with all its revisions
#[utoipa::path(get, path = "/vessels/{id}/port-calls/{call}", tag = "adjusting",
    params(("id" = VesselId, Path), ("call" = CallId, Path)),
    responses((status = 200, body = RevisedCall), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_port_call(
    State(app): State<App>,
    reader: Reader,
    Id((vessel, id)): Id<(VesselId, CallId)>,
) -> Result<Json<RevisedCall>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    Ok(Json(RevisedCall {
        call: shown(&app, reader.operator, vessel, id).await?,
        revisions: store::revisions(&app.db, vessel, id).await?,
    }))
}

/// Amend a port call
///
/// What is left out stays as it is; null takes a value away. The call as it was is kept
/// among its revisions.
#[utoipa::path(patch, path = "/vessels/{id}/port-calls/{call}", tag = "adjusting",
    params(("id" = VesselId, Path), ("call" = CallId, Path)), request_body = AmendmentSchema,
    responses((status = 200, body = PortCall), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It would overlap another call", body = Problem),
              (status = 410, description = "The call is withdrawn", body = Problem),
              (status = 422, body = Problem)))]
async fn amend_port_call(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, id)): Id<(VesselId, CallId)>,
    Valid(amendment): Valid<Amendment>,
) -> Result<Json<PortCall>> {
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let known = store::lock(&mut tx, writer.operator, vessel).await?;
    let current = known.iter().find(|row| row.id == id);
    let current = current.ok_or(Error::NotFound("port call"))?;
    if current.withdrawn_at.is_some() {
        return Err(Error::Gone("this port call is withdrawn"));
    }
    let was = current.content()?;
    let amended = amendment.applied_to(&was, now)?;
    if amended == was {
        drop(tx);
        return Ok(Json(shown(&app, writer.operator, vessel, id).await?));
    }
    must_fit(&known, Some(id), &amended)?;
    let author = Author::of(&mut tx, writer.user, now).await?;
    let moving = moving::amended(current, &amended)?;
    let mut told =
        announce_call_updates(&mut tx, vessel, moving.as_slice(), &author.name, now).await?;
    store::revise(&mut tx, current, &amended, Source::Api, &author).await?;
    let is = [(id, moving::alongside(&amended))];
    told.extend(attach_new_calls(&mut tx, vessel, &is, &author.name, now).await?);
    commit(&app, tx, &[vessel], told, now).await?;
    Ok(Json(shown(&app, writer.operator, vessel, id).await?))
}

/// Withdraw a port call
///
/// It stays, marked, and counts no more. Withdrawing it again changes nothing.
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
        let author = Author::of(&mut tx, writer.user, now).await?;
        let moving = [moving::withdrawn(current)?];
        let told = announce_call_updates(&mut tx, vessel, &moving, &author.name, now).await?;
        store::withdraw(&mut tx, current, reason.as_deref(), &author).await?;
        commit(&app, tx, &[vessel], told, now).await?;
    } else {
        drop(tx);
    }
    Ok(Json(shown(&app, writer.operator, vessel, id).await?))
}

async fn shown(app: &App, operator: OperatorId, vessel: VesselId, id: CallId) -> Result<PortCall> {
    let row = store::must_find(&app.db, vessel, id).await?;
    let earlier = Earlier::of_fleet(&app.db, operator, app.clock.now().into()).await?;
    row.shown(&earlier)
}

/// Makes changes of some vessels' calls durable, and tells the dashboards, also of what they
/// brought to work orders.
async fn commit(
    app: &App,
    mut tx: Tx,
    vessels: &[VesselId],
    mut told: Vec<Event>,
    now: Time,
) -> Result<()> {
    for vessel in vessels {
        told.push(events::insert(&mut tx, *vessel, events::Kind::PortCall, now).await?);
    }
    tx.commit().await?;
    for event in told {
        app.publish(event);
    }
    Ok(())
}

/// A name that no withdrawn call has: she may well come to that port then after all.
fn free_name(known: &[Row], name: String) -> String {
    let is_gone = |name: &str| {
        let mut gone = known.iter().filter(|row| row.withdrawn_at.is_some());
        gone.any(|row| row.reference == name)
    };
    let again = (2..).map(|n| format!("{name} ({n})"));
    let mut names = std::iter::once(name.clone()).chain(again);
    names.find(|name| !is_gone(name)).unwrap_or(name)
}

fn must_be_new(known: &[Row], call: &Content) -> Result<()> {
    match known.iter().find(|row| row.reference == call.reference) {
        None => Ok(()),
        Some(there) if there.withdrawn_at.is_some() => Err(Error::WrongState(format!(
            "there was a call of reference {:?}, which is withdrawn: give this one another",
            call.reference
        ))),
        Some(there) => Err(Error::WrongState(format!(
            "there is a call of reference {:?} already, {}: amend that",
            call.reference, there.id
        ))),
    }
}

/// Checks that a call, new or in place of `instead_of`, overlaps no other.
fn must_fit(known: &[Row], instead_of: Option<CallId>, call: &Content) -> Result<()> {
    let others = known
        .iter()
        .filter(|row| row.withdrawn_at.is_none() && Some(row.id) != instead_of);
    let mut calls = vec![call.of(&call.reference, "")];
    for other in others {
        calls.push(other.content()?.of(&other.reference, ""));
    }
    // Others that overlap one another would not have been stored.
    let Some((later, earlier)) = overlap(&calls) else {
        return Ok(());
    };
    let other = &calls[later.max(earlier)];
    Err(Error::WrongState(format!(
        "eta and etd overlap call {:?} of the same vessel, from {} to {}",
        other.id, other.eta, other.etd
    )))
}
