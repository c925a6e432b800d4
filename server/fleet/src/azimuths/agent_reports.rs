//! Azimuths that agents send from on board.

use super::entry::invalid_report;
use super::store::{self, Author, NewRow};
use crate::agent_auth::Agent;
use crate::logbook::Change;
use axum::extract::{FromRef, State};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid};
use binnacle_platform::ids::AzimuthId;
use binnacle_wire::messages::{BoardAzimuth, BoardAzimuthResponse};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the route for agents.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(put_azimuth))
}

/// Send an azimuth from on board
///
/// Responds when it is durable. The same azimuth again changes nothing and gets the same
/// response; with `withdrawn` it is withdrawn for good.
#[utoipa::path(put, path = "/agents/azimuths/{id}", tag = "agents", security(("token" = [])),
    params(("id" = AzimuthId, Path, description = "Made on board")),
    request_body = BoardAzimuth,
    responses((status = 200, body = BoardAzimuthResponse), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn put_azimuth(
    State(app): State<App>,
    request: RequestContext,
    agent: Agent,
    Id(id): Id<AzimuthId>,
    Valid(sent): Valid<BoardAzimuth>,
) -> Result<Json<BoardAzimuthResponse>> {
    let now = app.clock.now();
    let report = sent.report.checked(now).map_err(invalid_report)?;
    let row = NewRow {
        vessel: agent.vessel_id,
        id,
        compass: agent.compass_id,
        report: &report,
    };
    let author = Author::agent(&agent, &report, now.into());
    let mut change = Change::begin(&app, &request, agent.vessel_id, now.into()).await?;
    let tx = change.tx();
    let is_new = store::insert(tx, &row, &author).await?;
    if !store::is_from_on_board(tx, agent.vessel_id, id).await? {
        return Err(Error::NotFound("azimuth"));
    }
    let is_withdrawn_now =
        sent.withdrawn && store::withdraw(tx, agent.vessel_id, id, None, &author).await?;
    if is_new || is_withdrawn_now {
        change.commit().await?;
    }
    let entry = store::must_find(&app.db, agent.vessel_id, id).await?;
    Ok(Json(BoardAzimuthResponse {
        withdrawn: entry.withdrawn_at.is_some(),
    }))
}
