//! The command line: `voyage` and `fleet`.
//!
//! Exit code 2 and one line for what the one who typed it got wrong, 1 for
//! everything else that fails and for a fleet whose models do not hold.

use crate::fleet;
use crate::voyage;
use anyhow::Result;
use binnacle_compass::time::Timestamp;
use binnacle_simulator::scenario::{Scenario, ShipPlan};
use clap::{Args, Parser, Subcommand};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Ships, voyages and instruments that speak NMEA.
#[derive(Debug, Parser)]
#[command(name = "binnacle-simulator", version)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// One ship's sentences to a file, a TCP client or UDP.
    Voyage(VoyageArgs),
    /// All ships with real agents against a real server; their models against the truth.
    Fleet(FleetArgs),
}

/// `voyage`
#[derive(Debug, Args)]
pub(crate) struct VoyageArgs {
    /// Ships, routes and events.
    #[arg(long)]
    pub(crate) scenario: PathBuf,
    /// Chance begins here; the scenario's own by default.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Which ship; the first by default.
    #[arg(long)]
    pub(crate) ship: Option<String>,
    /// Write the sentences to this file.
    #[arg(long, required_unless_present_any = ["tcp_server", "udp"])]
    pub(crate) out: Option<PathBuf>,
    /// Listen here and send to the one who connects, waiting while nobody does.
    #[arg(long, conflicts_with_all = ["out", "udp"])]
    pub(crate) tcp_server: Option<SocketAddr>,
    /// Send datagrams here.
    #[arg(long, conflicts_with = "out")]
    pub(crate) udp: Option<SocketAddr>,
    /// As fast as time goes by, instead of as fast as possible.
    #[arg(long)]
    pub(crate) real_time: bool,
    /// How long the voyage lasts; the scenario's by default.
    #[arg(long)]
    pub(crate) days: Option<f64>,
    /// When the voyage begins (RFC 3339); the scenario's by default.
    #[arg(long, value_parser = Timestamp::parse)]
    pub(crate) start: Option<Timestamp>,
    /// Write what really was to this file, as JSON.
    #[arg(long)]
    pub(crate) truth: Option<PathBuf>,
}

/// `fleet`
#[derive(Debug, Args)]
pub(crate) struct FleetArgs {
    /// Ships, routes and events.
    #[arg(long)]
    pub(crate) scenario: PathBuf,
    /// Chance begins here; the scenario's own by default.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Where the shore is, as http://127.0.0.1:8080.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) server: Option<String>,
    /// An administrator of the operator; the password comes from BINNACLE_PASSWORD.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) email: Option<String>,
    /// Read the password from standard input.
    #[arg(long)]
    pub(crate) password_stdin: bool,
    /// The program `binnacle-agent`.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) agent: Option<PathBuf>,
    /// A folder of its own for every agent is made in this one.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) work_dir: Option<PathBuf>,
    /// How long the past is.
    #[arg(long, default_value_t = 60.0)]
    pub(crate) days: f64,
    /// When the past ends (RFC 3339); now by default.
    #[arg(long, value_parser = Timestamp::parse)]
    pub(crate) until: Option<Timestamp>,
    /// Sail on in real time afterwards.
    #[arg(long)]
    pub(crate) live: bool,
    /// Write the comparison, or with --serve-only the truth, to this file as JSON.
    #[arg(long)]
    pub(crate) report: Option<PathBuf>,
    /// Only serve the sentences, say where as JSON, and keep the lines open.
    #[arg(long)]
    pub(crate) serve_only: bool,
}

/// What the one who typed it got wrong.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct BadInput(pub(crate) String);

impl BadInput {
    pub(crate) fn new(problem: impl std::fmt::Display) -> BadInput {
        BadInput(problem.to_string())
    }
}

pub(crate) async fn run(command: Command) -> Result<ExitCode> {
    match command {
        Command::Voyage(args) => voyage::run(&args).await,
        Command::Fleet(args) => fleet::run(&args).await,
    }
}

/// Reads the scenario; what is wrong in it is the caller's to mend.
pub(crate) fn read_scenario(path: &Path) -> Result<Scenario, BadInput> {
    Scenario::read(path).map_err(BadInput::new)
}

/// The ship asked for, or the first.
pub(crate) fn choose_ship<'a>(
    scenario: &'a Scenario,
    name: Option<&str>,
) -> Result<&'a ShipPlan, BadInput> {
    let Some(name) = name else {
        return Ok(&scenario.ships[0]);
    };
    scenario.ship(name).ok_or_else(|| {
        let names: Vec<&str> = scenario
            .ships
            .iter()
            .map(|ship| ship.name.as_str())
            .collect();
        BadInput(format!(
            "--ship: there is no {name:?}; there are {}",
            names.join(", ")
        ))
    })
}

/// Checks a number of days from the command line.
pub(crate) fn check_days(days: f64) -> Result<f64, BadInput> {
    if (0.001..=3650.0).contains(&days) {
        return Ok(days);
    }
    Err(BadInput(format!(
        "--days: {days} is not within 0.001 to 3650"
    )))
}
