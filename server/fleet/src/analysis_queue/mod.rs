//! Queue of analysis jobs.
//!
//! Invariants:
//!
//! - One worker at a time runs a job: the one that holds its lease, and renews it while it works.
//! - A job whose lease expires goes back to the queue.
//! - A job that failed [`MOST_ATTEMPTS`] times waits for a person as `dead`, until a later
//!   analysis of the vessel succeeds.

use binnacle_compass::result::ESTIMATOR;
use binnacle_platform::app::App;
use binnacle_platform::db::{Connection, Db, Result, Tx, execute, rows};
use binnacle_platform::ids::{JobId, VesselId};
use binnacle_platform::time::Time;
use std::time::{Duration, Instant};

/// Number of attempts before a job is given up.
pub const MOST_ATTEMPTS: i64 = 5;
/// Time without a heartbeat after which another worker may take a job. Short, so that a vessel need
/// not wait long for the job of a process that was killed.
const LEASE_S: f64 = 60.0;
const FIRST_RETRY_S: f64 = 10.0;
/// Interval between checks of the queue while a response waits for an analysis.
const CHECK_EVERY: Duration = Duration::from_millis(100);

/// A job that was claimed.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub struct Job {
    /// The vessel to analyse.
    pub vessel_id: VesselId,
    /// The job's id.
    pub id: JobId,
    /// Number of this attempt. It distinguishes this lease from later ones.
    pub attempts: i64,
}

/// Makes sure that the vessel will be analysed, `delay_s` from now or sooner.
pub async fn enqueue(tx: &mut Tx, vessel: VesselId, now: Time, delay_s: f64) -> Result<()> {
    // Touching the job that waits already locks it: a worker cannot take it before
    // this transaction's batch is there for it to see.
    execute!(
        tx,
        "INSERT INTO jobs (vessel_id, id, kind, state, created_at, not_before, attempts)
         VALUES ($1, $2, 'analyse', 'queued', $3, $4, 0)
         ON CONFLICT (vessel_id, kind) WHERE state = 'queued' DO UPDATE
         SET not_before = CASE WHEN excluded.not_before < jobs.not_before
                               THEN excluded.not_before ELSE jobs.not_before END",
        vessel,
        JobId::new(),
        now,
        Time(now.0.plus_seconds(delay_s))
    )?;
    Ok(())
}

/// Makes sure that every vessel last analysed by an estimator other than this program's will be
/// analysed again. Returns their number.
pub async fn enqueue_outdated(db: &Db, now: Time) -> Result<usize> {
    let mut tx = db.begin().await?;
    let outdated = rows!(
        in &mut tx,
        (VesselId,),
        "SELECT DISTINCT vessel_id FROM analyses WHERE estimator <> $1 ORDER BY vessel_id",
        ESTIMATOR
    )?;
    for (vessel,) in &outdated {
        enqueue(&mut tx, *vessel, now, 0.0).await?;
    }
    tx.commit().await?;
    Ok(outdated.len())
}

/// Tells whether a vessel's analysis is due or running.
async fn is_under_way(db: &Db, vessel: VesselId, now: Time) -> Result<bool> {
    let found = rows!(
        db,
        (i64,),
        "SELECT attempts FROM jobs
         WHERE vessel_id = $1 AND kind = 'analyse'
           AND (state = 'running' OR (state = 'queued' AND not_before <= $2))
         ORDER BY id",
        vessel,
        now
    )?;
    Ok(!found.is_empty())
}

/// Waits until a vessel's samples are analysed, or until the time is over.
///
/// # Errors
/// Fails when the database does.
pub async fn wait_until_done(app: &App, vessel: VesselId, at_most: Duration) -> Result<()> {
    let begun = Instant::now();
    app.work.notify_one();
    while begun.elapsed() < at_most
        && !app.stopping.is_cancelled()
        && is_under_way(&app.db, vessel, app.clock.now().into()).await?
    {
        // Another process may do the work.
        tokio::time::sleep(CHECK_EVERY).await;
    }
    Ok(())
}

