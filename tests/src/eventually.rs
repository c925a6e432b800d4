//! Waits for another process.

use anyhow::{Result, bail};
use std::fmt::Display;
use std::time::Duration;
use tokio::time::{Instant, MissedTickBehavior, interval};

/// Polling interval.
const INTERVAL: Duration = Duration::from_millis(50);

/// Polls until there is a result.
///
/// # Errors
/// With `what` and the last reason, when there is no result `within` the time;
/// or as soon as polling itself fails.
pub async fn eventually<T>(
    what: impl Display,
    within: Duration,
    mut ask: impl AsyncFnMut() -> Result<Result<T, String>>,
) -> Result<T> {
    let deadline = Instant::now() + within;
    let mut ticks = interval(INTERVAL);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        let why_not = match ask().await? {
            Ok(answer) => return Ok(answer),
            Err(why_not) => why_not,
        };
        if Instant::now() >= deadline {
            bail!("{what}: not within {} s: {why_not}", within.as_secs());
        }
    }
}
