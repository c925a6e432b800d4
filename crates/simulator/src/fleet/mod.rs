//! `fleet`: many ships with real agents and a real server.
//!
//! The past is sailed as fast as the agents can read it. Then the server's
//! models are compared with the truth. If asked, the ships then sail on in real
//! time. However the run ends, every started agent is stopped.

mod agent;
mod agent_config;
mod comparison;
mod progress;
mod run;
mod server_api;
mod simulated_ship;

use crate::atomic_file::write_whole;
use crate::cli::{self, BadInput, FleetArgs};
use crate::clock;
use agent::Agents;
use anyhow::{Context, Result};
use binnacle_compass::time::Timestamp;
use comparison::Comparison;
use progress::Progress;
use run::Run;
use server_api::ServerApi;
use simulated_ship::SimulatedShip;
use std::io::{Read, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use tokio::signal::unix::{SignalKind, signal};
use tokio::task::JoinSet;

/// Exit code of a program ended by a signal, as shells have it.
const INTERRUPTED: u8 = 130;
/// The longest gap between the end of the past and now that ships catch up;
/// after a longer one they continue from where they are.
const CATCH_UP_S: f64 = 86_400.0;

pub(crate) async fn run(args: &FleetArgs) -> Result<ExitCode> {
    let scenario = cli::read_scenario(&args.scenario)?;
    let days = cli::check_days(args.days)?;
    let until = args.until.unwrap_or_else(|| whole_second(clock::now()));
    let run = Run {
        seed: args.seed.unwrap_or(scenario.seed),
        from: until.plus_seconds(-days * 86_400.0),
        until,
        scenario,
        args,
    };
    let fleet = run.launch()?;
    let mut agents = Agents::default();
    let mut holds = None;
    let ended = tokio::select! {
        ended = run.sail(fleet, &mut agents, &mut holds) => ended,
        stopped = wait_for_signal() => stopped,
    };
    agents.stop().await;
    ended?;
    Ok(match holds {
        Some(true) => ExitCode::SUCCESS,
        Some(false) => ExitCode::FAILURE,
        None if args.serve_only => ExitCode::SUCCESS,
        None => ExitCode::from(INTERRUPTED),
    })
}

impl Run<'_> {
    /// Starts every ship at its berth, listening for a client.
    fn launch(&self) -> Result<Vec<SimulatedShip>> {
        let ships = self.scenario.ships.iter();
        ships
            .map(|plan| SimulatedShip::new(&self.scenario, plan, self.seed, self.from))
            .collect()
    }

    async fn sail(
        &self,
        fleet: Vec<SimulatedShip>,
        agents: &mut Agents,
        holds: &mut Option<bool>,
    ) -> Result<()> {
        let progress = Arc::new(Progress::new(fleet.len(), self.from, self.until));
        if self.args.serve_only {
            return self.serve(fleet, &progress).await;
        }
        let api = self.sign_in().await?;
        let mut vessels = Vec::new();
        for ship in &fleet {
            let folder = self.work_dir()?.join(agent_config::slug(ship.name()));
            let program = self.args.agent.as_deref().context("--agent is required")?;
            vessels.push(agent::install(&api, ship, program, &folder).await?);
        }
        for vessel in &vessels {
            agents.start(vessel)?;
        }
        let ids: Vec<String> = vessels.iter().map(|vessel| vessel.id.clone()).collect();
        let past = async {
            let fleet = self
                .sail_past(fleet, &progress, progress.show(&api, &ids))
                .await?;
            self.write_truths(&fleet)?;
            let comparison = comparison::compare_fleet(self, &api, &vessels, &fleet).await?;
            self.write_report(&comparison)?;
            *holds = Some(comparison.holds());
            if self.args.live {
                self.sail_live(fleet).await?;
            }
            Ok(())
        };
        tokio::select! {
            ended = past => ended,
            failed = agents.failed() => Err(failed),
        }
    }

    /// Serves the sentences for agents that are run elsewhere.
    async fn serve(&self, fleet: Vec<SimulatedShip>, progress: &Arc<Progress>) -> Result<()> {
        let ships = fleet
            .iter()
            .map(|ship| Ok(serde_json::json!({"name": ship.name(), "address": ship.address()?})))
            .collect::<Result<Vec<_>>>()?;
        print_json(&serde_json::json!({"from": self.from, "until": self.until, "ships": ships}))?;
        let fleet = self
            .sail_past(fleet, progress, std::future::pending())
            .await?;
        if let Some(path) = &self.args.report {
            let truths: Vec<_> = fleet.iter().map(|ship| ship.truth(self)).collect();
            write_whole(path, &serde_json::to_vec(&truths)?)?;
        }
        print_json(&serde_json::json!({"sailed": true}))?;
        if self.args.live {
            return self.sail_live(fleet).await;
        }
        // The connections stay open until the program is stopped.
        std::future::pending::<()>().await;
        drop(fleet);
        Ok(())
    }

    /// Sails all ships to the end of the past, each at its agent's pace.
    async fn sail_past(
        &self,
        fleet: Vec<SimulatedShip>,
        progress: &Arc<Progress>,
        shown: impl Future<Output = ()>,
    ) -> Result<Vec<SimulatedShip>> {
        let mut tasks = JoinSet::new();
        for (index, mut ship) in fleet.into_iter().enumerate() {
            let (until, progress) = (self.until, Arc::clone(progress));
            tasks.spawn(async move {
                ship.sail_to(until, |time| progress.set_time(index, time))
                    .await?;
                anyhow::Ok((index, ship))
            });
        }
        let all = async {
            let mut arrived = Vec::new();
            while let Some(task) = tasks.join_next().await {
                arrived.push(task??);
            }
            anyhow::Ok(arrived)
        };
        let mut arrived = tokio::select! {
            arrived = all => arrived?,
            () = shown => unreachable!("progress is shown for ever"),
        };
        progress.finish();
        arrived.sort_by_key(|(index, _)| *index);
        Ok(arrived.into_iter().map(|(_, ship)| ship).collect())
    }

    async fn sail_live(&self, fleet: Vec<SimulatedShip>) -> Result<()> {
        let behind_s = clock::now().seconds_since(self.until);
        let shift_s = if (0.0..CATCH_UP_S).contains(&behind_s) {
            0.0
        } else {
            behind_s
        };
        let shown_at = self.args.server.as_deref().unwrap_or_default();
        writeln!(
            std::io::stderr(),
            "sailing on in real time, shown at {shown_at}; Ctrl-C ends it"
        )?;
        let mut tasks = JoinSet::new();
        for mut ship in fleet {
            tasks.spawn(async move { ship.sail_live(shift_s).await });
        }
        while let Some(task) = tasks.join_next().await {
            task??;
        }
        Ok(())
    }

    async fn sign_in(&self) -> Result<ServerApi> {
        let server = self
            .args
            .server
            .as_deref()
            .context("--server is required")?;
        let email = self.args.email.as_deref().context("--email is required")?;
        let password = if self.args.password_stdin {
            let mut text = String::new();
            std::io::stdin().read_to_string(&mut text)?;
            text.trim_end_matches(['\r', '\n']).to_owned()
        } else {
            std::env::var("BINNACLE_PASSWORD").map_err(|_| {
                BadInput("a password is needed: --password-stdin or BINNACLE_PASSWORD".to_owned())
            })?
        };
        ServerApi::sign_in(server, email, &password).await
    }

    fn work_dir(&self) -> Result<&Path> {
        self.args
            .work_dir
            .as_deref()
            .context("--work-dir is required")
    }

    fn write_truths(&self, fleet: &[SimulatedShip]) -> Result<()> {
        for ship in fleet {
            let path = self
                .work_dir()?
                .join(agent_config::slug(ship.name()))
                .join("truth.json");
            write_whole(&path, &serde_json::to_vec(&ship.truth(self))?)?;
        }
        Ok(())
    }

    fn write_report(&self, comparison: &Comparison) -> Result<()> {
        let mut out = std::io::stdout().lock();
        out.write_all(comparison.table().as_bytes())?;
        out.flush()?;
        match &self.args.report {
            Some(path) => write_whole(path, &serde_json::to_vec_pretty(comparison)?),
            None => Ok(()),
        }
    }
}

fn print_json(line: &serde_json::Value) -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}")?;
    out.flush()?;
    Ok(())
}

fn whole_second(time: Timestamp) -> Timestamp {
    time.plus_seconds(-(time.micros().rem_euclid(1_000_000) as f64) * 1e-6)
}

/// Returns when a signal asks the program to end.
async fn wait_for_signal() -> Result<()> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let mut hangup = signal(SignalKind::hangup())?;
    tokio::select! {
        _ = interrupt.recv() => {}
        _ = terminate.recv() => {}
        _ = hangup.recv() => {}
    }
    Ok(())
}