macro_rules! claim_sql {
    ($lock:literal) => {
        concat!(
            "UPDATE jobs SET state = 'running', attempts = attempts + 1, lease_until = $2
             WHERE (vessel_id, id) = (
                 SELECT j.vessel_id, j.id FROM jobs j
                 WHERE ((j.state = 'queued' AND j.not_before <= $1)
                        OR (j.state = 'running' AND j.lease_until <= $1))
                   AND NOT EXISTS (
                       SELECT 1 FROM jobs r
                       WHERE r.vessel_id = j.vessel_id AND r.kind = j.kind AND r.id <> j.id
                         AND r.state = 'running' AND r.lease_until > $1)
                 ORDER BY j.not_before, j.id
                 LIMIT 1",
            $lock,
            ") RETURNING vessel_id, id, attempts"
        )
    };
}

/// Claims the job that has been due for longest.
pub async fn claim(db: &Db, now: Time) -> Result<Option<Job>> {
    // Asking first keeps an idle worker from taking SQLite's write lock.
    let due = rows!(
        db,
        (i64,),
        "SELECT attempts FROM jobs
         WHERE (state = 'queued' AND not_before <= $1) OR (state = 'running' AND lease_until <= $1)
         ORDER BY not_before
         LIMIT 1",
        now
    )?;
    if due.is_empty() {
        return Ok(None);
    }
    let lease_until = Time(now.0.plus_seconds(LEASE_S));
    let mut tx = db.begin().await?;
    let job = match tx.connection() {
        Connection::Sqlite(tx) => {
            sqlx::query_as(claim_sql!(""))
                .bind(now)
                .bind(lease_until)
                .fetch_optional(&mut **tx)
                .await?
        }
        // Workers of other processes take other jobs rather than wait for this one.
        Connection::Postgres(tx) => {
            sqlx::query_as(claim_sql!(" FOR UPDATE OF j SKIP LOCKED"))
                .bind(now)
                .bind(lease_until)
                .fetch_optional(&mut **tx)
                .await?
        }
    };
    tx.commit().await?;
    Ok(job)
}

/// Renews a job's lease, unless it was lost.
pub async fn renew(db: &Db, job: Job, now: Time) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE jobs SET lease_until = $4
         WHERE vessel_id = $1 AND id = $2 AND attempts = $3 AND state = 'running'",
        job.vessel_id,
        job.id,
        job.attempts,
        Time(now.0.plus_seconds(LEASE_S))
    )?;
    tx.commit().await
}

/// Removes a finished job, and dead ones before it. Returns `false` when the lease was lost
/// meanwhile.
pub async fn finish(tx: &mut Tx, job: Job) -> Result<bool> {
    let held = execute!(
        &mut *tx,
        "DELETE FROM jobs
         WHERE vessel_id = $1 AND id = $2 AND attempts = $3 AND state = 'running'",
        job.vessel_id,
        job.id,
        job.attempts
    )?;
    if held == 0 {
        return Ok(false);
    }
    execute!(
        &mut *tx,
        "DELETE FROM jobs WHERE vessel_id = $1 AND kind = 'analyse' AND state = 'dead'",
        job.vessel_id
    )?;
    Ok(true)
}

/// Puts a failed job back for later, or gives it up. Returns `true` when it was given up.
pub async fn fail(db: &Db, job: Job, error: &str, now: Time) -> Result<bool> {
    let mut tx = db.begin().await?;
    // A job queued meanwhile does the same work.
    execute!(
        &mut tx,
        "DELETE FROM jobs
         WHERE vessel_id = $1 AND id = $2 AND attempts = $3 AND state = 'running'
           AND EXISTS (SELECT 1 FROM jobs q
                       WHERE q.vessel_id = $1 AND q.kind = jobs.kind AND q.state = 'queued')",
        job.vessel_id,
        job.id,
        job.attempts
    )?;
    let dead = job.attempts >= MOST_ATTEMPTS;
    let retry_s = FIRST_RETRY_S * 2_f64.powi(job.attempts.min(10) as i32 - 1);
    execute!(
        &mut tx,
        "UPDATE jobs SET state = $4, not_before = $5, last_error = $6, lease_until = NULL
         WHERE vessel_id = $1 AND id = $2 AND attempts = $3 AND state = 'running'",
        job.vessel_id,
        job.id,
        job.attempts,
        if dead { "dead" } else { "queued" },
        Time(now.0.plus_seconds(retry_s)),
        error
    )?;
    tx.commit().await?;
    Ok(dead)
}

/// Counts the jobs in each state.
pub async fn count(db: &Db) -> Result<Vec<(&'static str, i64)>> {
    let counted = rows!(
        db,
        (String, i64),
        "SELECT state, COUNT(*) FROM jobs GROUP BY state ORDER BY state"
    )?;
    let of = |state: &str| {
        counted
            .iter()
            .find(|(found, _)| found == state)
            .map_or(0, |(_, jobs)| *jobs)
    };
    Ok(["queued", "running", "dead"]
        .map(|state| (state, of(state)))
        .to_vec())
}
