//! The agent as a caller: an extractor that a handler names in its arguments.

use super::store;
use axum::extract::{FromRef, FromRequestParts};
use axum::http::request::Parts;
use binnacle_platform::access::bearer;
use binnacle_platform::app::App;
use binnacle_platform::audit::{Actor, RequestContext};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{AgentId, CompassId, VesselId};
use binnacle_platform::secret;

/// A ship's agent.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub struct Agent {
    /// The ship.
    pub vessel_id: VesselId,
    /// The installation.
    pub agent_id: AgentId,
    /// The compass whose streams it may feed.
    pub compass_id: CompassId,
}

impl<S> FromRequestParts<S> for Agent
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Agent> {
        let app = App::from_ref(state);
        let token = bearer(parts).ok_or(Error::Unauthenticated)?;
        let vessel = secret::vessel_of_token(token).ok_or(Error::Unauthenticated)?;
        let agent = store::find_agent(&app.db, VesselId(vessel), &secret::hash(token))
            .await?
            .ok_or(Error::Unauthenticated)?;
        RequestContext::of(parts)?.record_actor(&agent);
        Ok(agent)
    }
}

impl From<&Agent> for Actor {
    fn from(agent: &Agent) -> Actor {
        Actor::agent(agent.agent_id, agent.vessel_id)
    }
}
