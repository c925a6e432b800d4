//! Streams of imported recordings in the database: one a compass, of an agent whose token nobody
//! has.

use binnacle_fleet::agent_auth::{Agent, IMPORT_VERSION};
use binnacle_fleet::enrolment::open_stream;
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::{AgentId, CompassId, VesselId};
use binnacle_platform::secret;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Finds the agent and the stream of a compass's imports, or opens them.
pub(super) async fn find_or_open(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    now: Time,
) -> Result<(Agent, Uuid)> {
    let found = row!(
        in &mut *tx,
        (AgentId, Uuid),
        "SELECT s.agent_id, s.id FROM streams s
         JOIN agents a ON a.vessel_id = s.vessel_id AND a.id = s.agent_id
         WHERE s.vessel_id = $1 AND s.compass_id = $2 AND a.agent_version = $3
         ORDER BY s.id LIMIT 1",
        vessel,
        compass,
        IMPORT_VERSION
    )?;
    let agent = Agent {
        vessel_id: vessel,
        agent_id: found.map_or_else(AgentId::new, |(agent, _)| agent),
        compass_id: compass,
    };
    if let Some((_, stream)) = found {
        return Ok((agent, stream));
    }
    execute!(
        &mut *tx,
        "INSERT INTO agents (vessel_id, id, compass_id, token_hash, agent_version, enrolled_at,
                             revoked_at)
         VALUES ($1, $2, $3, $4, $5, $6, $6)",
        vessel,
        agent.agent_id,
        compass,
        secret::hash(&secret::new_vessel_token(vessel.0)),
        IMPORT_VERSION,
        now
    )?;
    let stream = open_stream(&mut *tx, agent, now).await?;
    Ok((agent, stream.0))
}

/// Returns the number of the next batch of a stream.
pub(super) async fn next_seq(tx: &mut Tx, vessel: VesselId, stream: Uuid) -> Result<u64> {
    let last = row!(
        in &mut *tx,
        (i64,),
        "SELECT seq FROM batches WHERE vessel_id = $1 AND stream = $2 ORDER BY seq DESC LIMIT 1",
        vessel,
        stream
    )?;
    Ok(last.map_or(1, |(seq,)| seq.unsigned_abs() + 1))
}

/// Returns the batches of a compass with samples between two times.
pub(super) async fn batches_within(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    first: Time,
    last: Time,
) -> Result<Vec<(Vec<u8>,)>> {
    rows!(
        db,
        (Vec<u8>,),
        "SELECT b.bytes FROM batches b
         JOIN streams s ON s.vessel_id = b.vessel_id AND s.id = b.stream
         WHERE b.vessel_id = $1 AND s.compass_id = $2
           AND b.first_sample_at <= $4 AND b.last_sample_at >= $3
         ORDER BY b.stream, b.seq",
        vessel,
        compass,
        first,
        last
    )
}
