//! Schedules, and what asks for another one, in the database.

use super::plan::Plan;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{OperatorId, VesselId};
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Number of plans to keep.
const KEPT: i64 = 30;

/// Says that something has changed on which the schedule rests.
pub(super) async fn ask(tx: &mut Tx, operator: OperatorId, now: Time) -> DbResult<()> {
    execute!(
        tx,
        "INSERT INTO schedule_asks (operator_id, id, asked_at) VALUES ($1, $2, $3)",
        operator,
        Uuid::now_v7(),
        now
    )?;
    Ok(())
}

/// Returns the open requests for a schedule, the oldest first.
pub(super) async fn asks(db: &Db, operator: OperatorId) -> Result<Vec<(Uuid, Time)>> {
    Ok(rows!(
        db,
        (Uuid, Time),
        "SELECT id, asked_at FROM schedule_asks WHERE operator_id = $1 ORDER BY asked_at, id",
        operator
    )?)
}

/// Those who asked have their answer.
pub(super) async fn answered(
    tx: &mut Tx,
    operator: OperatorId,
    asks: &[(Uuid, Time)],
) -> DbResult<()> {
    for (id, _) in asks {
        execute!(
            &mut *tx,
            "DELETE FROM schedule_asks WHERE operator_id = $1 AND id = $2",
            operator,
            *id
        )?;
    }
    Ok(())
}

/// The current plan.
pub(super) async fn current(db: &Db, operator: OperatorId) -> Result<Option<Plan>> {
    let found = row!(
        db,
        (String,),
        "SELECT plan FROM schedules WHERE operator_id = $1 ORDER BY version DESC LIMIT 1",
        operator
    )?;
    read(found)
}

/// A plan of some version.
pub(super) async fn find(db: &Db, operator: OperatorId, version: i64) -> Result<Option<Plan>> {
    let found = row!(
        db,
        (String,),
        "SELECT plan FROM schedules WHERE operator_id = $1 AND version = $2 ORDER BY version",
        operator,
        version
    )?;
    read(found)
}

fn read(found: Option<(String,)>) -> Result<Option<Plan>> {
    let plan = found.map(|(text,)| serde_json::from_str(&text));
    Ok(plan.transpose()?)
}

/// Returns the input of the current plan.
pub(super) async fn input(db: &Db, operator: OperatorId) -> Result<Option<String>> {
    let found = row!(
        db,
        (String,),
        "SELECT input FROM schedules WHERE operator_id = $1 ORDER BY version DESC LIMIT 1",
        operator
    )?;
    Ok(found.map(|(input,)| input))
}

/// Keeps a plan as the next version; not when there is one of that version already.
pub(super) async fn keep(
    tx: &mut Tx,
    operator: OperatorId,
    plan: &Plan,
    input: &str,
) -> Result<bool> {
    let kept = execute!(
        &mut *tx,
        "INSERT INTO schedules (operator_id, version, solved_at, input_sha256, input, plan)
         VALUES ($1, $2, $3, $4, $5, $6)
         ON CONFLICT (operator_id, version) DO NOTHING",
        operator,
        plan.version,
        plan.solved_at,
        plan.input_sha256.as_str(),
        input,
        serde_json::to_string(plan)?
    )?;
    execute!(
        tx,
        "DELETE FROM schedules WHERE operator_id = $1 AND version <= $2",
        operator,
        plan.version - KEPT
    )?;
    Ok(kept > 0)
}

/// Returns the error of the last attempt, if it failed.
pub(super) async fn last_error(db: &Db, operator: OperatorId) -> Result<Option<String>> {
    let found = row!(
        db,
        (Option<String>,),
        "SELECT last_error FROM schedule_runs WHERE operator_id = $1 ORDER BY operator_id",
        operator
    )?;
    Ok(found.and_then(|(error,)| error))
}

