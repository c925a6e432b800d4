//! Work orders: one compass of one vessel, adjusted at the berth without a swing.
//!
//! What always holds:
//!
//! - An order is its log: entries that are never changed or removed, each naming the
//!   hash of the one before. How it stands follows from them, in the same transaction.
//! - The same request again under its key writes nothing more, and is answered by the
//!   order as it is: a page at the binnacle sends again after a bad connection.
//! - What is foretold says so until headings at sea agree. Nothing here issues a
//!   certificate.

mod at_berth;
mod basis;
mod change;
pub mod completion;
pub mod entry;
mod finish;
mod order;
pub mod photos;
mod plan;
mod reading;
mod record;
mod refusal;
mod schema;
mod standing;
mod steps;
mod store;
mod verification;

pub use order::State;
pub use refusal::{Cure, Refusal};
pub use verification::{after_analysis, alert};

use crate::access::{Reader, Writer};
use crate::app::App;
use crate::compasses;
use crate::error::{Error, Problem, Result};
use crate::events;
use crate::http::{Id, Json, Page, Params, Valid, text};
use crate::idempotency::{self, Key};
use crate::ids::OrderId;
use crate::session;
use crate::vessels;
use axum::extract::State as Shared;
use axum::http::StatusCode;
use change::Request;
use completion::write_binnacle;
use entry::{Author, Content, Said};
use order::{Filter, NewOrder, Opened, Order, OrderList};
use schema::{LineList, LineSchema};
use serde::{Deserialize, Serialize};
use store::Whole;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// The routes of this part.
pub fn router() -> OpenApiRouter<App> {
    finish::router()
        .routes(routes!(list_work_orders, create_work_order))
        .routes(routes!(find_work_order))
        .routes(routes!(list_entries))
        .routes(routes!(remark))
        .routes(routes!(cancel_work_order))
        .routes(routes!(close_work_order))
        .merge(at_berth::router())
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
    reader: Reader,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<OrderList>> {
    let before = page.after_id()?;
    let found = store::list(&app.db, reader.operator, &filter, before, page.fetch()).await?;
    let listed = page.cut(found, |order| order.id.to_string());
    Ok(Json(OrderList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Order a compass to be adjusted
///
/// A compass has one order under way at a time.
#[utoipa::path(post, path = "/work-orders", tag = "adjusting", params(Key),
    request_body = NewOrder,
    responses((status = 201, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Another order of this compass is under way", body = Problem),
              (status = 422, body = Problem)))]
async fn create_work_order(
    Shared(app): Shared<App>,
    writer: Writer,
    key: Key,
    Valid(new): Valid<NewOrder>,
) -> Result<(StatusCode, Json<Order>)> {
    let hash = idempotency::request_hash("work order", &new)?;
    let vessel = vessels::find_row(&app.db, writer.operator, new.vessel_id).await?;
    let vessel = vessel.ok_or(Error::NotFound("vessel"))?;
    let compass = compasses::find(&app.db, new.vessel_id, Some(new.compass_id)).await?;
    let opened = Opened {
        order: new.checked()?,
        vessel_name: vessel.name,
        compass_name: compass.name,
    };
    let made = open(&app, writer, &key, &hash, opened).await?;
    Ok((
        StatusCode::CREATED,
        shown(&app, writer.operator, made).await?,
    ))
}

async fn open(
    app: &App,
    writer: Writer,
    key: &Key,
    hash: &[u8],
    opened: Opened,
) -> Result<OrderId> {
    let now = app.clock.now().into();
    let wanted = OrderId::new();
    let mut tx = app.db.begin().await?;
    let made = key
        .once(&mut tx, writer.operator, hash, wanted.0, now)
        .await?;
    if made != wanted.0 {
        return Ok(OrderId(made));
    }
    let (vessel, compass) = (opened.order.vessel_id, opened.order.compass_id);
    if store::is_under_way(&mut tx, vessel, compass).await? {
        return Err(Error::WrongState(
            "another order of this compass is under way".to_owned(),
        ));
    }
    let author = Author {
        id: Some(writer.user.0),
        name: session::name_of(&mut tx, writer.user).await?,
    };
    store::insert(&mut tx, wanted, &opened.order, &author, now).await?;
    let mut whole = store::lock(&mut tx, vessel, wanted).await?;
    let content = Content::Opened(Box::new(opened));
    store::append(&mut tx, &mut whole, Uuid::now_v7(), &author, now, content).await?;
    let event = events::insert(&mut tx, vessel, events::Kind::WorkOrder, now).await?;
    tx.commit().await?;
    app.publish(event);
    Ok(wanted)
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
    reader: Reader,
    Id(id): Id<OrderId>,
) -> Result<Json<Order>> {
    shown(&app, reader.operator, id).await
}

/// Read a work order's log
#[utoipa::path(get, path = "/work-orders/{id}/entries", tag = "adjusting",
    params(("id" = OrderId, Path), Page),
    responses((status = 200, body = LineList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_entries(
    Shared(app): Shared<App>,
    reader: Reader,
    Id(id): Id<OrderId>,
    page: Page,
) -> Result<Json<LineList>> {
    let summary = store::summary(&app.db, reader.operator, id).await?;
    let after = page.after_number()?;
    let found = store::lines(&app.db, summary.vessel_id, id, after, page.fetch()).await?;
    let listed = page.cut(found, |(seq, _, _)| seq.to_string());
    let read = |(seq, line, sha256): (i64, String, String)| {
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
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<Remark>,
) -> Result<Json<Order>> {
    let said = said(&remark)?;
    let request = request(&app, writer, id, key, "remark", &remark)?;
    let (whole, done) = request.look().await?;
    if done.is_none()
        && let Some(mut change) = request.begin(&whole).await?
    {
        change.append(Content::Remark(said)).await?;
        change.commit().await?;
    }
    shown(&app, writer.operator, id).await
}

/// Cancel a work order
///
/// Correctors that were moved stay as they stand: the binnacle's next revision says so,
/// and the logbook has the moment.
#[utoipa::path(post, path = "/work-orders/{id}/cancel", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Remark,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, body = Problem), (status = 422, body = Problem)))]
async fn cancel_work_order(
    Shared(app): Shared<App>,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<Remark>,
) -> Result<Json<Order>> {
    let said = said(&remark)?;
    let request = request(&app, writer, id, key, "cancellation", &remark)?;
    let (whole, done) = request.look().await?;
    if done.is_some() {
        return shown(&app, writer.operator, id).await;
    }
    let allowed = [State::Planned, State::Measured, State::Adjusting];
    whole.must_be(&allowed, "it cannot be cancelled any more")?;
    if let Some(mut change) = request.begin(&whole).await? {
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
    let left = binnacle.with_setting(setting.clone())?;
    write_binnacle(change, &left, "left").await?;
    let (now, port) = (change.now, change.whole.summary.port.clone());
    completion::write_logbook(change, crate::ids::EntryId::new(), now, &port).await
}

/// Close a work order
#[utoipa::path(post, path = "/work-orders/{id}/close", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Remark,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Not before headings at sea have spoken", body = Problem),
              (status = 422, body = Problem)))]
async fn close_work_order(
    Shared(app): Shared<App>,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<Remark>,
) -> Result<Json<Order>> {
    let said = said(&remark)?;
    let request = request(&app, writer, id, key, "closing", &remark)?;
    let (whole, done) = request.look().await?;
    if done.is_some() {
        return shown(&app, writer.operator, id).await;
    }
    let allowed = [State::Verified, State::Failed];
    whole.must_be(&allowed, "it is closed when headings at sea have spoken")?;
    if let Some(mut change) = request.begin(&whole).await? {
        change.append(Content::Closed(said)).await?;
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
fn request<'a>(
    app: &'a App,
    writer: Writer,
    order: OrderId,
    key: Key,
    what: &str,
    content: &impl Serialize,
) -> Result<Request<'a>> {
    Ok(Request {
        app,
        writer,
        order,
        key,
        hash: idempotency::request_hash(&format!("{what} of {order}"), content)?,
    })
}

/// The order as it is.
async fn shown(app: &App, operator: crate::ids::OperatorId, id: OrderId) -> Result<Json<Order>> {
    let whole: Whole = store::whole(&app.db, operator, id).await?;
    let standing = whole.standing();
    Ok(Json(Order::new(whole.summary, standing)))
}
