//! Work orders: one compass of one vessel, adjusted at the berth without a swing; offered to
//! firms, and carried to its end by the one that takes it.
//!
//! What always holds:
//!
//! - An order is its log: entries that are never changed or removed, each naming the
//!   hash of the one before. How it stands follows from them, in the same transaction.
//! - The same request again under its key writes nothing more, and is answered by the
//!   order as it is: a page at the binnacle sends again after a bad connection.
//! - What is foretold says so until headings at sea agree. Nothing here issues a
//!   certificate.

mod aboard;
mod again;
mod answers;
mod asked;
mod at_berth;
mod basis;
mod call_links;
mod came;
mod change;
pub mod completion;
mod deadlines;
mod done;
mod earlier;
pub mod entry;
mod find;
mod finish;
mod keys;
mod messages;
mod moved;
mod news;
mod notices;
mod offering;
mod offers;
mod order;
pub mod photos;
mod place;
mod plan;
mod reading;
mod record;
mod refusal;
mod retime;
mod schema;
mod second;
mod standing;
mod steps;
mod store;
mod subscriber;
mod turns;
mod verification;
mod view;
mod whereabouts;

pub use at_berth::BerthHeadingRead;
pub use call_links::link_once;
pub use came::calls_come;
pub use deadlines::{lapse, watch};
pub use done::{Done, Span, done};
pub use moved::{Alongside, CallFit, Moving, calls_move};
pub use offering::NewOffer;
pub use order::{NewOrder, State};
pub use refusal::{Cure, NotAdjustableFields, Refusal};
pub use store::lock_compass;
pub use subscriber::{refuse_amended_binnacle, refuse_leave_of_service};
pub use verification::{after_analysis, unconfirmed_adjustment};

use axum::extract::{FromRef, RawPathParams, Request, State as Shared};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn};
use axum::response::Response;
use binnacle_fleet::vessels;
use binnacle_platform::access::{PartyReader, PartyWriter, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::events::Event;
use binnacle_platform::http::{Id, Json, Page, Params, Valid, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{OperatorId, OrderId, VesselId};
use binnacle_platform::session;
use binnacle_platform::tenants::Tenant;
use change::{Change, OrderUpdate};
use completion::write_binnacle;
use entry::{Author, Content, Entry, Said};
use order::{Filter, Opened, Order, OrderList};
use schema::{LineList, LineSchema};
use serde::{Deserialize, Serialize};
use store::Whole;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_work_orders, create_work_order))
        .merge(router_of_one())
}

/// The routes of one order. In the audit log each request has its order, and what firms read
/// is logged.
fn router_of_one<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    finish::router()
        .routes(routes!(find_work_order))
        .routes(routes!(list_entries))
        .routes(routes!(remark))
        .routes(routes!(cancel_work_order))
        .routes(routes!(close_work_order))
        .merge(at_berth::router())
        .merge(again::router())
        .merge(answers::router())
        .merge(retime::router())
        .merge(messages::router())
        .merge(aboard::router())
        .route_layer(from_fn(log_order))
}

/// Tells the audit log which order a request is about.
async fn log_order(
    context: RequestContext,
    path: RawPathParams,
    request: Request,
    next: Next,
) -> Response {
    let mut ids = path.iter().map(|(_, value)| Uuid::parse_str(value));
    if let Some(order) = ids.find_map(std::result::Result::ok) {
        context.concerns_order(OrderId(order), find::vessel_of);
    }
    context.log_reads_of_firms();
    next.run(request).await
}

/// Something to be said of an order.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OrderRemark, example = json!({ "text": "Crane alongside until noon." }))]
struct Remark {
    /// In words.
    #[schema(min_length = 1, max_length = 200)]
    text: String,
}

/// List work orders
#[utoipa::path(get, path = "/work-orders", tag = "adjusting", params(Filter, Page),
    responses((status = 200, body = OrderList), (status = 401, body = Problem)))]
