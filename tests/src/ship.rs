//! A ship: an agent process with its own folder, fed over TCP.

use crate::eventually::eventually;
use crate::link::satellite::ShipNetwork;
use crate::process::program::{self, Program};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tokio::process::Command;
use tokio::time::timeout;

/// Settings of an agent that waits for nothing, on a link that costs nothing.
pub const FAST_UPLINK: &str = "poll_s = 2\nretry_min_s = 0.2\nretry_max_s = 1";
/// Start-up time on a busy machine.
const START: Duration = Duration::from_secs(30);

/// An agent, running or not.
#[derive(Debug)]
pub struct Ship {
    name: String,
    folder: PathBuf,
    agent: Option<Program>,
    network: Option<ShipNetwork>,
}

impl Ship {
    /// Writes `agent.toml` into a new folder. The agent reads its sentences at
    /// `feed`, and serves corrected headings at a port that [`Ship::ready`]
    /// returns.
    ///
    /// # Errors
    /// Fails when the folder cannot be written.
    pub fn new(name: &str, parent: &Path, feed: SocketAddr) -> Result<Ship> {
        Ship::with_uplink(name, parent, feed, FAST_UPLINK)
    }

    /// Creates a ship with other lines in `[uplink]`.
    ///
    /// # Errors
    /// Fails when the folder cannot be written.
    pub fn with_uplink(name: &str, parent: &Path, feed: SocketAddr, uplink: &str) -> Result<Ship> {
        let folder = parent.join(name);
        std::fs::create_dir_all(&folder)?;
        let config = format!(
            r#"data_dir = "state"
[inputs.bridge]
tcp = "{feed}"
[roles]
compass = [{{ input = "bridge", talker = "HC", sentence = "HDG" }}]
gyro = [{{ input = "bridge", talker = "HE", sentence = "THS" }}]
satellite = [{{ input = "bridge", talker = "GP", sentence = "THS" }}]
position = [{{ input = "bridge", talker = "GP", sentence = "RMC" }}]
rate_of_turn = [{{ input = "bridge", sentence = "ROT" }}]
roll = [{{ input = "bridge", sentence = "XDR" }}]
[output]
tcp_server = "127.0.0.1:0"
interval_s = 0.1
[page]
listen = "127.0.0.1:0"
[uplink]
{uplink}
[silence]
stale_s = 15
"#
        );
        std::fs::write(folder.join("agent.toml"), config)?;
        Ok(Ship {
            name: name.to_owned(),
            folder,
            agent: None,
            network: None,
        })
    }

    /// Puts the ship at the other end of a satellite link, before any program
    /// runs.
    #[must_use]
    pub fn on_network(mut self, network: ShipNetwork) -> Ship {
        self.network = Some(network);
        self
    }

    fn command(&self) -> Result<Command> {
        const AGENT: &str = "binnacle-agent";
        match self.network {
            Some(network) => network.command(AGENT),
            None => program::command(AGENT),
        }
    }

    /// The path of `agent.toml`.
    pub fn config(&self) -> PathBuf {
        self.folder.join("agent.toml")
    }

    /// The ship's folder, with the agent's data and its log.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The folder of the agent's spool.
    pub fn data_dir(&self) -> PathBuf {
        self.folder.join("state")
    }

    /// Exchanges a code for the agent's token and stream.
    ///
    /// # Errors
    /// Fails when the agent or the server refuses.
    pub async fn enrol(&self, server: &str, code: &str) -> Result<()> {
        let mut command = self.command()?;
        command
            .args(["enrol", "--server", server, "--code", code, "--config"])
            .arg(self.config());
        program::run_with_input(command, "").await?;
        Ok(())
    }

    /// Starts the agent.
    ///
    /// # Errors
    /// Fails when it cannot be started.
    pub fn start(&mut self) -> Result<()> {
        ensure!(
            self.agent.is_none(),
            "the agent of {} runs already",
            self.name
        );
        let mut command = self.command()?;
        command.args(["run", "--config"]).arg(self.config());
        let log = self.folder.join("agent.log");
        self.agent = Some(Program::start(&self.name, command, &log)?);
        Ok(())
    }

