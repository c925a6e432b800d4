//! Schedules and the requests for new ones in the database.

use super::plan::Plan;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Number of plans to keep.
const KEPT_PLANS: i64 = 30;

/// Requests a new schedule.
pub(super) async fn request_schedule(tx: &mut Tx, operator: OperatorId, now: Time) -> DbResult<()> {
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
pub(super) async fn list_requests(db: &Db, operator: OperatorId) -> Result<Vec<(Uuid, Time)>> {
    Ok(rows!(
        db,
        (Uuid, Time),
        "SELECT id, asked_at FROM schedule_asks WHERE operator_id = $1 ORDER BY asked_at, id",
        operator
    )?)
}

/// Deletes requests that have been met.
pub(super) async fn delete_requests(
    tx: &mut Tx,
    operator: OperatorId,
    requests: &[(Uuid, Time)],
) -> DbResult<()> {
    for (id, _) in requests {
        execute!(
            &mut *tx,
            "DELETE FROM schedule_asks WHERE operator_id = $1 AND id = $2",
            operator,
            *id
        )?;
    }
    Ok(())
}

/// Returns the current plan.
pub(super) async fn find_current(db: &Db, operator: OperatorId) -> Result<Option<Plan>> {
    let found = row!(
        db,
        (String,),
        "SELECT plan FROM schedules WHERE operator_id = $1 ORDER BY version DESC LIMIT 1",
        operator
    )?;
    found.map(|(plan,)| parse(&plan)).transpose()
}

/// Returns the plan of a version.
pub(super) async fn find_version(
    db: &Db,
    operator: OperatorId,
    version: i64,
) -> Result<Option<Plan>> {
    let found = row!(
        db,
        (String,),
        "SELECT plan FROM schedules WHERE operator_id = $1 AND version = $2 ORDER BY version",
        operator,
        version
    )?;
    found.map(|(plan,)| parse(&plan)).transpose()
}

fn parse(plan: &str) -> Result<Plan> {
    Ok(serde_json::from_str(plan)?)
}

/// Returns the input of the current plan.
pub(super) async fn find_input(db: &Db, operator: OperatorId) -> Result<Option<String>> {
    let found = row!(
        db,
        (String,),
        "SELECT input FROM schedules WHERE operator_id = $1 ORDER BY version DESC LIMIT 1",
        operator
    )?;
    Ok(found.map(|(input,)| input))
}

/// Stores a plan; false when there is one of its version already.
pub(super) async fn insert(
    tx: &mut Tx,
    operator: OperatorId,
    plan: &Plan,
    input: &str,
) -> Result<bool> {
    let inserted = execute!(
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
        plan.version - KEPT_PLANS
    )?;
    Ok(inserted > 0)
}

/// Returns the error of the last attempt, if it failed.
pub(super) async fn find_last_error(db: &Db, operator: OperatorId) -> Result<Option<String>> {
    let found = row!(
        db,
        (Option<String>,),
        "SELECT last_error FROM schedule_runs WHERE operator_id = $1 ORDER BY operator_id",
        operator
    )?;
    Ok(found.and_then(|(error,)| error))
}

/// Returns the operator with the oldest request made before a time.
pub(super) async fn find_longest_waiting(
    db: &Db,
    requested_before: Time,
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
        requested_before,
        now
    )?;
    Ok(found.map(|(operator,)| operator))
}

/// Returns the operators without a request whose plan was made before a time.
pub(super) async fn list_outdated(db: &Db, before: Time) -> Result<Vec<OperatorId>> {
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

/// Claims an operator's schedule under a lease. Returns the number of attempts; `None` when another
/// process has it.
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

/// Failed attempt at a schedule.
pub(super) struct Failure {
    /// The error.
    pub(super) error: String,
    /// Time of the next attempt.
    pub(super) retry_at: Time,
}

/// Ends the lease on an operator's schedule after an attempt.
pub(super) async fn release(
    db: &Db,
    operator: OperatorId,
    failure: Option<&Failure>,
) -> Result<()> {
    let mut tx = db.begin().await?;
    match failure {
        None => execute!(
            &mut tx,
            "UPDATE schedule_runs SET lease_until = 0, attempts = 0, last_error = NULL
             WHERE operator_id = $1",
            operator
        )?,
        Some(failure) => execute!(
            &mut tx,
            "UPDATE schedule_runs SET lease_until = $2, last_error = $3 WHERE operator_id = $1",
            operator,
            failure.retry_at,
            failure.error.as_str()
        )?,
    };
    tx.commit().await?;
    Ok(())
}

/// Postpones an operator's schedule, which another task is making.
pub(super) async fn postpone(db: &Db, operator: OperatorId, until: Time) -> Result<()> {
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

/// Returns a page of an operator's plans, the newest first.
pub(super) async fn list(
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
    found.iter().map(|(plan,)| parse(plan)).collect()
}
