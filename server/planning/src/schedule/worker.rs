//! Makes schedules anew when what they rest on has changed.
//!
//! What always holds: one process at a time makes an operator's schedule, under a lease; a
//! storm of changes makes one schedule, half a minute after the first of them; a plan is
//! never older than a day.

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

/// Interval between checks for changes.
const LOOK_EVERY: Duration = Duration::from_secs(5);
/// So long after the first change: ETAs come in files, and answers in bursts.
const WAIT_S: f64 = 30.0;
/// Days pass too: what was to come has gone by.
const OLDEST_S: f64 = 86_400.0;
/// Nothing takes longer.
const LEASE_S: f64 = 600.0;
const FIRST_RETRY_S: f64 = 60.0;

/// Works until the server stops.
pub async fn run(app: App, slots: PlanSlots) {
    while !app.stopping.is_cancelled() {
        match step(&app, &slots).await {
            Ok(Some(_)) => continue,
            Ok(None) => {}
            Err(error) => error!(
                error = format!("{error:#}"),
                "schedules cannot be looked for"
            ),
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(LOOK_EVERY) => {}
        }
    }
}

/// Makes one schedule, if one is due.
///
/// # Errors
/// When the database cannot be reached; a schedule that cannot be made is not an error
/// here.
pub async fn step(app: &App, slots: &PlanSlots) -> anyhow::Result<Option<OperatorId>> {
    let now: Time = app.clock.now().into();
    ask_for_outdated(app, now).await?;
    let before = Time(now.0.plus_seconds(-WAIT_S));
    let Some(operator) = in_words(store::longest_waiting(&app.db, before, now).await)? else {
        return Ok(None);
    };
    let until = Time(now.0.plus_seconds(LEASE_S));
    let Some(attempts) = in_words(store::claim(&app.db, operator, now, until).await)? else {
        return Ok(None);
    };
    let made = in_words(make(app, slots, operator).await);
    if let Ok(Made::Elsewhere) = made {
        in_words(store::put_off(&app.db, operator, Time(now.0.plus_seconds(WAIT_S))).await)?;
        return Ok(Some(operator));
    }
    let failed = made.err().map(|error| format!("{error:#}"));
    let retry_s = FIRST_RETRY_S * 2_f64.powi(attempts.clamp(1, 6) as i32 - 1);
    let again = Time(app.clock.now().plus_seconds(retry_s));
    if let Some(error) = &failed {
        warn!(%operator, error, "a schedule was not made and will be tried again");
    }
    let left = failed.as_deref().map(|error| (error, again));
    in_words(store::leave(&app.db, operator, left).await)?;
    Ok(Some(operator))
}

/// Outcome of a request for a schedule.
enum Made {
    /// It was made, or there is no use for it.
    Here,
    /// Somebody is at it, and answers what asked, or leaves it to the next look.
    Elsewhere,
}

/// Makes a schedule; drops the request of an operator that has neither firms nor a plan.
async fn make(
    app: &App,
    slots: &PlanSlots,
    operator: OperatorId,
) -> binnacle_platform::error::Result<Made> {
    let gathered = load_input(app, operator, &BTreeSet::new()).await?;
    if !gathered.has_firms && gathered.former.is_none() {
        solve::forget_asks(app.db.begin().await?, operator, &gathered).await?;
        return Ok(Made::Here);
    }
    let made = solve::solve_unless_busy(app, slots, operator).await?;
    Ok(made.map_or(Made::Elsewhere, |_| Made::Here))
}

async fn ask_for_outdated(app: &App, now: Time) -> anyhow::Result<()> {
    let before = Time(now.0.plus_seconds(-OLDEST_S));
    for operator in in_words(store::outdated(&app.db, before).await)? {
        let mut tx = app.db.begin().await?;
        // As of long enough ago to be due.
        store::ask(&mut tx, operator, before).await?;
        tx.commit().await?;
    }
    Ok(())
}

/// Returns the cause of an error, for the log.
fn in_words<T>(result: binnacle_platform::error::Result<T>) -> anyhow::Result<T> {
    result.map_err(|error| match error {
        Error::Internal(error) => error,
        other => anyhow::anyhow!("{other}"),
    })
}
