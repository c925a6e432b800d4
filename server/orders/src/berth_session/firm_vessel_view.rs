//! View of the vessel for a firm with an open order.
//!
//! Invariants: a firm reads model and binnacle of the order's compass alone, and only from the
//! offer to the completion of the adjustment. The audit log records each access.

use crate::work_orders::store;
use crate::work_orders::summary::Summary;
use axum::extract::{FromRef, State as Shared};
use binnacle_fleet::binnacles::{self, BinnacleRevision};
use binnacle_fleet::models::{self, ModelVersion};
use binnacle_platform::access::PartyReader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json};
use binnacle_platform::ids::OrderId;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(find_model))
        .routes(routes!(find_order_binnacle))
}

/// See the model of a work order's compass
///
/// For a firm while the order is open to it and not completed. Each access is recorded.
#[utoipa::path(get, path = "/work-orders/{id}/model", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, body = ModelVersion), (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model yet", body = Problem)))]
async fn find_model(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Json<ModelVersion>> {
    let summary = open(&app, &reader, id, "model").await?;
    let model = models::must_have(&app, summary.vessel_id, summary.compass_id).await?;
    Ok(Json(model.into_version()))
}

/// See the binnacle of a work order's compass
///
/// For a firm while the order is open to it and not completed. Each access is recorded.
#[utoipa::path(get, path = "/work-orders/{id}/binnacle", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, body = BinnacleRevision), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_order_binnacle(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Json<BinnacleRevision>> {
    let summary = open(&app, &reader, id, "binnacle").await?;
    let found = binnacles::current(&app.db, summary.vessel_id, summary.compass_id).await?;
    Ok(Json(
        found.ok_or(Error::NotFound("binnacle"))?.into_revision(),
    ))
}

/// Returns the order, if the reader may read this of its compass now.
async fn open(app: &App, reader: &PartyReader, id: OrderId, what: &'static str) -> Result<Summary> {
    let summary = store::find_summary(&app.db, reader.tenant, id).await?;
    if reader.tenant.firm().is_some() && !summary.state.is_under_way() {
        return Err(Error::NotFound(what));
    }
    Ok(summary)
}
