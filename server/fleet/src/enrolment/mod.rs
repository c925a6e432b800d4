//! Enrolment of an agent for a compass: a one-time code, exchanged for a token.
//!
//! Invariants: a code works once, before it expires, and opens exactly one installation. Code and
//! token are stored only as hashes. A revoked token is never accepted again.

mod store;
mod stream;

pub use store::{open_stream, revoke};
pub use stream::{AgentStream, BoardStatus, LinkWeek};

use crate::agent_auth::Agent;
use crate::compasses;
use crate::vessels;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Valid, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{AgentId, CompassId, VesselId};
use binnacle_platform::secret;
use binnacle_platform::time::Time;
use binnacle_wire::messages::{EnrolRequest, EnrolResponse, NewToken};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Period of the link statistics, seconds.
const WEEK_S: f64 = 7.0 * 86_400.0;
/// Default validity of a code: from a Friday on shore until after the weekend on board.
const DEFAULT_VALID_FOR_S: u32 = 3 * 86_400;
const LONGEST_VALID_FOR_S: u32 = 14 * 86_400;

/// Returns the routes for people.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_agents, create_code))
        .routes(routes!(revoke_agent))
}

/// Returns the routes for agents.
pub fn agent_router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(enrol))
        .routes(routes!(propose_token, replace_token))
}

/// A page of streams.
#[derive(Serialize, ToSchema)]
pub struct AgentStreamList {
    /// In the order in which they were opened.
    pub items: Vec<AgentStream>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// An enrolment code to be made.
#[derive(Default, Serialize, Deserialize, ToSchema)]
#[serde(default)]
pub struct NewCode {
    /// The compass that the agent will report; the vessel's first one by default.
    pub compass_id: Option<CompassId>,
    /// Validity of the code, seconds; three days by default.
    #[schema(minimum = 1, maximum = 1_209_600)]
    pub valid_for_s: Option<u32>,
}

/// An enrolment code.
#[derive(Serialize, ToSchema)]
pub struct EnrolmentCode {
    /// To be typed on board; works once and is never shown again.
    pub code: String,
    /// Time at which it expires.
    pub expires_at: Time,
}

/// List the streams of a vessel's agents
#[utoipa::path(get, path = "/vessels/{id}/agents", tag = "fleet",
    params(("id" = VesselId, Path), Page),
    responses((status = 200, body = AgentStreamList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_agents(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    page: Page,
) -> Result<Json<AgentStreamList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let week_ago = app.clock.now().plus_seconds(-WEEK_S);
    let after = page.after_id()?;
    let found = store::list_streams(&app.db, id, after, week_ago.into(), page.fetch()).await?;
    let listed = page.cut(found, |row| row.stream.to_string());
    let items: Result<Vec<AgentStream>> = listed
        .items
        .into_iter()
        .map(store::StreamRow::read)
        .collect();
    Ok(Json(AgentStreamList {
        items: items?,
        next: listed.next,
    }))
}

/// Make an enrolment code
#[utoipa::path(post, path = "/vessels/{id}/agents", tag = "fleet",
    params(("id" = VesselId, Path), Key), request_body = NewCode,
    responses((status = 201, body = EnrolmentCode), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Made before", body = Problem),
              (status = 422, body = Problem)))]
async fn create_code(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<VesselId>,
    key: Key,
    Valid(new): Valid<NewCode>,
) -> Result<(StatusCode, Json<EnrolmentCode>)> {
    vessels::must_be_in_fleet(&app.db, writer.operator, id).await?;
    let request_hash = idempotency::request_hash(&format!("code of {id}"), &new)?;
    let compass = compasses::find(&app.db, id, new.compass_id).await?;
    let valid_for_s = new.valid_for_s.unwrap_or(DEFAULT_VALID_FOR_S);
    if !(1..=LONGEST_VALID_FOR_S).contains(&valid_for_s) {
        return Err(Error::Invalid {
            field: "valid_for_s",
            detail: format!("{valid_for_s} is outside 1 to {LONGEST_VALID_FOR_S}"),
        });
    }
    let now = app.clock.now();
    let expires_at = Time(now.plus_seconds(f64::from(valid_for_s)));
    let code = secret::new_code();
    let mut tx = request.begin().await?;
    key.shown_once(&mut tx, writer.operator, &request_hash, now.into())
        .await?;
    store::insert_code(&mut tx, &code, &compass, now.into(), expires_at).await?;
    tx.commit().await?;
    Ok((
        StatusCode::CREATED,
        Json(EnrolmentCode { code, expires_at }),
    ))
}

/// Revoke an agent's token
///
/// Its batches are kept. It continues to sample, and sends again once it is enrolled again.
/// Revoking it again changes nothing.
#[utoipa::path(delete, path = "/vessels/{id}/agents/{agent}", tag = "fleet",
    params(("id" = VesselId, Path), ("agent" = AgentId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn revoke_agent(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((vessel, agent)): Id<(VesselId, AgentId)>,
) -> Result<StatusCode> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    if let Some(event) = store::revoke(&request, vessel, agent, app.clock.now().into()).await? {
        app.publish(event);
    }
    Ok(StatusCode::NO_CONTENT)
}

/// Exchange a one-time code for a token and a stream
#[utoipa::path(post, path = "/agents/enrol", tag = "agents", security(()),
    request_body = EnrolRequest,
    responses((status = 200, body = EnrolResponse), (status = 404, body = Problem),
              (status = 410, body = Problem)))]
async fn enrol(
    State(app): State<App>,
    request: RequestContext,
    Valid(sent): Valid<EnrolRequest>,
) -> Result<Json<EnrolResponse>> {
    let version = text("agent_version", &sent.agent_version)?;
    let now = app.clock.now();
    let enrolled = store::enrol(&request, &sent.code, &version, now.into()).await?;
    Ok(Json(EnrolResponse {
        token: enrolled.token,
        stream: enrolled.stream,
        vessel_name: enrolled.vessel_name,
        compass_name: enrolled.compass_name,
        server_time: now,
    }))
}

/// Propose a new token for the agent
///
/// It is not stored, and not valid until the agent puts it in place.
#[utoipa::path(post, path = "/agents/token", tag = "agents", security(("token" = [])),
    responses((status = 200, body = NewToken), (status = 401, body = Problem)))]
async fn propose_token(agent: Agent) -> Json<NewToken> {
    Json(NewToken {
        token: secret::new_vessel_token(agent.vessel_id.0),
    })
}

/// Replace the token of this request
#[utoipa::path(put, path = "/agents/token", tag = "agents", security(("token" = [])),
    request_body = NewToken,
    responses((status = 204), (status = 401, body = Problem), (status = 422, body = Problem)))]
async fn replace_token(
    request: RequestContext,
    agent: Agent,
    Valid(new): Valid<NewToken>,
) -> Result<StatusCode> {
    if !secret::is_vessel_token(&new.token, agent.vessel_id.0) {
        return Err(Error::Invalid {
            field: "token",
            detail: "was not made for this agent".to_owned(),
        });
    }
    store::replace_token(&request, agent, &new.token).await?;
    Ok(StatusCode::NO_CONTENT)
}