/// The operator that has waited longest for a schedule asked for before a time.
pub(super) async fn longest_waiting(
    db: &Db,
    asked_before: Time,
    now: Time,
) -> Result<Option<OperatorId>> {
    let found = row!(
        db,
        (OperatorId,),
        "SELECT a.operator_id FROM schedule_asks a
         LEFT JOIN schedule_runs r ON r.operator_id = a.operator_id
         WHERE a.asked_at <= $1 AND (r.lease_until IS NULL OR r.lease_until <= $2)
         ORDER BY a.asked_at, a.id
         LIMIT 1",
        asked_before,
        now
    )?;
    Ok(found.map(|(operator,)| operator))
}

/// Operators whose plan was made before a time.
pub(super) async fn outdated(db: &Db, before: Time) -> Result<Vec<OperatorId>> {
    let found = rows!(
        db,
        (OperatorId,),
        "SELECT s.operator_id FROM schedules s
         WHERE NOT EXISTS (SELECT 1 FROM schedule_asks a WHERE a.operator_id = s.operator_id)
         GROUP BY s.operator_id
         HAVING MAX(s.solved_at) < $1
         ORDER BY s.operator_id",
        before
    )?;
    Ok(found.into_iter().map(|(operator,)| operator).collect())
}

/// Takes an operator's schedule for oneself; the count of tries, or none where another
/// has it.
pub(super) async fn claim(
    db: &Db,
    operator: OperatorId,
    now: Time,
    lease_until: Time,
) -> Result<Option<i64>> {
    let mut tx = db.begin().await?;
    let claimed = row!(
        in &mut tx,
        (i64,),
        "INSERT INTO schedule_runs (operator_id, lease_until, attempts) VALUES ($1, $3, 1)
         ON CONFLICT (operator_id) DO UPDATE
         SET lease_until = excluded.lease_until, attempts = schedule_runs.attempts + 1
         WHERE schedule_runs.lease_until <= $2
         RETURNING attempts",
        operator,
        now,
        lease_until
    )?;
    tx.commit().await?;
    Ok(claimed.map(|(attempts,)| attempts))
}

/// Leaves it: nothing went wrong, or what did, and until when to leave it alone.
pub(super) async fn leave(
    db: &Db,
    operator: OperatorId,
    failed: Option<(&str, Time)>,
) -> Result<()> {
    let mut tx = db.begin().await?;
    match failed {
        None => execute!(
            &mut tx,
            "UPDATE schedule_runs SET lease_until = 0, attempts = 0, last_error = NULL
             WHERE operator_id = $1",
            operator
        )?,
        Some((error, until)) => execute!(
            &mut tx,
            "UPDATE schedule_runs SET lease_until = $2, last_error = $3 WHERE operator_id = $1",
            operator,
            until,
            error
        )?,
    };
    tx.commit().await?;
    Ok(())
}

/// Leaves it alone until a time, for somebody else is at it.
pub(super) async fn put_off(db: &Db, operator: OperatorId, until: Time) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE schedule_runs SET lease_until = $2, attempts = 0 WHERE operator_id = $1",
        operator,
        until
    )?;
    tx.commit().await?;
    Ok(())
}

/// An operator's versions, the newest first: version, when, and the plan.
pub(super) async fn versions(
    db: &Db,
    operator: OperatorId,
    before: Option<i64>,
    limit: i64,
) -> Result<Vec<Plan>> {
    let found = rows!(
        db,
        (String,),
        "SELECT plan FROM schedules WHERE operator_id = $1 AND version < $2
         ORDER BY version DESC
         LIMIT $3",
        operator,
        before.unwrap_or(i64::MAX),
        limit
    )?;
    let read = |(text,): (String,)| Ok(serde_json::from_str(&text)?);
    found.into_iter().map(read).collect()
}

/// Vessels of an operator's among some.
pub(super) fn told(plan: &Plan) -> Vec<VesselId> {
    use binnacle_schedule::plan::ChangeKind;
    let changes = plan.changes.iter();
    let mut told: Vec<VesselId> = changes
        .filter(|change| change.what != ChangeKind::Kept)
        .map(|change| change.vessel_id)
        .collect();
    told.sort_unstable();
    told.dedup();
    told
}
