//! Handlers of offers to firms, and of their answers.

use crate::dispatch::offer_requests::{
    self, Decision, FirmAnswer, OfferAnswer, Proposal, answer_as_firm, answer_as_operator,
};
use crate::work_orders::events::{Boarding, OrderEvent};
use crate::work_orders::new_order::NewOffer;
use crate::work_orders::order::Order;
use crate::work_orders::state::State;
use crate::work_orders::{load_order, prepare_update, store};
use axum::extract::{FromRef, State as Shared};
use axum::http::StatusCode;
use binnacle_platform::access::{PartyWriter, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, ValidOrNone};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{OrderId, VesselId};
use binnacle_platform::tenants::Tenant;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(offer_work_order))
        .routes(routes!(accept_work_order))
        .routes(routes!(decline_work_order))
        .routes(routes!(propose_terms))
        .routes(routes!(go_on_board))
}

/// Offer a work order to firms
///
/// One after the other, or to all at once. An offer without an answer lapses, and the next firm
/// follows.
#[utoipa::path(post, path = "/work-orders/{id}/offer", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = NewOffer,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "An offer is open, or the work has begun", body = Problem),
              (status = 422, body = Problem)))]
async fn offer_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(new): Valid<NewOffer>,
) -> Result<Json<Order>> {
    let operator = writer.operator;
    let update = prepare_update(&app, request, writer, id, key, "offer", &new)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, operator, id).await;
    }
    let allowed = [State::Planned, State::Declined];
    stored.require_state(
        &allowed,
        "it can be offered before a firm has it, and not while an offer is open",
    )?;
    if let Some(mut change) = update.begin(&stored).await? {
        let offered = new.checked(&mut change.tx, operator).await?;
        offer_requests::offer(&mut change, offered).await?;
        change.commit().await?;
    }
    load_order(&app, operator, id).await
}

/// Vessel of an order to answer. A firm whose offer has ended finds it too: the error then names
/// the reason.
async fn vessel_of(app: &App, tenant: Tenant, id: OrderId) -> Result<VesselId> {
    match tenant {
        Tenant::Firm(firm) => store::find_vessel_for_firm(&app.db, firm, id).await,
        Tenant::Operator(_) => Ok(store::find_summary(&app.db, tenant, id).await?.vessel_id),
    }
}

/// Accept an offer, or a proposal
///
/// A firm accepts the order as it was offered; an operator accepts a firm's proposal. Of several
/// firms that accept at once, one gets the order.
#[utoipa::path(post, path = "/work-orders/{id}/accept", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = OfferAnswer,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is nothing to accept, or no longer", body = Problem),
              (status = 422, body = Problem)))]
async fn accept_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(answer): ValidOrNone<OfferAnswer>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "yes", &answer)?;
    let answer = answer.checked(writer.tenant)?;
    let vessel = vessel_of(&app, writer.tenant, id).await?;
    if let Some(mut change) = update.begin_on(vessel).await? {
        match writer.tenant {
            Tenant::Firm(firm) => {
                answer_as_firm(&mut change, firm, FirmAnswer::Accept(answer)).await?;
            }
            Tenant::Operator(_) => {
                answer_as_operator(&mut change, answer, Decision::Accept).await?;
            }
        }
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Decline an offer, or a proposal
///
/// A firm declines the order, or gives it back before the adjuster is on board; an operator
/// declines a firm's proposal. The next firm receives an offer.
#[utoipa::path(post, path = "/work-orders/{id}/decline", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = OfferAnswer,
    responses((status = 204), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is nothing to decline, or no longer", body = Problem),
              (status = 422, body = Problem)))]
async fn decline_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(answer): ValidOrNone<OfferAnswer>,
) -> Result<StatusCode> {
    let update = prepare_update(&app, request, writer, id, key, "no", &answer)?;
    let answer = answer.checked(writer.tenant)?;
    let vessel = vessel_of(&app, writer.tenant, id).await?;
    if let Some(mut change) = update.begin_on(vessel).await? {
        match writer.tenant {
            Tenant::Firm(firm) => {
                answer_as_firm(&mut change, firm, FirmAnswer::Decline(answer)).await?;
            }
            Tenant::Operator(_) => {
                answer_as_operator(&mut change, answer, Decision::Decline).await?;
            }
        }
        change.commit().await?;
    }
    // The firm no longer sees the order.
    Ok(StatusCode::NO_CONTENT)
}

/// Propose other terms
///
/// For a firm with an open offer: another fee, time or berth, or several of them. Omitted terms
/// stay as offered. The operator accepts or declines by a deadline of its own.
#[utoipa::path(post, path = "/work-orders/{id}/propose", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Proposal,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Your firm has no open offer", body = Problem),
              (status = 422, body = Problem)))]
async fn propose_terms(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(proposal): Valid<Proposal>,
) -> Result<Json<Order>> {
    let Tenant::Firm(firm) = writer.tenant else {
        return Err(Error::Forbidden(
            "only a firm with an open offer proposes terms",
        ));
    };
    let update = prepare_update(&app, request, writer, id, key, "proposal", &proposal)?;
    let vessel = vessel_of(&app, writer.tenant, id).await?;
    let now = app.clock.now().into();
    if let Some(mut change) = update.begin_on(vessel).await? {
        let proposal = proposal.checked(change.stored.summary.hours(), now)?;
        answer_as_firm(&mut change, firm, FirmAnswer::Propose(proposal)).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Report the adjuster on board
///
/// The berth reading follows.
#[utoipa::path(post, path = "/work-orders/{id}/on-board", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Boarding,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "No firm has accepted it yet, or the work has begun", body = Problem),
              (status = 422, body = Problem)))]
async fn go_on_board(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(boarded): ValidOrNone<Boarding>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "on board", &boarded)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    let allowed = [State::Planned, State::Accepted];
    stored.require_state(&allowed, "the adjuster goes on board once a firm has it")?;
    let boarded = boarded.checked(app.clock.now().into())?;
    if let Some(mut change) = update.begin(&stored).await? {
        change.append(OrderEvent::OnBoard(boarded)).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}
