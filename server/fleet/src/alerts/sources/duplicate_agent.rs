//! Source of alerts: batches of two computers that run as one agent.
//!
//! Invariant: an agent that has sent in a new stream sends nothing new in an older one. A batch
//! there is from another computer with a copy of the first one's files.

use crate::agent_auth::Agent;
use crate::alerts::causes::{Facts, Source, StreamConflict, evaluate};
use crate::alerts::reconcile::reconcile_source;
use crate::alerts::store;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Raises an alert if a new batch came in an older stream.
pub async fn check_duplicate_agent(
    tx: &mut Tx,
    agent: Agent,
    stream: Uuid,
    seq: u64,
    now: Time,
) -> Result<Option<Event>> {
    let Some((newer, newer_opened_at)) = store::newer_stream(tx, agent, stream).await? else {
        return Ok(None);
    };
    let desired = evaluate(Facts::Batch(&StreamConflict {
        stream,
        seq,
        newer,
        newer_opened_at,
    }));
    let (vessel, compass) = (agent.vessel_id, agent.compass_id);
    reconcile_source(tx, vessel, compass, Source::Batch, &desired, now).await
}

/// Ends the alert of an agent that was revoked.
pub async fn end_duplicate_agent(tx: &mut Tx, agent: Agent, now: Time) -> Result<Option<Event>> {
    let (vessel, compass) = (agent.vessel_id, agent.compass_id);
    reconcile_source(tx, vessel, compass, Source::Batch, &[], now).await
}
