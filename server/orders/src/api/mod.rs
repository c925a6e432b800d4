//! Routes of work orders: creating, reading, cancelling and closing them.

mod actions;
mod as_found;
mod create;

pub use create::{cancel_declined, write};

use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::berth_session::{berth_api, firm_vessel_view, second_reading_api};
use crate::completion::completion_api;
use crate::dispatch::{messages, offer_api, reschedule};
use crate::work_orders::log::entry::Entry;
use crate::work_orders::log::entry_list::{EntryLine, EntryList};
use crate::work_orders::log::firm_view;
use crate::work_orders::order::Order;
use crate::work_orders::store::StoredLine;
use crate::work_orders::summary::{Filter, OrderList};
use crate::work_orders::{load_order, store};
use axum::extract::{FromRef, RawPathParams, Request, State as Shared};
use axum::middleware::{Next, from_fn};
use axum::response::Response;
use binnacle_platform::access::PartyReader;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params, Period};
use binnacle_platform::ids::OrderId;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Routes of work orders.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    CorrectorPlanSlots: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_work_orders, create::create_work_order))
        .merge(router_of_one())
}

/// Routes of a single order. The audit log names the order of each request, and records what
/// firms read.
fn router_of_one<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    CorrectorPlanSlots: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    completion_api::router()
        .routes(routes!(find_work_order))
        .routes(routes!(list_entries))
        .routes(routes!(actions::remark))
        .routes(routes!(actions::cancel_work_order))
        .routes(routes!(actions::close_work_order))
        .routes(routes!(as_found::report_as_found))
        .merge(berth_api::router())
        .merge(second_reading_api::router())
        .merge(offer_api::router())
        .merge(reschedule::router())
        .merge(messages::router())
        .merge(firm_vessel_view::router())
        .route_layer(from_fn(log_order))
}

/// Names the order of a request in the audit log.
async fn log_order(
    context: RequestContext,
    path: RawPathParams,
    request: Request,
    next: Next,
) -> Response {
    let mut ids = path.iter().map(|(_, value)| Uuid::parse_str(value));
    if let Some(order) = ids.find_map(std::result::Result::ok) {
        context.is_about(order, store::find_vessel);
    }
    context.log_reads_of_firms();
    next.run(request).await
}

/// List work orders
///
/// `from` and `to` are about the time of the job.
#[utoipa::path(get, path = "/work-orders", tag = "adjusting",
    params(Filter, Period, Page),
    responses((status = 200, body = OrderList), (status = 401, body = Problem),
              (status = 422, body = Problem)))]
async fn list_work_orders(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Params(filter): Params<Filter>,
    Params(period): Params<Period>,
    page: Page,
) -> Result<Json<OrderList>> {
    let asked = store::ListedOrders {
        filter,
        planned: period.micros()?,
        before: page.after_id()?,
        limit: page.fetch(),
    };
    let found = store::list(&app.db, reader.tenant, &asked).await?;
    let listed = page.cut(found, |order| order.id.to_string());
    Ok(Json(OrderList {
        items: listed.items,
        next: listed.next,
    }))
}

/// See a work order
///
/// Contains everything that the next action depends on.
#[utoipa::path(get, path = "/work-orders/{id}", tag = "adjusting", params(("id" = OrderId, Path)),
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_work_order(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Json<Order>> {
    load_order(&app, reader.tenant, id).await
}

/// Read a work order's log
///
/// Exchanges with other firms are withheld from a firm; their hashes stay.
#[utoipa::path(get, path = "/work-orders/{id}/entries", tag = "adjusting",
    params(("id" = OrderId, Path), Page),
    responses((status = 200, body = EntryList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_entries(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
    page: Page,
) -> Result<Json<EntryList>> {
    let summary = store::find_summary(&app.db, reader.tenant, id).await?;
    let after = page.after_number()?;
    let found = store::list_lines(&app.db, summary.vessel_id, id, after, page.fetch()).await?;
    let listed = page.cut(found, |line| line.seq.to_string());
    let read = |stored: StoredLine| {
        let seal = stored.seal();
        let entry: Entry = serde_json::from_str(&stored.line)?;
        let line = firm_view::line(reader.tenant, &entry, stored.line, &stored.sha256)?;
        Ok(EntryLine {
            seq: stored.seq,
            sha256: stored.sha256,
            seal,
            entry: serde_json::from_str(&line)?,
        })
    };
    let items: Result<Vec<EntryLine>> = listed.items.into_iter().map(read).collect();
    Ok(Json(EntryList {
        items: items?,
        next: listed.next,
    }))
}
