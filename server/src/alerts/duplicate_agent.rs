//! Two computers that send as one agent.
//!
//! What always holds: an agent that has sent something in a new stream sends nothing new
//! in an older one. What comes there all the same is another computer's, with a copy of
//! the first one's files. It is raised in the transaction that stores the batch; it is
//! over when the agent's token is revoked, or when nothing has shown it for a week.

use super::alert::{Cause, DesiredAlert, EventWindow, Evidence, Severity};
use super::reconcile::{OVER, publish_changes, reconcile};
use super::store;
use crate::access::Agent;
use crate::app::App;
use crate::db::{Tx, row};
use crate::error::Result;
use crate::events::Event;
use crate::ids::{CompassId, VesselId};
use crate::time::Time;
use uuid::Uuid;

/// Both may send once in three days only.
const SHOWN_FOR_S: f64 = 7.0 * 86_400.0;

#[derive(sqlx::FromRow)]
struct Newer {
    id: Uuid,
    opened_at: Time,
}

/// Takes that a new batch came in a stream.
pub async fn check_duplicate_agent(
    tx: &mut Tx,
    agent: Agent,
    stream: Uuid,
    seq: u64,
    now: Time,
) -> Result<Option<Event>> {
    // Ids of streams are in the order of their opening.
    let newer = row!(
        in &mut *tx,
        Newer,
        "SELECT id, opened_at FROM streams
         WHERE vessel_id = $1 AND agent_id = $2 AND id > $3 AND batches > 0
         ORDER BY id LIMIT 1",
        agent.vessel_id,
        agent.agent_id,
        stream
    )?;
    let Some(newer) = newer else {
        return Ok(None);
    };
    let wanted = wanted(stream, seq, &newer);
    in_line(tx, agent.vessel_id, agent.compass_id, &[wanted], now).await
}

/// The agent is known no more, and so none of the two is.
pub async fn end_duplicate_agent(tx: &mut Tx, agent: Agent, now: Time) -> Result<Option<Event>> {
    in_line(tx, agent.vessel_id, agent.compass_id, &[], now).await
}

/// Looks which of these alerts nothing has shown for a week.
pub(super) async fn look(app: &App) -> Result<()> {
    let now: Time = app.clock.now().into();
    let before = Time(now.0.plus_seconds(-SHOWN_FOR_S));
    for (vessel, compass) in store::unshown(&app.db, Cause::ClonedAgent, before).await? {
        let mut tx = app.db.begin().await?;
        let event = in_line(&mut tx, vessel, compass, &[], now).await?;
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    Ok(())
}

async fn in_line(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    wanted: &[DesiredAlert],
    now: Time,
) -> Result<Option<Event>> {
    store::lock(tx, vessel, compass).await?;
    let mut known = store::known(tx, vessel, compass).await?;
    known.retain(|alert| alert.cause == Cause::ClonedAgent);
    let news = reconcile(tx, vessel, compass, &known, wanted, |_| OVER, now).await?;
    publish_changes(tx, vessel, &news, now).await
}

fn wanted(stream: Uuid, seq: u64, newer: &Newer) -> DesiredAlert {
    DesiredAlert {
        cause: Cause::ClonedAgent,
        severity: Severity::Warning,
        since: newer.opened_at,
        window: EventWindow::default(),
        summary: "Two computers send as this compass's agent: one has a copy of the other's \
                  files."
            .to_owned(),
        advice: "Find out which of them reads this ship's instruments, and stop the other. If \
                 that cannot be told from here, revoke the agent and enrol the right one anew: \
                 what it has is kept. Until then the samples of both are used.",
        evidence: Evidence(vec![
            format!("Stream {} was opened at {}.", newer.id, newer.opened_at.0),
            format!("Batch {seq} came in the older stream {stream} after that."),
        ]),
    }
}
