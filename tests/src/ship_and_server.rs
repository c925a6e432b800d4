//! A ship and its server on one machine, with a gateway between them, and the
//! invariants that hold under any fault.

use crate::feed::Pace;
use crate::link::gateway::Gateway;
use crate::link::satellite::Certificates;
use crate::records::{Spool, ensure_acknowledged_is_ashore, samples_ashore};
use crate::sailing::{PATIENCE, day, until};
use crate::ship::SWIFT;
use crate::{Engine, Ship, Shore, Voyage, eventually};
use anyhow::{Context, Result, ensure};
use std::net::{IpAddr, Ipv4Addr};
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;
use tokio::time::Instant;
use uuid::Uuid;

/// The most that days under faults may add to the memory of the first day.
const MEMORY_GROWS_KB: u64 = 8_000;
/// The most memory of an agent built without optimisation.
const MEMORY_MOST_KB: u64 = 45_000;
/// Windows of the unfinished sample and of the commit under way.
const OPEN_WINDOWS: f64 = 120.0;
/// Fraction of windows that a sample leaves out as outliers; a quarter of a
/// day's batch has 2,000.
const OUTLIERS: f64 = 0.01;
const SETTLES: Duration = Duration::from_mins(1);
/// Longer than the second at which the agent checks for something to seal.
const CALM: Duration = Duration::from_millis(2_500);

/// Set-up of a ship.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Scenario of this package.
    pub scenario: &'static str,
    /// Further lines of `[uplink]`.
    pub uplink: &'static str,
    /// True for a server with TLS, by an authority that the ship has pinned.
    pub tls: bool,
    /// Name of the vessel.
    pub name: &'static str,
}

impl Default for Passage {
    fn default() -> Passage {
        Passage {
            scenario: "biscay.toml",
            uplink: SWIFT,
            tls: false,
            name: "ship",
        }
    }
}

/// A ship and its server.
#[derive(Debug)]
pub struct Coast {
    /// The server.
    pub shore: Shore,
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

impl Coast {
    /// Starts everything, with the voyage paused.
    ///
    /// # Errors
    /// When something does not start.
    pub async fn sail() -> Result<Coast> {
        Coast::sail_on(Passage::default(), |_| Ok(())).await
    }

    /// Starts everything with a set-up; `prepare` gets the ship before any
    /// program runs.
    ///
    /// # Errors
    /// When something does not start, or `prepare` fails.
    pub async fn sail_on(
        passage: Passage,
        prepare: impl FnOnce(&Ship) -> Result<()>,
    ) -> Result<Coast> {
        const HERE: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
        let folder = tempfile::tempdir()?;
        let tls = passage
            .tls
            .then(|| Certificates::make(folder.path(), HERE))
            .transpose()?;
        let shore = match &tls {
            Some(tls) => Shore::start_with_tls(folder.path(), HERE, tls).await?,
            None => Shore::start(Engine::Sqlite, folder.path()).await?,
        };
        let gateway = Gateway::open(&shore.url).await?;
        let (vessel, code) = shore.create_vessel(passage.name).await?;
        let pace = Pace::FastUntil(day(0.0));
        let voyage = Voyage::sail(passage.scenario, 11, folder.path(), pace).await?;
        let pinned = tls
            .as_ref()
            .map(|tls| format!("pinned_ca = \"{}\"\n", tls.authority.display()));
        let uplink = format!("{}{}", pinned.unwrap_or_default(), passage.uplink);
        let feed = voyage.feed.address();
        let mut ship = Ship::with_uplink("ship", folder.path(), feed, &uplink)?;
        prepare(&ship)?;
        ship.enrol(&gateway.url(), &code).await?;
        ship.start()?;
        ship.ready().await?;
        Ok(Coast {
            shore,
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
    /// When the ship does not get there.
    pub async fn until(&mut self, days: f64) -> Result<()> {
        until(&mut self.voyage, &self.ship, day(days)).await?;
        if self.memory_kb.is_none() {
            self.memory_kb = Some(self.ship.peak_memory_kb()?);
        }
        Ok(())
    }

    /// Waits until no batch waits in the spool, and the spool is idle.
    ///
    /// # Errors
    /// When a batch keeps waiting.
    pub async fn all_ashore(&self) -> Result<Spool> {
        calm(&self.ship).await
    }

    /// Waits until a value of `status --json` contains a text, and returns it.
    ///
    /// # Errors
    /// When it does not.
    pub async fn says(&self, pointer: &str, wanted: &str) -> Result<String> {
        let what = format!("{pointer} says {wanted:?}");
        eventually(what, SETTLES, async || {
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
    /// When a check fails.
    pub async fn ensure_nothing_went(&self, before: &Spool) -> Result<Spool> {
        let now = Spool::of(&self.ship).await?;
        ensure!(
            now.acknowledged == before.acknowledged && now.samples_aboard >= before.samples_aboard,
            "{now:?}, before {before:?}"
        );
        Ok(now)
    }

    /// Checks that all windows accepted since the agent started on an empty
    /// spool are in samples, on the server or on board.
    ///
    /// # Errors
    /// When one is missing.
    pub async fn ensure_every_window_is_there(&self) -> Result<()> {
        eventually("every window is there", SETTLES, async || {
            let status = self.ship.status().await?;
            let accepted = &status["windows"]["accepted"];
            let accepted = accepted.as_u64().context("windows.accepted")?;
            let ashore = samples_ashore(&self.shore, self.vessel).await?;
            let ashore: u64 = ashore.iter().map(|s| u64::from(s.windows)).sum();
            let there = ashore + Spool::of(&self.ship).await?.windows_aboard;
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
    /// When a check fails, or a program failed.
    pub async fn arrive(mut self) -> Result<()> {
        let spool = self.all_ashore().await?;
        ensure_acknowledged_is_ashore(&self.shore, self.vessel, &spool).await?;
        samples_ashore(&self.shore, self.vessel).await?;
        self.ship.assert_running()?;
        let most_kb = self.ship.peak_memory_kb()?;
        let grown_kb = most_kb.saturating_sub(self.memory_kb.unwrap_or(most_kb));
        println!("the agent took {most_kb} kB, {grown_kb} kB more than after a day");
        ensure!(
            grown_kb < MEMORY_GROWS_KB && most_kb < MEMORY_MOST_KB,
            "{most_kb} kB, {grown_kb} kB more than after a day"
        );
        self.ship.kill().await?;
        self.shore.assert_well().await?;
        self.shore.finish().await
    }
}

/// Waits until no batch waits in a ship's spool, and the spool is idle.
///
/// # Errors
/// When a batch keeps waiting.
pub async fn calm(ship: &Ship) -> Result<Spool> {
    let mut last = (Spool::default(), Instant::now());
    eventually("all is ashore, and calm", PATIENCE, async || {
        let spool = Spool::of(ship).await?;
        if spool.waiting > 0 || spool != last.0 {
            last = (spool.clone(), Instant::now());
        }
        Ok(if last.1.elapsed() >= CALM {
            Ok(spool)
        } else {
            Err(format!("{spool:?}"))
        })
    })
    .await
}

/// Copies the files of a folder.
///
/// # Errors
/// When one cannot be read or written.
pub fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        std::fs::copy(entry.path(), to.join(entry.file_name()))?;
    }
    Ok(())
}
