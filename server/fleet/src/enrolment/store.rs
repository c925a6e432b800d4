//! Codes, agents and their streams in the database.

use super::stream::{AgentStream, BoardStatus, LinkWeek};
use crate::agent_auth::Agent;
use crate::alerts;
use crate::compasses::Compass;
use binnacle_platform::audit::{Refusal, RequestContext};
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::error::{self, Error};
use binnacle_platform::events::Event;
use binnacle_platform::ids::{AgentId, CompassId, VesselId};
use binnacle_platform::secret;
use binnacle_platform::time::Time;
use binnacle_wire::batch::StreamId;
use uuid::Uuid;

pub(super) async fn insert_code(
    tx: &mut Tx,
    code: &str,
    compass: &Compass,
    now: Time,
    expires_at: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO enrolment_codes (code_hash, vessel_id, compass_id, created_at, expires_at)
         VALUES ($1, $2, $3, $4, $5)",
        secret::hash(&secret::normal_code(code)),
        compass.vessel_id,
        compass.id,
        now,
        expires_at
    )?;
    Ok(())
}

/// Result of an enrolment.
pub(super) struct Enrolled {
    pub(super) token: String,
    pub(super) stream: StreamId,
    pub(super) vessel_name: String,
    pub(super) compass_name: String,
}

#[derive(sqlx::FromRow)]
struct Code {
    vessel_id: VesselId,
    compass_id: CompassId,
    expires_at: Time,
    vessel_name: String,
    compass_name: String,
}

/// Uses up a code: a new agent with a first stream.
pub(super) async fn enrol(
    request: &RequestContext,
    code: &str,
    agent_version: &str,
    now: Time,
) -> error::Result<Enrolled> {
    let code_hash = secret::hash(&secret::normal_code(code));
    let mut tx = request.begin().await?;
    let found = row!(
        in &mut tx,
        Code,
        "SELECT e.vessel_id, e.compass_id, e.expires_at, v.name AS vessel_name,
                c.name AS compass_name
         FROM enrolment_codes e
         JOIN vessels v ON v.id = e.vessel_id
         JOIN compasses c ON c.vessel_id = e.vessel_id AND c.id = e.compass_id
         WHERE e.code_hash = $1
         ORDER BY e.code_hash",
        code_hash.as_slice()
    )?
    .ok_or_else(|| {
        request.refuse(Refusal::InvalidCode, None);
        Error::NotFound("enrolment code")
    })?;
    if found.expires_at <= now {
        request.refuse(Refusal::InvalidCode, None);
        return Err(Error::Gone(
            "this enrolment code has expired: ask the operator for a new one",
        ));
    }
    // Of two concurrent requests, the database accepts one.
    let used = execute!(
        &mut tx,
        "UPDATE enrolment_codes SET used_at = $2 WHERE code_hash = $1 AND used_at IS NULL",
        code_hash.as_slice(),
        now
    )?;
    if used == 0 {
        return Err(Error::Gone(
            "this enrolment code has been used before: ask the operator for a new one",
        ));
    }
    let token = secret::new_vessel_token(found.vessel_id.0);
    let agent = Agent {
        vessel_id: found.vessel_id,
        agent_id: AgentId::new(),
        compass_id: found.compass_id,
    };
    execute!(
        &mut tx,
        "INSERT INTO agents (vessel_id, id, compass_id, token_hash, agent_version, enrolled_at)
         VALUES ($1, $2, $3, $4, $5, $6)",
        agent.vessel_id,
        agent.agent_id,
        agent.compass_id,
        secret::hash(&token),
        agent_version,
        now
    )?;
    let stream = open_stream(&mut tx, agent, now).await?;
    request.record_actor(&agent);
    tx.commit().await?;
    Ok(Enrolled {
        token,
        stream,
        vessel_name: found.vessel_name,
        compass_name: found.compass_name,
    })
}

/// Opens a new, empty stream for an agent.
pub async fn open_stream(tx: &mut Tx, agent: Agent, now: Time) -> Result<StreamId> {
    let stream = StreamId(Uuid::now_v7());
    execute!(
        tx,
        "INSERT INTO streams (vessel_id, id, agent_id, compass_id, opened_at,
                              contiguous_seq, batches, samples, tally)
         VALUES ($1, $2, $3, $4, $5, 0, 0, 0, '{}')",
        agent.vessel_id,
        stream.0,
        agent.agent_id,
        agent.compass_id,
        now
    )?;
    Ok(stream)
}