async fn list_work_orders(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<OrderList>> {
    let before = page.after_id()?;
    let found = store::list(&app.db, reader.tenant, &filter, before, page.fetch()).await?;
    let listed = page.cut(found, |order| order.id.to_string());
    Ok(Json(OrderList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Order a compass to be adjusted
///
/// A compass has one order under way at a time. With an `offer` it is offered to firms at
/// once.
#[utoipa::path(post, path = "/work-orders", tag = "adjusting", params(Key),
    request_body = NewOrder,
    responses((status = 201, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Another order of this compass is under way", body = Problem),
              (status = 422, body = Problem)))]
async fn create_work_order(
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
        shown(&app, operator, OrderId(made)).await?,
    ))
}

/// Writes a new order, and offers it where that is asked for.
///
/// # Errors
/// [`Error::WrongState`] when another order of the compass is under way or the vessel out of
/// service, and what is wrong with the offer.
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
    let (vessel_name, compass_name) = store::names(&mut tx, operator, vessel, compass).await?;
    if store::is_under_way(&mut tx, vessel, compass).await? {
        return Err(Error::WrongState(
            "another order of this compass is under way".to_owned(),
        ));
    }
    if !vessels::is_in_service(&mut tx, vessel).await? {
        return Err(Error::WrongState(format!(
            "{vessel_name} is out of service: take her back into it first"
        )));
    }
    // Whom it is offered to stands in entries of their own.
    let offer = new.offer.take();
    let now = app.clock.now().into();
    request.concerns_vessel(vessel, Some(id));
    store::insert(&mut tx, id, &new, &author, now).await?;
    let whole = store::lock(&mut tx, vessel, id).await?;
    let mut change = Change::new(app, tx, whole, author, now, Uuid::now_v7());
    let opened = Opened {
        order: new,
        vessel_name,
        compass_name,
    };
    change.append(Content::Opened(Box::new(opened))).await?;
    let at = change.whole.summary.planned_at;
    place::must_be_there(&mut change, at, "port").await?;
    if let Some(offer) = offer {
        let offered = offer.checked(&mut change.tx, operator).await?;
        offering::offer(&mut change, offered).await?;
    }
    Ok(change)
}

/// Writes an order under an id and offers it, as the schedule has it, in a transaction that
/// goes on: what there is to be told when it is committed comes back with it.
///
/// # Errors
/// [`Error::WrongState`] when another order of the compass is under way, and what is wrong
/// with the order or its offer.
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
    change.settle().await
}

/// Cancels an order that every firm declined, for another in its place, in a transaction that
/// goes on; one that is under way no more is in nobody's way.
///
/// # Errors
/// [`Error::WrongState`] when firms are asked for it still, or one has it.
pub async fn give_way(
    app: &App,
    mut tx: Tx,
    writer: Writer,
    vessel: VesselId,
    id: OrderId,
) -> Result<(Tx, Vec<Event>)> {
    let author = author(&mut tx, writer).await?;
    let whole = store::lock(&mut tx, vessel, id).await?;
    let state = whole.summary.state;
    if !state.is_under_way() {
        return Ok((tx, Vec::new()));
    }
    if state != State::Declined {
        return Err(Error::WrongState(format!(
            "work order {id} is under way and says something else: cancel it, or agree on \
             another time"
        )));
    }
    let now = app.clock.now().into();
    let mut change = Change::new(app, tx, whole, author, now, Uuid::now_v7());
    let text = "declined by every firm, and offered anew as the schedule has it".to_owned();
    change.append(Content::Cancelled(Said { text })).await?;
    change.settle().await
}

/// An operator's person, as entries name them.
async fn author(tx: &mut Tx, writer: Writer) -> Result<Author> {
    Ok(Author {
        id: Some(writer.user.0),
        name: session::name_of(tx, writer.user).await?,
        firm_id: None,
    })
}

