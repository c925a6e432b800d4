//! Rescheduling of an order that a firm has: the operator proposes a time, the firm accepts or
//! declines.
//!
//! Invariants: the agreed time stands until the firm accepts. The new time lies in a call of the
//! vessel at the order's port, as long as the job, and one of the firm's teams has these hours.
//! Both are checked at the proposal and at the acceptance.

use crate::dispatch::offer_requests::{
    MAX_ANSWER_HOURS, OfferAnswer, TeamJob, checked_terms, require_capacity,
};
use crate::dispatch::offer_sequence::answer_by;
use crate::dispatch::{call_links, port_call_check};
use crate::firms::{Requester, named_port};
use crate::work_orders::events::{OrderEvent, RetimeAccepted, RetimeDeclined, RetimeProposed};
use crate::work_orders::new_order::default_answer_hours;
use crate::work_orders::offers::Offer;
use crate::work_orders::order::Order;
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::exchange::{Exchange, Terms};
use crate::work_orders::payload::hours::Hours;
use crate::work_orders::payload::port_call::CallFit;
use crate::work_orders::state::State;
use crate::work_orders::{load_order, prepare_update, store};
use axum::extract::{FromRef, State as Shared};
use binnacle_platform::access::{PartyWriter, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, ValidOrNone, optional_text};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::OrderId;
use binnacle_platform::tenants::Tenant;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(propose_retime))
        .routes(routes!(accept_retime))
        .routes(routes!(decline_retime))
}

/// Proposal of another time.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewRetime, example = json!({
    "terms": { "planned_at": "2026-12-10T08:00:00Z", "planned_until": "2026-12-10T11:00:00Z" },
    "answer_within_hours": 24,
    "text": "She is two days late."
}))]
struct RetimeRequest {
    /// Time, and berth if another.
    terms: Terms,
    /// Time for an answer, 1 to 720 hours; the agreed time stands after it.
    #[serde(default = "default_answer_hours")]
    #[schema(minimum = 1, maximum = 720)]
    answer_within_hours: u32,
    /// Text.
    #[serde(default)]
    #[schema(max_length = 200)]
    text: Option<String>,
}

/// Propose another time to the firm that has an order
///
/// For the operator, before the adjuster is on board. The agreed time stands until the firm
/// accepts. A repeated proposal replaces the last one.
#[utoipa::path(post, path = "/work-orders/{id}/retime", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = RetimeRequest,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "No firm has it, the work has begun, the vessel is \
                  not alongside then, or the firm has no team left that day", body = Problem),
              (status = 422, body = Problem)))]
async fn propose_retime(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(retime): Valid<RetimeRequest>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "retime", &retime)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.operator, id).await;
    }
    let hours = retime.answer_within_hours;
    if !(1..=MAX_ANSWER_HOURS).contains(&hours) {
        return Err(Error::Invalid {
            field: "answer_within_hours",
            detail: format!("{hours} is outside 1 to {MAX_ANSWER_HOURS}"),
        });
    }
    let before = stored.summary.hours();
    let terms = checked_terms(retime.terms, before, app.clock.now().into())?;
    let text = optional_text("text", retime.text.as_deref())?;
    stored.require_state(
        &[State::Accepted],
        "only a firm that has it can be asked for another \
        time",
    )?;
    if let Some(mut change) = update.begin(&stored).await? {
        let holder = holder(&change)?;
        let requester = Requester::Operator;
        require_possible_time(&mut change, &holder, terms.hours(), requester).await?;
        let between = Exchange {
            answer_by: Some(answer_by(&change, hours, terms.planned_at)),
            terms: Some(terms),
            text,
            ..Exchange::with(holder.firm())
        };
        change
            .append(OrderEvent::RetimeProposed(RetimeProposed(between)))
            .await?;
        change.commit().await?;
    }
    load_order(&app, writer.operator, id).await
}

/// Accept another time
///
/// For the firm that has the order.
#[utoipa::path(post, path = "/work-orders/{id}/retime/accept", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = OfferAnswer,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "No other time is proposed, or no longer, or the call \
                  has moved meanwhile", body = Problem),
              (status = 422, body = Problem)))]
