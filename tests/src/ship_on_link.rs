//! A ship at the far end of a satellite link, with its server.

use crate::feed::Pace;
use crate::link::satellite::{Certificates, INSTRUMENTS, SHORE, Satellite, Weather};
use crate::records::{Spool, ensure_same_at_both_ends};
use crate::sailing::{PATIENCE, all_ashore, day, until};
use crate::{Ship, Shore, Voyage, eventually};
use anyhow::Result;
use binnacle_magnetics::time::Timestamp;
use std::path::Path;
use tempfile::TempDir;
use uuid::Uuid;

/// Long enough that acknowledgements are sent together with other packets, as
/// over a satellite. Doubling it only makes the tests slower.
const ROUND_TRIP_MS: f64 = 300.0;

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