/// See a work order
///
/// With all that the next thing to do depends on: the page at the binnacle asks for
/// nothing else.
#[utoipa::path(get, path = "/work-orders/{id}", tag = "adjusting", params(("id" = OrderId, Path)),
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_work_order(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Json<Order>> {
    shown(&app, reader.tenant, id).await
}

/// Read a work order's log
///
/// What is between the operator and another firm is withheld from a firm; its hash stays.
#[utoipa::path(get, path = "/work-orders/{id}/entries", tag = "adjusting",
    params(("id" = OrderId, Path), Page),
    responses((status = 200, body = LineList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_entries(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
    page: Page,
) -> Result<Json<LineList>> {
    let summary = store::summary(&app.db, reader.tenant, id).await?;
    let after = page.after_number()?;
    let found = store::lines(&app.db, summary.vessel_id, id, after, page.fetch()).await?;
    let listed = page.cut(found, |(seq, _, _)| seq.to_string());
    let read = |(seq, line, sha256): (i64, String, String)| {
        let entry: Entry = serde_json::from_str(&line)?;
        let line = view::line(reader.tenant, &entry, line, &sha256)?;
        let entry = serde_json::from_str(&line)?;
        Ok(LineSchema { seq, sha256, entry })
    };
    let items: Result<Vec<LineSchema>> = listed.items.into_iter().map(read).collect();
    Ok(Json(LineList {
        items: items?,
        next: listed.next,
    }))
}

/// Say something of a work order
#[utoipa::path(post, path = "/work-orders/{id}/remarks", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Remark,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn remark(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<Remark>,
) -> Result<Json<Order>> {
    let said = said(&remark)?;
    let update = order_update(&app, request, writer, id, key, "remark", &remark)?;
    let (whole, done) = update.look().await?;
    if done.is_none()
        && let Some(mut change) = update.begin(&whole).await?
    {
        change.append(Content::Remark(said)).await?;
        change.commit().await?;
    }
    shown(&app, writer.tenant, id).await
}

/// Cancel a work order
///
/// For the operator; a firm declines. Correctors that were moved stay as they stand: the binnacle's next revision says so,
/// and the logbook has the moment.
#[utoipa::path(post, path = "/work-orders/{id}/cancel", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Remark,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, body = Problem), (status = 422, body = Problem)))]
async fn cancel_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<Remark>,
) -> Result<Json<Order>> {
    let said = said(&remark)?;
    let update = order_update(&app, request, writer, id, key, "cancellation", &remark)?;
    let (whole, done) = update.look().await?;
    if done.is_some() {
        return shown(&app, writer.operator, id).await;
    }
    if !whole.summary.state.is_under_way() {
        whole.must_be(&[], "it cannot be cancelled any more")?;
    }
    if let Some(mut change) = update.begin(&whole).await? {
        leave_as_it_stands(&mut change).await?;
        change.append(Content::Cancelled(said)).await?;
        change.commit().await?;
    }
    shown(&app, writer.operator, id).await
}

/// Notes correctors that were moved though the adjustment came to nothing.
async fn leave_as_it_stands(change: &mut change::Change<'_>) -> Result<()> {
    let standing = change.whole.standing();
    if !standing.was_moved() {
        return Ok(());
    }
    let (Some(binnacle), Some(setting)) = (&standing.binnacle, standing.setting()) else {
        return Ok(());
    };
    let left = binnacle
        .with_setting(setting.clone())
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    write_binnacle(change, &left, "left").await?;
    let (now, port) = (change.now, change.whole.summary.port.clone());
    completion::write_logbook(change, binnacle_platform::ids::EntryId::new(), now, &port).await
}

/// How an order is closed.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OrderClosing, example = json!({ "text": "Papers are filed." }))]
struct Closing {
    /// Why, in words.
    #[schema(min_length = 1, max_length = 200)]
    text: String,
    /// Close it though no headings at sea have spoken, as of a ship that sends no more. What
    /// was foretold stays foretold.
    #[serde(default)]
    without_verification: bool,
}

/// Close a work order
///
/// When headings at sea have spoken. One that no headings will be sent for is closed
/// `without_verification`: it is `closed_unverified` then, its card stays predicted, and nothing
/// says that it was verified.
#[utoipa::path(post, path = "/work-orders/{id}/close", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Closing,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Not before headings at sea have spoken, but for one \
                             that was adjusted `without_verification`", body = Problem),
              (status = 422, body = Problem)))]
async fn close_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(closing): Valid<Closing>,
) -> Result<Json<Order>> {
    let text = text("text", &closing.text)?;
    let update = order_update(&app, request, writer, id, key, "closing", &closing)?;
    let (whole, done) = update.look().await?;
    if done.is_some() {
        return shown(&app, writer.operator, id).await;
    }
    let unverified = closing.without_verification && whole.summary.state == State::Adjusted;
    if !unverified {
        let allowed = [State::Verified, State::Failed];
        whole.must_be(
            &allowed,
            "it is closed when headings at sea have spoken, or once adjusted without_verification",
        )?;
    }
    if let Some(mut change) = update.begin(&whole).await? {
        let text = if unverified {
            format!("closed without verification: {text}")
        } else {
            text
        };
        change.append(Content::Closed(Said { text })).await?;
        change.commit().await?;
    }
    shown(&app, writer.operator, id).await
}

fn said(remark: &Remark) -> Result<Said> {
    Ok(Said {
        text: text("text", &remark.text)?,
    })
}

/// A request to change an order, told from others by what it asks.
fn order_update<'a>(
    app: &'a App,
    request: RequestContext,
    writer: impl Into<PartyWriter>,
    order: OrderId,
    key: Key,
    what: &str,
    content: &impl Serialize,
) -> Result<OrderUpdate<'a>> {
    Ok(OrderUpdate {
        app,
        request,
        writer: writer.into(),
        order,
        key,
        hash: idempotency::request_hash(&format!("{what} of {order}"), content)?,
    })
}

/// The order as it is.
async fn shown(app: &App, tenant: impl Into<Tenant>, id: OrderId) -> Result<Json<Order>> {
    let tenant = tenant.into();
    let whole: Whole = store::whole(&app.db, tenant, id).await?;
    let standing = whole.standing();
    Ok(Json(Order::new(whole.summary, standing, tenant)))
}
