//! A ship and its server on one machine, with a gateway between them, and the
//! invariants that hold under any fault.

use crate::feed::Pace;
use crate::link::gateway::Gateway;
use crate::link::satellite::Certificates;
use crate::records::{Spool, ensure_acknowledged_is_stored, stored_samples};
use crate::sailing::{TIMEOUT, day, sail_until};
use crate::ship::FAST_UPLINK;
use crate::{Engine, ServerProcess, Ship, Voyage, eventually};
use anyhow::{Context, Result, ensure};
use std::net::{IpAddr, Ipv4Addr};
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;
use tokio::time::Instant;
use uuid::Uuid;

/// The most that days under faults may add to the memory of the first day.
const MAX_MEMORY_GROWTH_KB: u64 = 8_000;
/// The most memory of an agent built without optimisation.
const MAX_MEMORY_KB: u64 = 45_000;
/// Windows of the unfinished sample and of the commit under way.
const OPEN_WINDOWS: f64 = 120.0;
/// Fraction of windows that a sample leaves out as outliers; a quarter of a
/// day's batch has 2,000.
const OUTLIERS: f64 = 0.01;
const STATUS_TIMEOUT: Duration = Duration::from_mins(1);
/// Longer than the second at which the agent checks for something to seal.
const IDLE_TIME: Duration = Duration::from_millis(2_500);

/// Set-up of a ship.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Scenario of this package.
    pub scenario: &'static str,
    /// Further lines of `[uplink]`.
    pub uplink: &'static str,
    /// True for a server with TLS, by an authority that the ship has pinned.
    pub tls: bool,
    /// Name of the vessel.
    pub name: &'static str,
}

impl Default for Setup {
    fn default() -> Setup {
        Setup {
            scenario: "biscay.toml",
            uplink: FAST_UPLINK,
            tls: false,
            name: "ship",
        }
    }
}

/// A ship and its server.
#[derive(Debug)]
pub struct ShipAndServer {
    /// The server.
    pub server: ServerProcess,
    /// The gateway between them.
    pub gateway: Gateway,
    /// The ship's id on the server.
    pub vessel: Uuid,
    /// Its instruments.
    pub voyage: Voyage,
    /// Its agent.
    pub ship: Ship,
    /// The server's certificates, with TLS.
    pub tls: Option<Certificates>,
    /// Memory of the agent after the first days.
    memory_kb: Option<u64>,
    folder: TempDir,
}

impl ShipAndServer {
    /// Starts everything, with the voyage paused.
    ///
    /// # Errors
    /// Fails when something does not start.
    pub async fn start() -> Result<ShipAndServer> {
        ShipAndServer::start_with(Setup::default(), |_| Ok(())).await
    }

    /// Starts everything with a set-up; `prepare` gets the ship before any
    /// program runs.
    ///
    /// # Errors
    /// Fails when something does not start, or `prepare` fails.
    pub async fn start_with(
        setup: Setup,
        prepare: impl FnOnce(&Ship) -> Result<()>,
    ) -> Result<ShipAndServer> {
        const HERE: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
        let folder = tempfile::tempdir()?;
        let tls = setup
            .tls
            .then(|| Certificates::make(folder.path(), HERE))
            .transpose()?;
        let server = match &tls {
            Some(tls) => ServerProcess::start_with_tls(folder.path(), HERE, tls).await?,
            None => ServerProcess::start(Engine::Sqlite, folder.path()).await?,
        };
        let gateway = Gateway::open(&server.url).await?;
        let (vessel, code) = server.create_vessel(setup.name).await?;
        let pace = Pace::FastUntil(day(0.0));
        let voyage = Voyage::sail(setup.scenario, 11, folder.path(), pace).await?;
        let pinned = tls
            .as_ref()
            .map(|tls| format!("pinned_ca = \"{}\"\n", tls.authority.display()));
        let uplink = format!("{}{}", pinned.unwrap_or_default(), setup.uplink);
        let feed = voyage.feed.address();
        let mut ship = Ship::with_uplink("ship", folder.path(), feed, &uplink)?;
        prepare(&ship)?;
        ship.enrol(&gateway.url(), &code).await?;
        ship.start()?;
        ship.ready().await?;
        Ok(ShipAndServer {
            server,
            gateway,
            vessel: vessel.parse()?,
            voyage,
            ship,
            tls,
            memory_kb: None,
            folder,
        })
    }

    /// The folder of all files.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Sails to a number of days after the start; returns when the agent has
    /// read the sentences up to then.
    ///
    /// # Errors
    /// Fails when the ship does not get there.
    pub async fn sail_until(&mut self, days: f64) -> Result<()> {
        sail_until(&mut self.voyage, &self.ship, day(days)).await?;
        if self.memory_kb.is_none() {
            self.memory_kb = Some(self.ship.peak_memory_kb()?);
        }
        Ok(())
    }

