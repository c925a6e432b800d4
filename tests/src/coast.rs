//! A ship and her shore on one machine, with a gateway between, and what must hold
//! whatever happened to them.

use crate::at_sea::{PATIENCE, day, until};
use crate::feed::Pace;
use crate::gateway::Gateway;
use crate::ledger::{Spool, ensure_acknowledged_is_ashore, samples_ashore};
use crate::satellite::Certificates;
use crate::{Engine, Ship, Shore, Voyage, eventually};
use anyhow::{Context, Result, ensure};
use std::net::{IpAddr, Ipv4Addr};
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;
use tokio::time::Instant;
use uuid::Uuid;

/// What days under faults may add to the memory that a first day took.
const MEMORY_GROWS_KB: u64 = 8_000;
/// An agent of some megabytes, built without optimisation.
const MEMORY_MOST_KB: u64 = 45_000;
/// Windows of the stretch that is not finished yet, and of the commit under way.
const OPEN_WINDOWS: f64 = 120.0;
/// Windows that a sample leaves out as outliers; a quarter of a day's batch is 2,000.
const OUTLIERS: f64 = 0.01;
const SETTLES: Duration = Duration::from_mins(1);
/// The agent looks once a second whether something is to be sealed.
const CALM: Duration = Duration::from_millis(2_500);

/// How a ship sails.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// The scenario of this package.
    pub scenario: &'static str,
    /// More lines of `[uplink]`.
    pub uplink: &'static str,
    /// Whether the shore speaks TLS, by an authority that the ship has pinned.
    pub tls: bool,
    /// What she is called.
    pub name: &'static str,
}

/// What waits for nothing, on a link that costs nothing.
pub const SWIFT: &str = "poll_s = 2\nretry_min_s = 0.2\nretry_max_s = 1";

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

/// A ship and her shore.
#[derive(Debug)]
pub struct Coast {
    /// The server.
    pub shore: Shore,
    /// What stands between.
    pub gateway: Gateway,
    /// The ship as the server knows her.
    pub vessel: Uuid,
    /// Her instruments.
    pub voyage: Voyage,
    /// Her agent.
    pub ship: Ship,
    /// The shore's, if it speaks TLS.
    pub tls: Option<Certificates>,
    /// What the agent took when it had something behind it.
    memory_kb: Option<u64>,
    folder: TempDir,
}

impl Coast {
    /// Starts everything; time stands still.
    ///
    /// # Errors
    /// When something does not start.
    pub async fn sail() -> Result<Coast> {
        Coast::sail_on(Passage::default(), |_| Ok(())).await
    }

    /// The same otherwise; `prepare` gets the ship before anything is run aboard.
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

    /// Where everybody's files are.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Sails on to so many days after the start; returns when the agent has heard of it.
    ///
    /// # Errors
    /// When she does not get there.
    pub async fn until(&mut self, days: f64) -> Result<()> {
        until(&mut self.voyage, &self.ship, day(days)).await?;
        if self.memory_kb.is_none() {
            self.memory_kb = Some(self.ship.peak_memory_kb()?);
        }
        Ok(())
    }

    /// Waits until nothing waits on board, and nothing more comes while the ship does.
    ///
    /// # Errors
    /// When something goes on waiting.
    pub async fn all_ashore(&self) -> Result<Spool> {
        calm(&self.ship).await
    }

    /// Waits until a line of `status --json` is as wanted; what it says.
    ///
    /// # Errors
    /// When it is not.
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

    /// What was acknowledged before still is, and nothing of it more than once; what is
    /// not acknowledged is on board.
    ///
    /// # Errors
    /// When it is not so.
    pub async fn ensure_nothing_went(&self, before: &Spool) -> Result<Spool> {
        let now = Spool::of(&self.ship).await?;
        ensure!(
            now.acknowledged == before.acknowledged && now.samples_aboard >= before.samples_aboard,
            "{now:?}, before {before:?}"
        );
        Ok(now)
    }

    /// The windows that the agent accepted since it was started on an empty spool are in
    /// samples, ashore or on board.
    ///
    /// # Errors
    /// When one is not.
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

    /// In the end nothing waits; what is acknowledged is ashore, no window twice, and the
    /// agent's memory is what it was after its first day.
    ///
    /// # Errors
    /// When it is not so, or a program failed.
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

/// Waits until nothing waits on board of a ship, and nothing more comes.
///
/// # Errors
/// When something goes on waiting.
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
