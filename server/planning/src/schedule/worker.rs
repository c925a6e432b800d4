//! Worker that makes new schedules after changes.
//!
//! Invariants: one process at a time makes an operator's schedule, under a lease. A burst of
//! changes makes one schedule, half a minute after the first. No plan is older than a day.

use super::concurrency::PlanSlots;
use super::input::load_input;
use super::{solve, store};
use binnacle_platform::app::App;
use binnacle_platform::error::Error;
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use std::collections::BTreeSet;
use std::time::Duration;
use tracing::{error, warn};

/// Interval between checks for requests.
const POLL_INTERVAL: Duration = Duration::from_secs(5);
/// Delay after the first request, seconds: changes come in bursts.
const DEBOUNCE_S: f64 = 30.0;
/// Maximum age of a plan, seconds: the time that passes changes it too.
const MAX_AGE_S: f64 = 86_400.0;
/// Duration of the lease, seconds; no solution takes longer.
const LEASE_S: f64 = 600.0;
/// Delay of the first retry, seconds; it doubles with each attempt.
const FIRST_RETRY_S: f64 = 60.0;

/// Makes schedules until the server stops.
pub async fn run(app: App, slots: PlanSlots) {
    while !app.stopping.is_cancelled() {
        match step(&app, &slots).await {
            Ok(Some(_)) => continue,
            Ok(None) => {}
            Err(error) => error!(
                error = format!("{error:#}"),
                "cannot check for schedules to make"
            ),
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(POLL_INTERVAL) => {}
        }
    }
}

/// Makes one schedule, if one is due, and returns its operator.
///
/// # Errors
/// Fails when the database cannot be reached. A failed schedule is logged and retried.
pub async fn step(app: &App, slots: &PlanSlots) -> anyhow::Result<Option<OperatorId>> {
    let now: Time = app.clock.now().into();
    request_outdated(app, now).await?;
    let before = Time(now.0.plus_seconds(-DEBOUNCE_S));
    let Some(operator) = cause_of(store::find_longest_waiting(&app.db, before, now).await)? else {
        return Ok(None);
    };
    let until = Time(now.0.plus_seconds(LEASE_S));
    let Some(attempts) = cause_of(store::claim(&app.db, operator, now, until).await)? else {
        return Ok(None);
    };
    let outcome = cause_of(make(app, slots, operator).await);
    if let Ok(Outcome::Busy) = outcome {
        cause_of(store::postpone(&app.db, operator, Time(now.0.plus_seconds(DEBOUNCE_S))).await)?;
        return Ok(Some(operator));
    }
    let retry_s = FIRST_RETRY_S * 2_f64.powi(attempts.clamp(1, 6) as i32 - 1);
    let failure = outcome.err().map(|error| store::Failure {
        error: format!("{error:#}"),
        retry_at: Time(app.clock.now().plus_seconds(retry_s)),
    });
    if let Some(store::Failure { error, .. }) = &failure {
        warn!(%operator, error, "schedule failed, will try again");
    }
    cause_of(store::release(&app.db, operator, failure.as_ref()).await)?;
    Ok(Some(operator))
}

/// Outcome of a request for a schedule.
enum Outcome {
    /// It was made, or is not needed.
    Done,
    /// Another task is making it.
    Busy,
}

/// Makes a schedule; drops the request of an operator that has neither firms nor a plan.
async fn make(
    app: &App,
    slots: &PlanSlots,
    operator: OperatorId,
) -> binnacle_platform::error::Result<Outcome> {
    let loaded = load_input(app, operator, &BTreeSet::new()).await?;
    if !loaded.has_firms && loaded.former.is_none() {
        solve::finish_requests(app.db.begin().await?, operator, &loaded).await?;
        return Ok(Outcome::Done);
    }
    let plan = solve::solve_unless_busy(app, slots, operator).await?;
    Ok(plan.map_or(Outcome::Busy, |_| Outcome::Done))
}

async fn request_outdated(app: &App, now: Time) -> anyhow::Result<()> {
    let before = Time(now.0.plus_seconds(-MAX_AGE_S));
    for operator in cause_of(store::list_outdated(&app.db, before).await)? {
        let mut tx = app.db.begin().await?;
        // An old request is due at once.
        store::request_schedule(&mut tx, operator, before).await?;
        tx.commit().await?;
    }
    Ok(())
}

/// Returns the cause of an error, for the log.
fn cause_of<T>(result: binnacle_platform::error::Result<T>) -> anyhow::Result<T> {
    result.map_err(|error| match error {
        Error::Internal(error) => error,
        other => anyhow::anyhow!("{other}"),
    })
}
