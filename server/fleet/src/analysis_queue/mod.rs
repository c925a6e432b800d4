//! Queue of analysis jobs.
//!
//! Invariants:
//!
//! - One worker at a time runs a job: the one that holds its lease, and renews it while it works.
//! - A job whose lease expires goes back to the queue.
//! - A clock that is set back delays no job: a time that it has already shown is past.
//! - A job that failed [`MOST_ATTEMPTS`] times waits for a person as `dead`, until a later
//!   analysis of the vessel succeeds.

use binnacle_compass::result::ESTIMATOR;
use binnacle_platform::app::App;
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::{JobId, VesselId};
use binnacle_platform::time::Time;
use std::time::{Duration, Instant};

/// Number of attempts before a job is given up.
pub const MOST_ATTEMPTS: i64 = 5;
/// Time without a heartbeat after which another worker may take a job. Short, so that a vessel need
/// not wait long for the job of a process that was killed.
const LEASE_S: f64 = 60.0;
const FIRST_RETRY_S: f64 = 10.0;
/// First interval between checks of the queue while a response waits for an analysis. Each further
/// one is half as long again, up to the last: many responses may wait.
const FIRST_CHECK: Duration = Duration::from_millis(100);
const LAST_CHECK: Duration = Duration::from_secs(2);

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
        "INSERT INTO jobs (vessel_id, id, kind, state, created_at, queued_at, not_before, attempts)
         VALUES ($1, $2, 'analyse', 'queued', $3, $3, $4, 0)
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
           AND (state = 'running'
                OR (state = 'queued' AND (not_before <= $2 OR queued_at > $2)))
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
    let mut pause = FIRST_CHECK;
    app.work.notify_one();
    while begun.elapsed() < at_most
        && !app.stopping.is_cancelled()
        && is_under_way(&app.db, vessel, app.clock.now().into()).await?
    {
        // Another process may do the work.
        tokio::time::sleep(pause.min(at_most.saturating_sub(begun.elapsed()))).await;
        pause = (pause * 3 / 2).min(LAST_CHECK);
    }
    Ok(())
}

/// Candidates for a claim: due jobs, the one that has been due for longest first. Each part reads
/// the first entries of one index: jobs that are due; jobs queued at a time that the clock has not
/// reached, because it was set back since; leases that have expired; and leases so long that the
/// clock must have been set back since they were taken.
pub const CANDIDATES: &str = "
    SELECT c.vessel_id, c.id, c.attempts, c.lease_until FROM (
        SELECT * FROM (SELECT vessel_id, id, kind, attempts, lease_until, not_before FROM jobs
                       WHERE state = 'queued' AND not_before <= $1
                       ORDER BY not_before LIMIT 64) due
        UNION ALL
        SELECT * FROM (SELECT vessel_id, id, kind, attempts, lease_until, not_before FROM jobs
                       WHERE state = 'queued' AND queued_at > $1
                       ORDER BY queued_at DESC LIMIT 64) later
        UNION ALL
        SELECT * FROM (SELECT vessel_id, id, kind, attempts, lease_until, not_before FROM jobs
                       WHERE state = 'running' AND lease_until <= $1
                       ORDER BY lease_until LIMIT 64) expired
        UNION ALL
        SELECT * FROM (SELECT vessel_id, id, kind, attempts, lease_until, not_before FROM jobs
                       WHERE state = 'running' AND lease_until > $2
                       ORDER BY lease_until DESC LIMIT 64) endless
    ) c
    WHERE NOT EXISTS (
        SELECT 1 FROM jobs r
        WHERE r.vessel_id = c.vessel_id AND r.kind = c.kind AND r.id <> c.id
          AND r.state = 'running' AND r.lease_until BETWEEN $1 AND $2)
    ORDER BY c.not_before, c.id
    LIMIT 16";

/// Job that may be claimed, as it was read.
#[derive(sqlx::FromRow)]
struct Candidate {
    vessel_id: VesselId,
    id: JobId,
    attempts: i64,
    lease_until: Option<Time>,
}

/// Claims the job that has been due for longest.
///
/// A claim changes one row, and only if it still is as it was read: of several workers one gets
/// the job, and the others try the next.
pub async fn claim(db: &Db, now: Time) -> Result<Option<Job>> {
    let candidates = rows!(db, Candidate, CANDIDATES, now, latest_lease(now))?;
    for candidate in candidates {
        let mut tx = db.begin().await?;
        let job = claim_candidate(&mut tx, &candidate, now).await?;
        tx.commit().await?;
        if job.is_some() {
            return Ok(job);
        }
    }
    Ok(None)
}

async fn claim_candidate(tx: &mut Tx, candidate: &Candidate, now: Time) -> Result<Option<Job>> {
    row!(
        in tx,
        Job,
        "UPDATE jobs SET state = 'running', attempts = attempts + 1, lease_until = $5
         WHERE vessel_id = $1 AND id = $2 AND attempts = $3
           AND state = CASE WHEN $4 IS NULL THEN 'queued' ELSE 'running' END
           AND COALESCE(lease_until, 0) = COALESCE($4, 0)
           AND NOT EXISTS (
               SELECT 1 FROM jobs r
               WHERE r.vessel_id = jobs.vessel_id AND r.kind = jobs.kind AND r.id <> jobs.id
                 AND r.state = 'running' AND r.lease_until BETWEEN $6 AND $7)
         RETURNING vessel_id, id, attempts",
        candidate.vessel_id,
        candidate.id,
        candidate.attempts,
        candidate.lease_until,
        Time(now.0.plus_seconds(LEASE_S)),
        now,
        latest_lease(now)
    )
}

/// Returns the time beyond which no lease can end, unless the clock was set back. The clocks of
/// two servers may differ by as much as a lease.
fn latest_lease(now: Time) -> Time {
    Time(now.0.plus_seconds(2.0 * LEASE_S))
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
        "UPDATE jobs SET state = $4, queued_at = $7, not_before = $5, last_error = $6,
                         lease_until = NULL
         WHERE vessel_id = $1 AND id = $2 AND attempts = $3 AND state = 'running'",
        job.vessel_id,
        job.id,
        job.attempts,
        if dead { "dead" } else { "queued" },
        Time(now.0.plus_seconds(retry_s)),
        error,
        now
    )?;
    tx.commit().await?;
    Ok(dead)
}

/// Returns the seconds for which the oldest due job has waited; none when nothing is due.
pub async fn oldest_wait_s(db: &Db, now: Time) -> Result<Option<f64>> {
    let oldest = rows!(
        db,
        (Time,),
        "SELECT not_before FROM jobs WHERE state = 'queued' AND not_before <= $1
         ORDER BY not_before LIMIT 1",
        now
    )?;
    Ok(oldest.first().map(|(since,)| now.0.seconds_since(since.0)))
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
