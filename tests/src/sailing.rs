//! Sailing of a ship: the scenarios' time, and waiting for the agent.

use crate::feed::{Pace, Progress};
use crate::records::Spool;
use crate::{Ship, Voyage, eventually};
use anyhow::{Context, Result};
use binnacle_compass::time::Timestamp;
use serde_json::Value;
use std::time::Duration;

/// Start of this package's scenarios.
pub const START: &str = "2026-10-01T00:00:00Z";
/// Time that a busy machine may take for a few days' sailing.
pub const TIMEOUT: Duration = Duration::from_mins(8);

/// Returns the instant a number of days after the start.
///
/// # Panics
/// Never: the start is a date.
pub fn day(day: f64) -> Timestamp {
    let start = Timestamp::parse(START).expect("a date");
    start.plus_seconds(day * 86_400.0)
}

/// Sails to an instant; returns when the agent has read the sentences up to it.
///
/// # Errors
/// Fails when the ship does not get there.
pub async fn sail_until(voyage: &mut Voyage, ship: &Ship, time: Timestamp) -> Result<()> {
    voyage.feed.set_pace(Pace::FastUntil(time))?;
    let there = |progress: &Progress| *progress == Progress::Ended || progress.time() >= Some(time);
    let reached = voyage.feed.reached(TIMEOUT, there).await?;
    // The last sentences of a voyage may come before its end.
    let time = reached.time().unwrap_or(time.plus_seconds(-60.0));
    eventually("the agent has read all sentences", TIMEOUT, async || {
        let status = ship.status().await?;
        let heard = ship_time(&status)? >= Some(time);
        Ok(if heard {
            Ok(())
        } else {
            Err(status.to_string())
        })
    })
    .await
}

fn ship_time(status: &Value) -> Result<Option<Timestamp>> {
    let time = status["ship_time"].as_str().map(Timestamp::parse);
    time.transpose().context("ship_time")
}

/// Waits until no batch waits in the spool.
///
/// # Errors
/// Fails when a batch keeps waiting.
pub async fn wait_until_uploaded(ship: &Ship) -> Result<Spool> {
    eventually("all batches are acknowledged", TIMEOUT, async || {
        let spool = Spool::read(ship).await?;
        let sent = spool.waiting == 0;
        Ok(if sent {
            Ok(spool)
        } else {
            Err(format!("{spool:?}"))
        })
    })
    .await
}