async fn accept_retime(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(answer): ValidOrNone<OfferAnswer>,
) -> Result<Json<Order>> {
    let update = prepare_update(
        &app,
        request,
        writer,
        id,
        key,
        "yes to another time",
        &answer,
    )?;
    let answer = answer.checked(writer.tenant)?;
    let summary = store::find_summary(&app.db, writer.tenant, id).await?;
    let Tenant::Firm(firm) = writer.tenant else {
        return Err(Error::WrongState(
            "only the firm that has the order can accept another time".to_owned(),
        ));
    };
    if let Some(mut change) = update.begin_on(summary.vessel_id).await? {
        let offer = holder(&change)?;
        if offer.firm_id != firm {
            return Err(Error::NotFound("work order"));
        }
        let terms = proposed_terms(&change, &offer)?;
        // Agreed terms other than the time stand.
        let agreed = offer.terms.clone();
        let terms = Terms {
            berth: (terms.berth).or_else(|| agreed.as_ref()?.berth.clone()),
            fee_eur: terms.fee_eur.or_else(|| offer.fee()),
            ..terms
        };
        let team =
            require_possible_time(&mut change, &offer, terms.hours(), Requester::Firm).await?;
        call_links::link_call_at(&mut change, terms.planned_at).await?;
        let agreed = Exchange {
            terms: Some(terms),
            team,
            text: answer.text,
            ..Exchange::with(offer.firm())
        };
        change
            .append(OrderEvent::RetimeAccepted(RetimeAccepted(agreed)))
            .await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Decline another time
///
/// The agreed time stands. The operator withdraws its proposal in the same way.
#[utoipa::path(post, path = "/work-orders/{id}/retime/decline", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = OfferAnswer,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "No other time is proposed, or no longer", body = Problem),
              (status = 422, body = Problem)))]
async fn decline_retime(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(answer): ValidOrNone<OfferAnswer>,
) -> Result<Json<Order>> {
    let update = prepare_update(
        &app,
        request,
        writer,
        id,
        key,
        "no to another time",
        &answer,
    )?;
    let answer = answer.checked(writer.tenant)?;
    let summary = store::find_summary(&app.db, writer.tenant, id).await?;
    if let Some(mut change) = update.begin_on(summary.vessel_id).await? {
        let offer = holder(&change)?;
        if writer
            .tenant
            .firm()
            .is_some_and(|firm| firm != offer.firm_id)
        {
            return Err(Error::NotFound("work order"));
        }
        if answer.firm_id.is_some_and(|firm| firm != offer.firm_id) {
            return Err(Error::Invalid {
                field: "firm_id",
                detail: "is not the firm that has the order".to_owned(),
            });
        }
        proposed_terms(&change, &offer)?;
        let between = Exchange {
            text: answer.text,
            ..Exchange::with(offer.firm())
        };
        change
            .append(OrderEvent::RetimeDeclined(RetimeDeclined(between)))
            .await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Firm that has an order, before the work begins.
fn holder(change: &Change<'_>) -> Result<Offer> {
    change.stored.require_state(
        &[State::Accepted],
        "only a firm that has it can be asked for another time",
    )?;
    let offers = change.stored.state().offers;
    let holder = offers.holder().cloned();
    holder.ok_or_else(|| Error::WrongState("no firm has the order".to_owned()))
}

/// Terms that the firm has been proposed.
fn proposed_terms(change: &Change<'_>, offer: &Offer) -> Result<Terms> {
    let wrong = |why: &str| Err(Error::WrongState(why.to_owned()));
    let Some(terms) = offer.new_terms.clone() else {
        return wrong("no other time is proposed");
    };
    if offer.answer_by.is_some_and(|by| by < change.now) {
        return wrong("the proposal has lapsed: the agreed time stands");
    }
    Ok(terms)
}

/// Port of an order, if its call is known.
async fn order_port(change: &mut Change<'_>) -> Result<Option<String>> {
    if let Some(port) = change.stored.state().port {
        return Ok(Some(port));
    }
    let (vessel, planned_at) = (
        change.stored.summary.vessel_id,
        change.stored.summary.planned_at,
    );
    let id = change.stored.summary.id;
    if let Some(port) = call_links::linked_port(&mut change.tx, vessel, id).await? {
        return Ok(Some(port));
    }
    let call = call_links::call_at(&mut change.tx, vessel, planned_at).await?;
    let named = named_port(&change.stored.summary.port).map(|port| port.code.to_string());
    let is_orders_port = |port: &String| named.as_ref().is_none_or(|named| named == port);
    Ok(call.map(|call| call.port).filter(is_orders_port))
}

/// Refuses hours in which the vessel is not there, or the firm has no team. Returns the team, if it
/// has a name.
///
/// # Errors
/// [`Error::WrongState`], with the reason.
async fn require_possible_time(
    change: &mut Change<'_>,
    offer: &Offer,
    hours: Hours,
    requester: Requester,
) -> Result<Option<String>> {
    let firm = offer.firm();
    let job = TeamJob {
        firm: &firm,
        team: offer.team.as_deref(),
        hours,
    };
    // Without any known call the firm judges for itself.
    let Some(port) = order_port(change).await? else {
        port_call_check::require_vessel_in_port(change, hours, "planned_at").await?;
        return require_capacity(change, &job, requester).await;
    };
    let vessel = change.stored.summary.vessel_id;
    let call = call_links::call_at(&mut change.tx, vessel, hours.from).await?;
    let fit = match &call {
        Some(call) => call.alongside()?.fit(&port, hours),
        None => CallFit::NoCall,
    };
    if fit != CallFit::Fits {
        return Err(Error::WrongState(format!(
            "the vessel has no call at {port} that lasts from {} to {}",
            hours.from.to_the_minute(),
            hours.until.to_the_minute()
        )));
    }
    require_capacity(change, &job, requester).await
}