    /// Waits until no batch waits in the spool, and the spool is idle.
    ///
    /// # Errors
    /// Fails when a batch keeps waiting.
    pub async fn wait_until_uploaded(&self) -> Result<Spool> {
        wait_until_idle(&self.ship).await
    }

    /// Waits until a value of `status --json` contains a text, and returns it.
    ///
    /// # Errors
    /// Fails when it does not.
    pub async fn wait_for_status(&self, pointer: &str, wanted: &str) -> Result<String> {
        let what = format!("{pointer} says {wanted:?}");
        eventually(what, STATUS_TIMEOUT, async || {
            let status = self.ship.status().await?;
            let said = status.pointer(pointer).unwrap_or_default().to_string();
            Ok(if said.contains(wanted) {
                Ok(said)
            } else {
                Err(status.to_string())
            })
        })
        .await
    }

    /// Checks that acknowledged batches stay acknowledged, each once, and that
    /// unacknowledged samples are still on board.
    ///
    /// # Errors
    /// Fails when a check fails.
    pub async fn ensure_nothing_lost(&self, before: &Spool) -> Result<Spool> {
        let now = Spool::read(&self.ship).await?;
        ensure!(
            now.acknowledged == before.acknowledged && now.unsent_samples >= before.unsent_samples,
            "{now:?}, before {before:?}"
        );
        Ok(now)
    }

    /// Checks that all windows accepted since the agent started on an empty
    /// spool are in samples, on the server or on board.
    ///
    /// # Errors
    /// Fails when one is missing.
    pub async fn ensure_no_window_lost(&self) -> Result<()> {
        eventually("every window is there", STATUS_TIMEOUT, async || {
            let status = self.ship.status().await?;
            let accepted = &status["windows"]["accepted"];
            let accepted = accepted.as_u64().context("windows.accepted")?;
            let stored = stored_samples(&self.server, self.vessel).await?;
            let stored: u64 = stored.iter().map(|s| u64::from(s.windows)).sum();
            let there = stored + Spool::read(&self.ship).await?.unsent_windows;
            let least = accepted as f64 * (1.0 - OUTLIERS) - OPEN_WINDOWS;
            Ok(if there as f64 >= least && there <= accepted {
                Ok(())
            } else {
                Err(format!("{accepted} accepted, {there} there"))
            })
        })
        .await
    }

    /// Checks the final state and stops everything: nothing waits, acknowledged
    /// samples are stored, no window twice, and the agent's memory has hardly
    /// grown since its first day.
    ///
    /// # Errors
    /// Fails when a check fails, or a program failed.
    pub async fn check_and_stop(mut self) -> Result<()> {
        let spool = self.wait_until_uploaded().await?;
        ensure_acknowledged_is_stored(&self.server, self.vessel, &spool).await?;
        stored_samples(&self.server, self.vessel).await?;
        self.ship.assert_running()?;
        let most_kb = self.ship.peak_memory_kb()?;
        let grown_kb = most_kb.saturating_sub(self.memory_kb.unwrap_or(most_kb));
        println!("the agent took {most_kb} kB, {grown_kb} kB more than after a day");
        ensure!(
            grown_kb < MAX_MEMORY_GROWTH_KB && most_kb < MAX_MEMORY_KB,
            "{most_kb} kB, {grown_kb} kB more than after a day"
        );
        self.ship.kill().await?;
        self.server.assert_healthy().await?;
        self.server.finish().await
    }
}

/// Waits until no batch waits in a ship's spool, and the spool is idle.
///
/// # Errors
/// Fails when a batch keeps waiting.
pub async fn wait_until_idle(ship: &Ship) -> Result<Spool> {
    let mut last = (Spool::default(), Instant::now());
    eventually(
        "all batches are acknowledged and the spool is idle",
        TIMEOUT,
        async || {
            let spool = Spool::read(ship).await?;
            if spool.waiting > 0 || spool != last.0 {
                last = (spool.clone(), Instant::now());
            }
            Ok(if last.1.elapsed() >= IDLE_TIME {
                Ok(spool)
            } else {
                Err(format!("{spool:?}"))
            })
        },
    )
    .await
}

/// Copies the files of a folder, but no socket.
///
/// # Errors
/// Fails when one cannot be read or written.
pub fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        if !entry.file_type()?.is_file() {
            continue;
        }
        std::fs::copy(entry.path(), to.join(entry.file_name()))?;
    }
    Ok(())
}
