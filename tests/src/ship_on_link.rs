//! A ship at the far end of a satellite link, with its server.

use crate::feed::Pace;
use crate::link::satellite::{Certificates, Conditions, INSTRUMENTS, SERVER, Satellite};
use crate::records::{Spool, ensure_records_match};
use crate::sailing::{TIMEOUT, day, sail_until, wait_until_uploaded};
use crate::{ServerProcess, Ship, Voyage, eventually};
use anyhow::Result;
use binnacle_compass::time::Timestamp;
use std::net::IpAddr;
use std::path::Path;
use tempfile::TempDir;
use uuid::Uuid;

/// Long enough that acknowledgements are sent together with other packets, as
/// over a satellite. Doubling it only makes the tests slower.
const ROUND_TRIP_MS: f64 = 300.0;

/// A ship on a satellite link, with its server.
#[derive(Debug)]
pub struct ShipOnLink {
    /// The link, to be changed and read.
    pub satellite: Satellite,
    /// The server.
    pub server: ServerProcess,
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

impl ShipOnLink {
    /// Starts everything, with the voyage paused. `uplink` is added to the
    /// agent's settings.
    ///
    /// # Errors
    /// Fails when something does not start.
    pub async fn start(scenario: &str, uplink: &str) -> Result<ShipOnLink> {
        ShipOnLink::start_with(scenario, uplink, Certificates::make).await
    }

    /// Like [`ShipOnLink::start`], with certificates that `certify` makes.
    ///
    /// # Errors
    /// Fails when something does not start.
    pub async fn start_with(
        scenario: &str,
        uplink: &str,
        certify: impl FnOnce(&Path, IpAddr) -> Result<Certificates>,
    ) -> Result<ShipOnLink> {
        let folder = tempfile::tempdir()?;
        let mut satellite = Satellite::launch().await?;
        // Set before anything is sent: TCP would remember a better link for a
        // while.
        let round_trip_ms = Some(ROUND_TRIP_MS);
        let conditions = Conditions {
            round_trip_ms,
            ..Conditions::default()
        };
        satellite.set(conditions).await?;
        let tls = certify(folder.path(), SERVER)?;
        let server = ServerProcess::start_with_tls(folder.path(), SERVER, &tls).await?;
        let (vessel, code) = server.create_vessel("ship").await?;
        let pace = Pace::FastUntil(day(0.0));
        let voyage = Voyage::sail_at(INSTRUMENTS, scenario, 11, folder.path(), pace).await?;
        let uplink = format!("pinned_ca = \"{}\"\n{uplink}", tls.authority.display());
        let feed = voyage.feed.address();
        let ship = Ship::with_uplink("ship", folder.path(), feed, &uplink)?;
        let mut ship = ship.on_network(satellite.ship_network());
        ship.enrol(&server.url, &code).await?;
        ship.start()?;
        ship.ready().await?;
        Ok(ShipOnLink {
            satellite,
            server,
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
    /// Fails when the ship does not get there.
    pub async fn sail_until(&mut self, time: Timestamp) -> Result<()> {
        sail_until(&mut self.voyage, &self.ship, time).await
    }

    /// Waits until no batch waits in the spool.
    ///
    /// # Errors
    /// Fails when a batch keeps waiting.
    pub async fn wait_until_uploaded(&self) -> Result<Spool> {
        wait_until_uploaded(&self.ship).await
    }

    /// Waits until the server has analysed all its samples.
    ///
    /// # Errors
    /// Fails when it does not.
    pub async fn wait_until_analysed(&self) -> Result<()> {
        eventually("all is analysed", TIMEOUT, async || {
            let waiting = self.server.jobs().await?;
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
    /// Fails when they do not match, or a program failed.
    pub async fn check_and_stop(mut self) -> Result<()> {
        let spool = self.wait_until_uploaded().await?;
        ensure_records_match(&self.server, self.vessel, &spool).await?;
        self.ship.assert_running()?;
        self.ship.kill().await?;
        self.server.assert_healthy().await?;
        self.server.finish().await
    }
}
