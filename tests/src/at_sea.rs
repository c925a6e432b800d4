//! A ship at the far end of a satellite link, with its server.

use crate::feed::{Pace, Progress};
use crate::ledger::{Spool, ensure_same_at_both_ends};
use crate::satellite::{Certificates, INSTRUMENTS, SHORE, Satellite, Weather};
use crate::{Ship, Shore, Voyage, eventually};
use anyhow::{Context, Result};
use binnacle_magnetics::time::Timestamp;
use serde_json::Value;
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;
use uuid::Uuid;

/// Start of this package's scenarios.
pub const START: &str = "2026-10-01T00:00:00Z";
/// Long enough that acknowledgements are sent together with other packets, as
/// over a satellite. Doubling it only makes the tests slower.
const ROUND_TRIP_MS: f64 = 300.0;
/// Time that a busy machine may take for a few days' sailing.
pub const PATIENCE: Duration = Duration::from_mins(8);

/// Returns the instant a number of days after the start.
///
/// # Panics
/// Never: the start is a date.
pub fn day(day: f64) -> Timestamp {
    let start = Timestamp::parse(START).expect("a date");
    start.plus_seconds(day * 86_400.0)
}

/// A ship on a satellite link, with its server.
#[derive(Debug)]
pub struct AtSea {
    /// The link, to be changed and read.
    pub satellite: Satellite,
    /// The server.
    pub shore: Shore,
    /// The server's certificates.
    pub tls: Certificates,
    /// The ship's id on the server.
    pub vessel: Uuid,
    /// Its instruments.
    pub voyage: Voyage,
    /// Its agent.
    pub ship: Ship,
    folder: TempDir,
}

impl AtSea {
    /// Starts everything, with the voyage paused. `uplink` is added to the
    /// agent's settings.
    ///
    /// # Errors
    /// When something does not start.
    pub async fn sail(scenario: &str, uplink: &str) -> Result<AtSea> {
        let folder = tempfile::tempdir()?;
        let mut satellite = Satellite::launch().await?;
        // Set before anything is sent: TCP would remember a better link for a
        // while.
        let round_trip_ms = Some(ROUND_TRIP_MS);
        let weather = Weather {
            round_trip_ms,
            ..Weather::default()
        };
        satellite.set(weather).await?;
        let tls = Certificates::make(folder.path(), SHORE)?;
        let shore = Shore::start_with_tls(folder.path(), SHORE, &tls).await?;
        let (vessel, code) = shore.create_vessel("ship").await?;
        let pace = Pace::FastUntil(day(0.0));
        let voyage = Voyage::sail_at(INSTRUMENTS, scenario, 11, folder.path(), pace).await?;
        let uplink = format!("pinned_ca = \"{}\"\n{uplink}", tls.authority.display());
        let feed = voyage.feed.address();
        let ship = Ship::with_uplink("ship", folder.path(), feed, &uplink)?;
        let mut ship = ship.at_sea(satellite.berth());
        ship.enrol(&shore.url, &code).await?;
        ship.start()?;
        ship.ready().await?;
        Ok(AtSea {
            satellite,
            shore,
            tls,
            vessel: vessel.parse()?,
            voyage,
            ship,
            folder,
        })
    }

    /// The folder of all files.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Sails to an instant; returns when the agent has read the sentences up to
    /// it.
    ///
    /// # Errors
    /// When the ship does not get there.
    pub async fn until(&mut self, time: Timestamp) -> Result<()> {
        until(&mut self.voyage, &self.ship, time).await
    }

    /// Waits until no batch waits in the spool.
    ///
    /// # Errors
    /// When a batch keeps waiting.
    pub async fn all_ashore(&self) -> Result<Spool> {
        all_ashore(&self.ship).await
    }

    /// Waits until the server has analysed all its samples.
    ///
    /// # Errors
    /// When it does not.
    pub async fn analysed(&self) -> Result<()> {
        eventually("all is analysed", PATIENCE, async || {
            let waiting = self.shore.jobs().await?;
            Ok(if waiting == 0 {
                Ok(())
            } else {
                Err(format!("{waiting} jobs"))
            })
        })
        .await
    }

    /// Checks that both ends' records match, to the checksum, and stops
    /// everything.
    ///
    /// # Errors
    /// When they do not match, or a program failed.
    pub async fn arrive(mut self) -> Result<()> {
        let spool = self.all_ashore().await?;
        ensure_same_at_both_ends(&self.shore, self.vessel, &spool).await?;
        self.ship.assert_running()?;
        self.ship.kill().await?;
        self.shore.assert_well().await?;
        self.shore.finish().await
    }
}

/// Sails to an instant; returns when the agent has read the sentences up to it.
///
/// # Errors
/// When the ship does not get there.
pub async fn until(voyage: &mut Voyage, ship: &Ship, time: Timestamp) -> Result<()> {
    voyage.feed.set_pace(Pace::FastUntil(time))?;
    let there = |progress: &Progress| *progress == Progress::Ended || progress.time() >= Some(time);
    let reached = voyage.feed.reached(PATIENCE, there).await?;
    // The last sentences of a voyage may come before its end.
    let time = reached.time().unwrap_or(time.plus_seconds(-60.0));
    eventually("the agent has heard it", PATIENCE, async || {
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
/// When a batch keeps waiting.
pub async fn all_ashore(ship: &Ship) -> Result<Spool> {
    eventually("all is ashore", PATIENCE, async || {
        let spool = Spool::of(ship).await?;
        let sent = spool.waiting == 0;
        Ok(if sent {
            Ok(spool)
        } else {
            Err(format!("{spool:?}"))
        })
    })
    .await
}
