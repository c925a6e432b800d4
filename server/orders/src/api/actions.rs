//! Remarks on a work order, its cancellation and its closing.

use crate::completion::complete::{write_binnacle, write_logbook};
use crate::work_orders::events::{Cancelled, Closed, OrderEvent, Remark};
use crate::work_orders::order::Order;
use crate::work_orders::order_update::Change;
use crate::work_orders::state::State;
use crate::work_orders::{load_order, prepare_update};
use axum::extract::State as Shared;
use binnacle_platform::access::{PartyWriter, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, text};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::OrderId;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Request for a remark, or for a cancellation with its reason.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OrderRemark, example = json!({ "text": "Crane alongside until noon." }))]
pub(super) struct RemarkForm {
    /// Text of the remark.
    #[schema(min_length = 1, max_length = 200)]
    text: String,
}

/// Remark on a work order
#[utoipa::path(post, path = "/work-orders/{id}/remarks", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = RemarkForm,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
pub(super) async fn remark(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<RemarkForm>,
) -> Result<Json<Order>> {
    let text = checked_text(&remark)?;
    let update = prepare_update(&app, request, writer, id, key, "remark", &remark)?;
    let (stored, done) = update.load().await?;
    if done.is_none()
        && let Some(mut change) = update.begin(&stored).await?
    {
        change.append(OrderEvent::Remark(Remark { text })).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Cancel a work order
///
/// For the operator; a firm declines instead. Correctors that were moved keep their settings: the
/// next revision of the binnacle and an entry in the logbook record them.
#[utoipa::path(post, path = "/work-orders/{id}/cancel", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = RemarkForm,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, body = Problem), (status = 422, body = Problem)))]
pub(super) async fn cancel_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(remark): Valid<RemarkForm>,
) -> Result<Json<Order>> {
    let reason = checked_text(&remark)?;
    let update = prepare_update(&app, request, writer, id, key, "cancellation", &remark)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.operator, id).await;
    }
    if !stored.summary.state.is_under_way() {
        stored.require_state(&[], "it can no longer be cancelled")?;
    }
    if let Some(mut change) = update.begin(&stored).await? {
        record_moved_correctors(&mut change).await?;
        change
            .append(OrderEvent::Cancelled(Cancelled { text: reason }))
            .await?;
        change.commit().await?;
    }
    load_order(&app, writer.operator, id).await
}

/// Records correctors that were moved although the order is cancelled.
async fn record_moved_correctors(change: &mut Change<'_>) -> Result<()> {
    let state = change.stored.state();
    if !state.has_moved_correctors() {
        return Ok(());
    }
    let (Some(binnacle), Some(setting)) = (&state.binnacle, state.setting()) else {
        return Ok(());
    };
    let left = binnacle
        .with_setting(setting.clone())
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    write_binnacle(change, &left, "left").await?;
    let (now, port) = (change.now, change.stored.summary.port.clone());
    write_logbook(change, binnacle_platform::ids::EntryId::new(), now, &port).await
}

/// Request to close an order.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OrderClosing, example = json!({ "text": "Papers are filed." }))]
pub(super) struct Closing {
    /// Reason.
    #[schema(min_length = 1, max_length = 200)]
    text: String,
    /// Closes the order although no headings at sea verified it, for a vessel that sends no more
    /// data. Predictions stay predictions.
    #[serde(default)]
    without_verification: bool,
}

/// Close a work order
///
/// After verification by headings at sea. An order without such headings is closed with
/// `without_verification`: its state becomes `closed_unverified`, and its card stays a
/// prediction.
#[utoipa::path(post, path = "/work-orders/{id}/close", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Closing,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "The adjustment is not verified at sea, and the \
                  request is not `without_verification`", body = Problem),
              (status = 422, body = Problem)))]
pub(super) async fn close_work_order(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(closing): Valid<Closing>,
) -> Result<Json<Order>> {
    let text = text("text", &closing.text)?;
    let update = prepare_update(&app, request, writer, id, key, "closing", &closing)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.operator, id).await;
    }
    let unverified = closing.without_verification && stored.summary.state == State::Adjusted;
    if !unverified {
        let allowed = [State::Verified, State::Failed];
        stored.require_state(
            &allowed,
            "it can be closed after verification at sea, or once adjusted with \
                without_verification",
        )?;
    }
    if let Some(mut change) = update.begin(&stored).await? {
        let text = if unverified {
            format!("closed without verification: {text}")
        } else {
            text
        };
        change.append(OrderEvent::Closed(Closed { text })).await?;
        change.commit().await?;
    }
    load_order(&app, writer.operator, id).await
}

fn checked_text(remark: &RemarkForm) -> Result<String> {
    text("text", &remark.text)
}
