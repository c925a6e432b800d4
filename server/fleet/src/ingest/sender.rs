//! Agent that sends a batch, with the state of its stream and of what it may lack: one query a
//! batch.

use super::downlink::AgentState;
use crate::agent_auth::{Agent, ShownToken};
use axum::extract::{FromRef, FromRequestParts};
use axum::http::request::Parts;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Result as DbResult, Tx, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::Id;
use binnacle_wire::downlink::card_tag;
use binnacle_wire::messages::Settings;
use uuid::Uuid;

/// Authenticated sender of a batch.
#[derive(sqlx::FromRow)]
pub(super) struct Sender {
    #[sqlx(flatten)]
    pub(super) agent: Agent,
    /// The stream of the path; none if it is not the agent's.
    stream_id: Option<Uuid>,
    #[sqlx(flatten)]
    pub(super) stream: StreamState,
    /// The compass's last model.
    model_id: Option<Uuid>,
    card_is_withdrawn: bool,
    settings_version: Option<i64>,
}

/// State of a stream before a batch is stored.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct StreamState {
    pub(super) contiguous_seq: i64,
    pub(super) batches: i64,
    pub(super) tally: String,
    /// True if the agent has sent in a later stream.
    pub(super) has_later: bool,
}

impl<S> FromRequestParts<S> for Sender
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Sender> {
        let app = App::from_ref(state);
        let token = ShownToken::of(parts)?;
        let Id((stream, _)) = Id::<(Uuid, u64)>::from_request_parts(parts, state).await?;
        let Some(sender) = find(&app.db, &token, stream).await? else {
            return Err(ShownToken::refuse(parts)?);
        };
        RequestContext::of(parts)?.record_actor(&sender.agent);
        if sender.stream_id.is_none() {
            return Err(Error::NotFound("stream"));
        }
        Ok(sender)
    }
}

impl Sender {
    /// Returns true if there was nothing that the agent lacks.
    pub(super) fn lacks_nothing(&self, agent: &AgentState) -> bool {
        let model = self.model_id.filter(|_| !self.card_is_withdrawn);
        let has_model =
            model.is_none_or(|model| agent.uses(model) || agent.uses_card(&card_tag(model)));
        let has_settings = match self.settings_version {
            Some(version) => version == i64::from(agent.settings_version()),
            None => agent.settings_version() == Settings::default().version,
        };
        has_model && has_settings && !(self.card_is_withdrawn && agent.has_card())
    }
}

async fn find(db: &Db, token: &ShownToken, stream: Uuid) -> DbResult<Option<Sender>> {
    row!(
        db,
        Sender,
        "SELECT a.vessel_id, a.id AS agent_id, a.compass_id, s.id AS stream_id,
                COALESCE(s.contiguous_seq, 0) AS contiguous_seq, COALESCE(s.batches, 0) AS batches,
                COALESCE(s.tally, '{}') AS tally,
                EXISTS (SELECT 1 FROM streams n
                        WHERE n.vessel_id = a.vessel_id AND n.agent_id = a.id AND n.id > $3
                          AND n.batches > 0) AS has_later,
                (SELECT m.id FROM models m
                 WHERE m.vessel_id = a.vessel_id AND m.compass_id = a.compass_id
                 ORDER BY m.version DESC LIMIT 1) AS model_id,
                EXISTS (SELECT 1 FROM analyses w
                        WHERE w.vessel_id = a.vessel_id AND w.compass_id = a.compass_id
                          AND w.card_withdrawn_at IS NOT NULL) AS card_is_withdrawn,
                (SELECT v.version FROM vessel_settings v
                 WHERE v.vessel_id = a.vessel_id) AS settings_version
         FROM agents a
         LEFT JOIN streams s ON s.vessel_id = a.vessel_id AND s.agent_id = a.id AND s.id = $3
         WHERE a.vessel_id = $1 AND a.token_hash = $2 AND a.revoked_at IS NULL
         ORDER BY a.id",
        token.vessel,
        token.hash.as_slice(),
        stream
    )
}

impl StreamState {
    /// Reads the state of an agent's stream in a transaction.
    pub(super) async fn find(tx: &mut Tx, agent: Agent, stream: Uuid) -> Result<StreamState> {
        row!(
            in tx,
            StreamState,
            "SELECT s.contiguous_seq, s.batches, s.tally,
                    EXISTS (SELECT 1 FROM streams n
                            WHERE n.vessel_id = s.vessel_id AND n.agent_id = s.agent_id
                              AND n.id > s.id AND n.batches > 0) AS has_later
             FROM streams s
             WHERE s.vessel_id = $1 AND s.id = $2 AND s.agent_id = $3
             ORDER BY s.id",
            agent.vessel_id,
            stream,
            agent.agent_id
        )?
        .ok_or(Error::NotFound("stream"))
    }
}
