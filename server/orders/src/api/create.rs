//! Creation of work orders, and cancellation of an order that every firm declined.

use crate::dispatch::{offer_requests, port_call_check};
use crate::work_orders::events::{Cancelled, Opened, OrderEvent};
use crate::work_orders::log::entry::Author;
use crate::work_orders::new_order::NewOrder;
use crate::work_orders::order::Order;
use crate::work_orders::order_update::Change;
use crate::work_orders::state::State;
use crate::work_orders::{load_order, store};
use axum::extract::State as Shared;
use axum::http::StatusCode;
use binnacle_fleet::vessels;
use binnacle_platform::access::Writer;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::events::Event;
use binnacle_platform::http::{Json, Valid};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{OperatorId, OrderId, VesselId};
use binnacle_platform::session;
use uuid::Uuid;

/// Order a compass to be adjusted
///
/// A compass has at most one order under way. An order with an `offer` is offered to firms at
/// once.
#[utoipa::path(post, path = "/work-orders", tag = "adjusting", params(Key),
    request_body = NewOrder,
    responses((status = 201, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Another order of this compass is under way", body = Problem),
              (status = 422, body = Problem)))]
pub(super) async fn create_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    key: Key,
    Valid(new): Valid<NewOrder>,
) -> Result<(StatusCode, Json<Order>)> {
    let hash = idempotency::request_hash("work order", &new)?;
    let now = app.clock.now().into();
    let new = new.checked(now)?;
    let wanted = OrderId::new();
    let operator = writer.operator;
    let mut tx = request.begin().await?;
    let made = key.once(&mut tx, operator, &hash, wanted.0, now).await?;
    if made == wanted.0 {
        let author = author(&mut tx, writer).await?;
        let change = open(&app, &request, tx, operator, wanted, new, author).await?;
        change.commit().await?;
    }
    Ok((
        StatusCode::CREATED,
        load_order(&app, operator, OrderId(made)).await?,
    ))
}

/// Creates an order, and offers it to firms if requested.
///
/// # Errors
/// [`Error::WrongState`] when another order of the compass is under way or the vessel is out of
/// service, and any error of the offer.
async fn open<'a>(
    app: &'a App,
    request: &RequestContext,
    mut tx: Tx,
    operator: OperatorId,
    id: OrderId,
    mut new: NewOrder,
    author: Author,
) -> Result<Change<'a>> {
    let (vessel, compass) = (new.vessel_id, new.compass_id);
    let (vessel_name, compass_name) = store::find_names(&mut tx, operator, vessel, compass).await?;
    if store::is_under_way(&mut tx, vessel, compass).await? {
        return Err(Error::WrongState(
            "another order of this compass is under way".to_owned(),
        ));
    }
    if !vessels::is_in_service(&mut tx, vessel).await? {
        return Err(Error::WrongState(format!(
            "{vessel_name} is out of service: return the vessel to service first"
        )));
    }
    // The offer has entries of its own.
    let offer = new.offer.take();
    let now = app.clock.now().into();
    request.concerns_vessel(vessel, Some(id.0));
    store::insert(&mut tx, id, &new, &author, now).await?;
    let stored = store::lock(&mut tx, vessel, id).await?;
    let mut change = Change::new(app, tx, stored, author, now, Uuid::now_v7());
    let opened = Opened {
        order: new,
        vessel_name,
        compass_name,
    };
    change.append(OrderEvent::Opened(Box::new(opened))).await?;
    let hours = change.stored.summary.hours();
    port_call_check::require_vessel_in_port(&mut change, hours, "port").await?;
    if let Some(offer) = offer {
        let offered = offer.checked(&mut change.tx, operator).await?;
        offer_requests::offer(&mut change, offered).await?;
    }
    Ok(change)
}

/// Creates an order under an id and offers it, as the schedule requests, in an open transaction.
/// Returns the live events, to be published after the commit.
///
/// # Errors
/// [`Error::WrongState`] when another order of the compass is under way, and any error of the
/// order or its offer.
pub async fn write(
    app: &App,
    request: &RequestContext,
    mut tx: Tx,
    writer: Writer,
    id: OrderId,
    new: NewOrder,
) -> Result<(Tx, Vec<Event>)> {
    let author = author(&mut tx, writer).await?;
    let new = new.checked(app.clock.now().into())?;
    let change = open(app, request, tx, writer.operator, id, new, author).await?;
    change.finish().await
}

/// Cancels an order that every firm declined, to make way for another, in an open transaction. An
/// order that is no longer under way stays as it is.
///
/// # Errors
/// [`Error::WrongState`] when an offer is open or a firm has the order.
pub async fn cancel_declined(
    app: &App,
    mut tx: Tx,
    writer: Writer,
    vessel: VesselId,
    id: OrderId,
) -> Result<(Tx, Vec<Event>)> {
    let author = author(&mut tx, writer).await?;
    let stored = store::lock(&mut tx, vessel, id).await?;
    let state = stored.summary.state;
    if !state.is_under_way() {
        return Ok((tx, Vec::new()));
    }
    if state != State::Declined {
        return Err(Error::WrongState(format!(
            "work order {id} is under way on other terms: cancel it, or agree on another time"
        )));
    }
    let now = app.clock.now().into();
    let mut change = Change::new(app, tx, stored, author, now, Uuid::now_v7());
    let text = "declined by every firm, and offered again by the schedule".to_owned();
    change
        .append(OrderEvent::Cancelled(Cancelled { text }))
        .await?;
    change.finish().await
}

/// Author of entries for a user of the operator.
async fn author(tx: &mut Tx, writer: Writer) -> Result<Author> {
    Ok(Author {
        id: Some(writer.user.0),
        name: session::name_of(tx, writer.user).await?,
        firm_id: None,
    })
}
