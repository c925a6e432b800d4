//! The real agents: installs, watches and stops them.

use super::agent_config::{Ports, agent_toml};
use super::server_api::ServerApi;
use super::simulated_ship::SimulatedShip;
use crate::cli::BadInput;
use anyhow::{Context, Result, bail, ensure};
use rustix::process::{Pid, Signal, kill_process};
use std::fs::OpenOptions;
use std::io::Write;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;
use tokio::process::{Child, Command};
use tokio::sync::watch;
use tokio::task::JoinSet;

/// The most restarts of an agent that ended by itself, as by a service manager.
const RESTARTS: u32 = 20;
const RESTART_AFTER: Duration = Duration::from_secs(1);
/// Time for an agent to finish and close its spool.
const STOP_TIMEOUT: Duration = Duration::from_secs(10);

/// A vessel on the server, and its agent's installation.
pub(super) struct Vessel {
    pub(super) name: String,
    pub(super) id: String,
    /// Address of the agent's local page.
    pub(super) page: SocketAddr,
    program: PathBuf,
    folder: PathBuf,
}

/// The running agents.
#[derive(Default)]
pub(super) struct Agents {
    watchers: JoinSet<Result<()>>,
    stop: watch::Sender<bool>,
}

/// Creates the vessel on the server, writes the agent's configuration and
/// enrols it.
pub(super) async fn install(
    api: &ServerApi,
    ship: &SimulatedShip,
    program: &Path,
    folder: &Path,
) -> Result<Vessel> {
    if folder.join("state").exists() {
        let problem = "contains an agent of an earlier run; choose another --work-dir";
        return Err(BadInput(format!("{}: {problem}", folder.display())).into());
    }
    std::fs::create_dir_all(folder)
        .map_err(|error| BadInput(format!("{}: {error}", folder.display())))?;
    let ports = Ports::choose(ship.address()?)?;
    std::fs::write(folder.join("agent.toml"), agent_toml(ship.plan(), ports))?;
    let id = api.create_vessel(ship.plan()).await?;
    let code = api.create_enrolment_code(&id).await?;
    let enrolment = Command::new(program)
        .args([
            "enrol",
            "--server",
            api.server(),
            "--code",
            &code,
            "--config",
        ])
        .arg(folder.join("agent.toml"))
        .stdin(Stdio::null())
        .kill_on_drop(true)
        .output()
        .await
        .map_err(|error| BadInput(format!("--agent: {}: {error}", program.display())))?;
    ensure!(
        enrolment.status.success(),
        "enrolling {}: {}",
        ship.name(),
        String::from_utf8_lossy(&enrolment.stderr).trim()
    );
    Ok(Vessel {
        name: ship.name().to_owned(),
        id,
        page: ports.page,
        program: program.to_owned(),
        folder: folder.to_owned(),
    })
}

impl Agents {
    pub(super) fn start(&mut self, vessel: &Vessel) -> Result<()> {
        let log = vessel.folder.join("agent.log");
        let mut command = Command::new(&vessel.program);
        command
            .args(["run", "--config"])
            .arg(vessel.folder.join("agent.toml"))
            .stdin(Stdio::null())
            .kill_on_drop(true);
        let first = spawn(&mut command, &log)?;
        let name = vessel.name.clone();
        self.watchers
            .spawn(watch(name, command, log, first, self.stop.subscribe()));
        Ok(())
    }

    /// Returns when an agent cannot be kept running.
    pub(super) async fn failed(&mut self) -> anyhow::Error {
        loop {
            match self.watchers.join_next().await {
                Some(Ok(Err(error))) => return error,
                Some(_) => {}
                None => std::future::pending().await,
            }
        }
    }

    /// Asks all agents to end, and waits for them.
    pub(super) async fn stop(&mut self) {
        self.stop.send_replace(true);
        while self.watchers.join_next().await.is_some() {}
    }
}

async fn watch(
    name: String,
    mut command: Command,
    log: PathBuf,
    mut child: Child,
    mut stop: watch::Receiver<bool>,
) -> Result<()> {
    for _ in 0..RESTARTS {
        let status = tokio::select! {
            status = child.wait() => status?,
            () = wait_for_stop(&mut stop) => return end(child).await,
        };
        writeln!(
            std::io::stderr(),
            "{name}: the agent has ended ({status}); starting it again"
        )?;
        tokio::select! {
            () = tokio::time::sleep(RESTART_AFTER) => {}
            () = wait_for_stop(&mut stop) => return Ok(()),
        }
        child = spawn(&mut command, &log)?;
    }
    end(child).await?;
    bail!(
        "{name}: the agent does not keep running; see {}",
        log.display()
    )
}

/// Returns when all agents are to end, or when the sender is gone.
async fn wait_for_stop(stop: &mut watch::Receiver<bool>) {
    stop.wait_for(|stop| *stop).await.ok();
}

fn spawn(command: &mut Command, log: &Path) -> Result<Child> {
    let log = OpenOptions::new()
        .create(true)
        .append(true)
        .open(log)
        .with_context(|| log.display().to_string())?;
    command.stdout(log.try_clone()?).stderr(log);
    command.spawn().context("cannot start the agent")
}

/// Ends an agent with SIGTERM, and kills it only after a timeout.
async fn end(mut child: Child) -> Result<()> {
    let id = child.id().and_then(|id| Pid::from_raw(id.cast_signed()));
    if let Some(id) = id {
        // It may have ended in the meantime.
        kill_process(id, Signal::TERM).ok();
    }
    if tokio::time::timeout(STOP_TIMEOUT, child.wait())
        .await
        .is_err()
    {
        child.kill().await?;
    }
    Ok(())
}
