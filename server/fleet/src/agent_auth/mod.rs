//! Authentication of an agent by its token: an extractor that a handler names in its arguments.

use axum::extract::{FromRef, FromRequestParts};
use axum::http::request::Parts;
use binnacle_platform::access::bearer;
use binnacle_platform::app::App;
use binnacle_platform::audit::{Actor, Refusal, RequestContext};
use binnacle_platform::db::{Db, Result as DbResult, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{AgentId, CompassId, VesselId};
use binnacle_platform::secret;

/// Version of the agent whose streams hold imported recordings. It is no program.
pub const IMPORT_VERSION: &str = "import";

/// A vessel's agent.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub struct Agent {
    /// The vessel.
    pub vessel_id: VesselId,
    /// The installation.
    pub agent_id: AgentId,
    /// The compass whose streams it may feed.
    pub compass_id: CompassId,
}

/// Token of an agent as a request shows it, not yet checked.
pub(crate) struct ShownToken {
    /// Vessel that the token names.
    pub(crate) vessel: VesselId,
    /// Hash under which a token is stored.
    pub(crate) hash: Vec<u8>,
}

impl ShownToken {
    /// Returns the token of a request.
    ///
    /// # Errors
    /// Fails when the request has none of an agent.
    pub(crate) fn of(parts: &Parts) -> Result<ShownToken> {
        let token = bearer(parts).ok_or(Error::Unauthenticated)?;
        let Some(vessel) = secret::vessel_of_token(token) else {
            return Err(ShownToken::refuse(parts)?);
        };
        Ok(ShownToken {
            vessel: VesselId(vessel),
            hash: secret::hash(token),
        })
    }

    /// Records that no agent has the token of a request, and returns the error.
    pub(crate) fn refuse(parts: &Parts) -> Result<Error> {
        RequestContext::of(parts)?.refuse(Refusal::InvalidToken, None);
        Ok(Error::Unauthenticated)
    }
}

impl<S> FromRequestParts<S> for Agent
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Agent> {
        let app = App::from_ref(state);
        let token = ShownToken::of(parts)?;
        let Some(agent) = find_agent(&app.db, token.vessel, &token.hash).await? else {
            return Err(ShownToken::refuse(parts)?);
        };
        RequestContext::of(parts)?.record_actor(&agent);
        Ok(agent)
    }
}

impl From<&Agent> for Actor {
    fn from(agent: &Agent) -> Actor {
        Actor::agent(agent.agent_id, agent.vessel_id)
    }
}

/// Finds the agent that holds a token.
async fn find_agent(db: &Db, vessel: VesselId, token_hash: &[u8]) -> DbResult<Option<Agent>> {
    row!(
        db,
        Agent,
        "SELECT vessel_id, id AS agent_id, compass_id FROM agents
         WHERE vessel_id = $1 AND token_hash = $2 AND revoked_at IS NULL
         ORDER BY id",
        vessel,
        token_hash
    )
}
