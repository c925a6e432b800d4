//! Remarks on a work order, its cancellation and its closing.

use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::completion::complete::{PredictedModel, write_binnacle, write_logbook, write_model};
use crate::work_orders::events::{Cancelled, Closed, OrderEvent, Remark};
use crate::work_orders::log::canonical_json::sha256_hex;
use crate::work_orders::order::Order;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::order_update::Change;
use crate::work_orders::state::State;
use crate::work_orders::{load_order, prepare_update};
use axum::extract::State as Shared;
use binnacle_adjustment::adjust::predict_by_compass;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::model::Model;
use binnacle_platform::access::{PartyWriter, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, MAX_TEXT, Valid, remark as checked};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{EntryId, ModelId, OrderId};
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
/// next revision of the binnacle and an entry in the logbook record them, and a predicted model
/// lets the vessel be planned again. There is no such model after a second reading that contradicts
/// the steps, or a step that nothing explains: headings at sea make the next one.
#[utoipa::path(post, path = "/work-orders/{id}/cancel", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = RemarkForm,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, body = Problem), (status = 422, body = Problem)))]
pub(super) async fn cancel_work_order(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
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
    let state = stored.state();
    let left = predict_left(&slots, &state).await?;
    if let Some(mut change) = update.begin(&stored).await? {
        if state.has_moved_correctors() {
            record_moved_correctors(&mut change, left).await?;
        }
        change
            .append(OrderEvent::Cancelled(Cancelled { text: reason }))
            .await?;
        change.commit().await?;
    }
    load_order(&app, writer.operator, id).await
}

/// Predicts the model of a compass whose correctors were moved; `None` where none was, or where
/// the compass or the magnetometer says that they do not stand as believed.
async fn predict_left(slots: &CorrectorPlanSlots, state: &OrderState) -> Result<Option<Model>> {
    let is_disproved = state.has_unexplained_step || state.contradicting_reading().is_some();
    if !state.has_moved_correctors() || is_disproved {
        return Ok(None);
    }
    if let Some(prediction) = state.confirmed_prediction() {
        return Ok(Some(prediction.model_after.clone()));
    }
    let (plan_request, steps) = (state.plan_request()?, state.steps.clone());
    let predicted = slots.run(move || predict_by_compass(&plan_request.adjustment(), &steps));
    Ok(Some(predicted.await?.model_after))
}

/// Records correctors that were moved although the order is cancelled, and the model of the
/// compass that they leave, if it is known.
async fn record_moved_correctors(change: &mut Change<'_>, model: Option<Model>) -> Result<()> {
    let state = change.stored.state();
    let (Some(binnacle), Some(setting)) = (&state.binnacle, state.setting()) else {
        return Ok(());
    };
    let left = binnacle
        .with_setting(setting.clone())
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    write_binnacle(change, &left, "left").await?;
    let (kind, now) = (LogbookKind::CorrectorChange, change.now);
    if let Some(model) = model {
        let predicted = PredictedModel {
            id: ModelId::new(),
            at: now,
            begun_by: kind,
            input_hash: sha256_hex(&serde_json::to_vec(&model)?),
            model,
        };
        write_model(change, &state, predicted).await?;
    }
    write_logbook(change, kind, EntryId::new(), now).await
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
    let text = checked("text", &closing.text, MAX_TEXT)?;
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
    checked("text", &remark.text, MAX_TEXT)
}
