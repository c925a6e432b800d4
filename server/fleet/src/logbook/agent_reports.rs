//! Logbook reports that agents send from on board.

use super::entry::{NewEntry, invalid_report};
use super::store::{self, Author, Change};
use crate::agent_auth::Agent;
use axum::extract::{FromRef, State};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid};
use binnacle_platform::ids::EntryId;
use binnacle_wire::logbook::reporter;
use binnacle_wire::messages::{LogbookReport, LogbookResponse};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the route for agents.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(put_report))
}

/// Send a report from on board
///
/// Responds when it is durable. The same report again, an older revision, or a revision of an
/// entry withdrawn on shore changes nothing and gets the same response.
#[utoipa::path(put, path = "/agents/logbook/{id}", tag = "agents", security(("token" = [])),
    params(("id" = EntryId, Path, description = "Made on board")),
    request_body = LogbookReport,
    responses((status = 200, body = LogbookResponse), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn put_report(
    State(app): State<App>,
    request: RequestContext,
    agent: Agent,
    Id(id): Id<EntryId>,
    Valid(sent): Valid<LogbookReport>,
) -> Result<Json<LogbookResponse>> {
    let now = app.clock.now();
    let (revision, withdrawn) = (sent.revision, sent.withdrawn);
    if revision == 0 {
        return Err(Error::Invalid {
            field: "revision",
            detail: "0 is below 1".to_owned(),
        });
    }
    let author = Author::agent(
        &agent,
        reporter(&sent.reporter).map_err(invalid_report)?,
        revision,
        now.into(),
    );
    let content = NewEntry {
        report: sent.report.checked(now).map_err(invalid_report)?,
        compass_id: None,
    };
    let mut change = Change::begin(&app, &request, agent.vessel_id, now.into()).await?;
    let tx = change.tx();
    let is_new = store::insert(tx, agent.vessel_id, id, &content, &author).await?;
    let current = store::lock(tx, agent.vessel_id, id).await?;
    let known = current.board_revision.ok_or(Error::NotFound("report"))?;
    let counts = current.withdrawn_at.is_none() && (is_new || revision > known);
    if counts && !is_new {
        store::revise(tx, &current, &content, &author).await?;
    }
    if counts && withdrawn {
        store::withdraw(tx, &current, None, &author).await?;
    }
    if counts {
        change.commit().await?;
    }
    Ok(Json(LogbookResponse {
        revision: revision.max(known),
        withdrawn: current.withdrawn_at.is_some() || (counts && withdrawn),
    }))
}