    /// Waits until the agent has opened everything, and returns the address of
    /// the corrected headings.
    ///
    /// # Errors
    /// Fails when it ends instead, or takes too long.
    pub async fn ready(&mut self) -> Result<SocketAddr> {
        let agent = self.agent.as_mut().context("the agent runs")?;
        eventually(format!("{} is ready", self.name), START, async || {
            ensure!(agent.is_running()?, "the agent has ended:\n{}", agent.log());
            let log = agent.log();
            Ok(address_in(&log, "output").ok_or(log))
        })
        .await
    }

    /// Returns the address of a ready agent's local page.
    ///
    /// # Errors
    /// Fails when it is not ready.
    pub fn page(&mut self) -> Result<SocketAddr> {
        let agent = self.agent.as_mut().context("the agent runs")?;
        address_in(&agent.log(), "page").context("the agent is not ready")
    }

    /// Returns the output of `status --json`.
    ///
    /// # Errors
    /// Fails when it fails.
    pub async fn status(&self) -> Result<Value> {
        let mut command = self.command()?;
        command
            .args(["status", "--json", "--config"])
            .arg(self.config());
        let answer = program::run_with_input(command, "").await?;
        serde_json::from_str(&answer).with_context(|| answer.clone())
    }

    /// Returns the agent's peak memory, in kilobytes.
    ///
    /// # Errors
    /// Fails when the system does not tell.
    pub fn peak_memory_kb(&mut self) -> Result<u64> {
        let agent = self.agent.as_mut().context("the agent runs")?;
        let id = agent.child().id().context("the agent has ended")?;
        let status = std::fs::read_to_string(format!("/proc/{id}/status"))?;
        let line = status.lines().find(|line| line.starts_with("VmHWM:"));
        let kb = line.and_then(|line| line.split_whitespace().nth(1));
        Ok(kb.context("VmHWM in /proc")?.parse()?)
    }

    /// Waits until the agent has failed by itself, and returns its log.
    ///
    /// # Errors
    /// Fails when it does not end, or ends without a failure.
    pub async fn fails(&mut self) -> Result<String> {
        let mut agent = self.agent.take().context("the agent runs")?;
        let ended = timeout(START, agent.child().wait()).await;
        let ended = ended.with_context(|| format!("{} does not end", self.name))??;
        ensure!(
            !ended.success(),
            "the agent of {} ended without a failure",
            self.name
        );
        Ok(agent.log())
    }

    /// Kills the agent with signal 9.
    ///
    /// # Errors
    /// Fails when it had ended by itself.
    pub async fn kill(&mut self) -> Result<()> {
        let agent = self.agent.take().context("the agent runs")?;
        ensure!(
            !agent.log().contains("panicked"),
            "the agent panicked:\n{}",
            agent.log()
        );
        agent.kill().await
    }

    /// Asks the agent to end, and waits until it has.
    ///
    /// # Errors
    /// Fails when it does not end, or fails.
    pub async fn stop(&mut self) -> Result<()> {
        let mut agent = self.agent.take().context("the agent runs")?;
        let id = agent.child().id().context("it has ended by itself")?;
        let id = rustix::process::Pid::from_raw(id.cast_signed()).context("a process")?;
        rustix::process::kill_process(id, rustix::process::Signal::TERM)?;
        let ended = timeout(START, agent.child().wait()).await;
        let ended = ended.with_context(|| format!("{} does not end", self.name))??;
        ensure!(ended.success(), "{ended}:\n{}", agent.log());
        agent.done();
        Ok(())
    }

    /// Kills the agent with signal 9 and starts it again.
    ///
    /// # Errors
    /// Fails when it had ended by itself, or does not start.
    pub async fn kill_and_restart(&mut self) -> Result<()> {
        self.kill().await?;
        self.start()
    }

    /// Fails unless the agent runs.
    ///
    /// # Errors
    /// Fails when it does not.
    pub fn assert_running(&mut self) -> Result<()> {
        let agent = self.agent.as_mut().context("the agent runs")?;
        ensure!(
            agent.is_running()?,
            "the agent of {} has ended:\n{}",
            self.name,
            agent.log()
        );
        Ok(())
    }
}

/// Returns an address in the log line of a ready agent.
fn address_in(log: &str, name: &str) -> Option<SocketAddr> {
    let line = log.lines().find(|line| line.contains(" ready "))?;
    let (_, rest) = line.split_once(&format!("{name}=\""))?;
    rest.split('"').next()?.parse().ok()
}