/// Replaces the agent's token.
pub(super) async fn replace_token(
    request: &RequestContext,
    agent: Agent,
    token: &str,
) -> Result<()> {
    let mut tx = request.begin().await?;
    execute!(
        &mut tx,
        "UPDATE agents SET token_hash = $3 WHERE vessel_id = $1 AND id = $2",
        agent.vessel_id,
        agent.agent_id,
        secret::hash(token)
    )?;
    tx.commit().await
}

/// Revokes the agent's token. Returns an event to publish.
///
/// # Errors
/// [`Error::NotFound`] when the vessel has no such agent.
pub async fn revoke(
    request: &RequestContext,
    vessel: VesselId,
    agent: AgentId,
    now: Time,
) -> error::Result<Option<Event>> {
    let mut tx = request.begin().await?;
    let revoked = row!(
        in &mut tx,
        Agent,
        "UPDATE agents SET revoked_at = COALESCE(revoked_at, $3) WHERE vessel_id = $1 AND id = $2
         RETURNING vessel_id, id AS agent_id, compass_id",
        vessel,
        agent,
        now
    )?
    .ok_or(Error::NotFound("agent"))?;
    let event = alerts::end_duplicate_agent(&mut tx, revoked, now).await?;
    tx.commit().await?;
    Ok(event)
}

#[derive(sqlx::FromRow)]
pub(super) struct StreamRow {
    pub(super) stream: Uuid,
    agent_id: AgentId,
    revoked_at: Option<Time>,
    compass_id: CompassId,
    compass_name: String,
    agent_version: String,
    opened_at: Time,
    last_upload_at: Option<Time>,
    contiguous_seq: i64,
    batches: i64,
    samples: i64,
    tally: String,
    week_batches: i64,
    week_bytes: i64,
    week_wait: Option<i64>,
    batches_waiting: Option<i64>,
    budget_left_percent: Option<i64>,
    aboard_at: Option<Time>,
}

impl StreamRow {
    pub(super) fn read(self) -> error::Result<AgentStream> {
        let on_board = self.batches_waiting.zip(self.aboard_at);
        Ok(AgentStream {
            on_board: on_board.map(|(batches_waiting, at)| BoardStatus {
                batches_waiting,
                budget_left_percent: self.budget_left_percent,
                at,
            }),
            tally: serde_json::from_str(&self.tally)?,
            stream: self.stream,
            agent_id: self.agent_id,
            revoked_at: self.revoked_at,
            compass_id: self.compass_id,
            compass_name: self.compass_name,
            agent_version: self.agent_version,
            opened_at: self.opened_at,
            last_upload_at: self.last_upload_at,
            contiguous_seq: self.contiguous_seq,
            batches: self.batches,
            samples: self.samples,
            last_week: LinkWeek {
                batches: self.week_batches,
                bytes: self.week_bytes,
                longest_wait_s: self.week_wait.map(|micros| micros.max(0) / 1_000_000),
            },
        })
    }
}

pub(super) async fn list_streams(
    db: &Db,
    vessel: VesselId,
    after: Option<Uuid>,
    since: Time,
    limit: i64,
) -> Result<Vec<StreamRow>> {
    rows!(
        db,
        StreamRow,
        "SELECT s.id AS stream, s.agent_id, a.revoked_at, s.compass_id, c.name AS compass_name, a.agent_version,
                s.opened_at, s.last_upload_at, s.contiguous_seq, s.batches, s.samples, s.tally,
                COALESCE(w.batches, 0) AS week_batches, COALESCE(w.bytes, 0) AS week_bytes,
                w.wait AS week_wait, s.batches_waiting, s.budget_left_percent, s.aboard_at
         FROM streams s
         JOIN compasses c ON c.vessel_id = s.vessel_id AND c.id = s.compass_id
         JOIN agents a ON a.vessel_id = s.vessel_id AND a.id = s.agent_id
         LEFT JOIN (SELECT stream, COUNT(*) AS batches, SUM(LENGTH(bytes)) AS bytes,
                           MAX(received_at - last_sample_at) AS wait
                    FROM batches WHERE vessel_id = $1 AND received_at > $3
                    GROUP BY stream) w ON w.stream = s.id
         WHERE s.vessel_id = $1 AND s.id > $2
         ORDER BY s.id
         LIMIT $4",
        vessel,
        after.unwrap_or_default(),
        since,
        limit
    )
}
